"""The master and other nodes by XML-RPC, called with a limit of time, and our own part of it."""

import logging
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException, HTTPResponse
from socketserver import ThreadingMixIn
from typing import Any, Final
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error as XmlRpcError
from xmlrpc.client import ServerProxy, Transport
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from pioneer3.ros.tcpros.answers import DONE, MasterRefusalError, OddAnswerError, value_of

PATIENCE: Final = 3.0
"""A node that does not respond within this time [s] hangs."""
WAITING: Final = 5.0
"""A connection on which nothing comes for this time [s] is closed; the master makes a new one."""
LONGEST_ANSWER: Final = 1 << 24
LONGEST_REQUEST: Final = 1 << 20
"""Longer ones are refused [bytes]."""
CONNECTIONS: Final = 64
"""Connections to our part at once; a further one ends the oldest."""
LOST: Final = (OSError, HTTPException, XmlRpcError, ExpatError)
"""Raised where nobody is there, or not a node of ROS."""
log = logging.getLogger(__name__)


class Api:
    """The master, or another node, for `caller`, our node. Calls wait: make them in threads."""

    def __init__(self, uri: str, caller: str) -> None:
        self.uri, self._caller = uri, caller

    def call(self, method: str, *arguments: object) -> Any:
        """Return the value that a method returns.

        Raises:
            MasterRefusalError: it says no.
            OSError, HTTPException, XmlRpcError, ExpatError: see :data:`LOST`.
        """
        try:
            with ServerProxy(self.uri, transport=_Transport()) as proxy:
                answer = getattr(proxy, method)(self._caller, *arguments)
        except (ValueError, TypeError, LookupError, AttributeError, ArithmeticError) as error:
            raise OddAnswerError(f"{self.uri} is no node of ROS: {error}") from error
        return value_of(method, answer)


class _Transport(Transport):
    """A transport that does not wait for ever, nor for endless answers."""

    accept_gzip_encoding = False

    def make_connection(self, host: Any) -> HTTPConnection:
        """Return a connection with a limit of time."""
        connection = super().make_connection(host)
        connection.timeout = PATIENCE
        return connection

    def parse_response(self, response: HTTPResponse) -> Any:
        """Return the content of an answer; OddAnswerError if it has no end."""
        data, until = bytearray(), time.monotonic() + PATIENCE
        while part := response.read1(1 << 16):
            data += part
            if len(data) > LONGEST_ANSWER or time.monotonic() > until:
                raise OddAnswerError("its answer has no end")
        parser, content = self.getparser()
        parser.feed(bytes(data))
        parser.close()
        return content.close()


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeCalls:
    """Calls that others make to our node, in threads.

    An update has a topic, and the addresses of the nodes that publish it. Topics that we do not
    publish have no address, as host and port; `topics` are names and types of those published, and
    of those subscribed to.
    """

    publisher_update: Callable[[str, list[str]], None]
    topic_address: Callable[[str], tuple[str, int] | None]
    topics: Callable[[], tuple[list[list[str]], list[list[str]]]]
    shut_down: Callable[[], None]


class _Handler(SimpleXMLRPCRequestHandler):
    protocol_version = "HTTP/1.1"  # the master keeps its connections
    timeout = WAITING

    def do_POST(self) -> None:  # noqa: N802
        length = self.headers.get("content-length", "")
        if not (length.isdecimal() and int(length) <= LONGEST_REQUEST):
            self.close_connection = True
            self.send_error(413)
            return
        super().do_POST()

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        log.debug(format, *args)


class _Server(ThreadingMixIn, SimpleXMLRPCServer):
    daemon_threads = True

    def __init__(self, at: tuple[str, int]) -> None:
        super().__init__(at, _Handler, logRequests=False, allow_none=True)
        self._open: list[Any] = []
        self._lock = threading.Lock()

    def process_request(self, request: Any, client_address: Any) -> None:
        with self._lock:
            self._open.append(request)
            oldest = self._open.pop(0) if len(self._open) > CONNECTIONS else None
        if oldest is not None:
            with suppress(OSError):  # it has ended
                oldest.shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        with self._lock:
            if request in self._open:
                self._open.remove(request)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        log.debug("a request of %s", client_address, exc_info=True)


class NodeApi:
    """Our own part, in a thread: others find it at `host`, and it listens on `bind`.

    `process` is the number of ours, and `calls` has all that others may ask.
    """

    def __init__(self, host: str, bind: str, master: str, process: int, calls: NodeCalls) -> None:
        self._calls = calls
        self._server = _Server((bind, 0))
        self.uri = f"http://{host}:{self._server.server_address[1]}/"
        answers: dict[str, Callable[..., object]] = {
            "publisherUpdate": self._publisher_update,
            "requestTopic": self._request_topic,
            "shutdown": self._shut_down,
            "getPid": lambda caller: process,
            "getMasterUri": lambda caller: master,
            "getPublications": lambda caller: calls.topics()[0],
            "getSubscriptions": lambda caller: calls.topics()[1],
            "getBusInfo": lambda caller: [],
            "getBusStats": lambda caller: [[], [], []],
            "paramUpdate": lambda caller, name, value: 0,
        }
        for name, answer in answers.items():
            self._server.register_function(_responding(answer), name)
        run = self._server.serve_forever
        self._thread = threading.Thread(target=run, args=(0.1,), name="ros1 node", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Listen no more."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def _publisher_update(self, caller: str, topic: str, publishers: list[str]) -> int:
        if not isinstance(publishers, list) or not all(isinstance(uri, str) for uri in publishers):
            raise TypeError("publishers are a list of addresses")
        self._calls.publisher_update(topic, publishers)
        return 0

    def _request_topic(self, caller: str, topic: str, protocols: list[list[str]]) -> list[object]:
        found = self._calls.topic_address(topic)
        if found is None or not any(each[:1] == ["TCPROS"] for each in protocols):
            raise MasterRefusalError(f"{topic} is not published here over TCPROS")
        return ["TCPROS", *found]

    def _shut_down(self, caller: str, reason: str = "") -> int:
        self._calls.shut_down()
        return 0


def _responding(answer: Callable[..., object]) -> Any:
    """Return the function that answers in ROS's way: a code, words and a value."""

    def respond(*arguments: object) -> list[object]:
        try:
            return [DONE, "", answer(*arguments)]
        except (MasterRefusalError, TypeError) as error:
            return [0, str(error), 0]

    return respond
