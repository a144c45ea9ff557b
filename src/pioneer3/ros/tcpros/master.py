"""The master and other nodes by XML-RPC, called with a limit of time, and our own part of it."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from socket import SOCK_STREAM, getaddrinfo
from typing import Any, Final, TypeVar
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error as XmlRpcError
from xmlrpc.client import dumps, loads

from pioneer3.links.hosts import bracketed, is_address
from pioneer3.ros.addresses import PORT
from pioneer3.ros.tcpros.answers import DONE, MasterRefusalError, OddAnswerError, value_of
from pioneer3.tasks import in_own_thread

PATIENCE: Final = 3.0
"""A node that does not respond within this time [s] hangs."""
WAITING: Final = 5.0
"""A connection on which nothing comes for this time [s] is closed; the master makes a new one."""
LONGEST_ANSWER: Final = 1 << 24
LONGEST_REQUEST: Final = 1 << 20
"""Longer ones are refused [bytes]."""
CONNECTIONS: Final = 64
"""Connections to our part at once; a further one ends the oldest."""
LENGTH: Final = "content-length"
LOST: Final = (OSError, EOFError)
"""Raised where nobody is there, or not a node of ROS."""
MALFORMED: Final = (
    *(ValueError, TypeError, LookupError, ArithmeticError, AttributeError),
    *(asyncio.LimitOverrunError, XmlRpcError, ExpatError),
)
"""Raised for what is no message of XML-RPC."""
T = TypeVar("T")
log = logging.getLogger(__name__)

Connection = tuple[asyncio.StreamReader, asyncio.StreamWriter]


async def connect(host: str | None, port: int | None) -> Connection:
    """Open a connection as :func:`connect_by` does."""
    return await connect_by(asyncio.open_connection, host, port)


async def connect_by(
    opening: Callable[[Any, Any], Awaitable[T]], host: str | None, port: int | None
) -> T:
    """Open a connection by a function; a name is looked up in a thread: that may hang."""
    found = [host]
    if host and not is_address(host):
        rows = await in_own_thread(partial(getaddrinfo, host, port, type=SOCK_STREAM))
        found = [str(row[4][0]) for row in rows]
    for number, address in enumerate(found, start=1):
        try:
            return await opening(address, port)
        except OSError:
            if number == len(found):
                raise
    raise OSError(f"{host} has no address")


class Api:
    """The master, or another node, for `caller`, our node."""

    def __init__(self, uri: str, caller: str) -> None:
        self.uri, self._caller = uri, caller

    async def call(self, method: str, *arguments: Any) -> Any:
        """Return the value that a method returns.

        Raises:
            MasterRefusalError: it says no.
            OSError, EOFError: see :data:`LOST`.
        """
        try:
            request = dumps((self._caller, *arguments), method).encode()
            async with asyncio.timeout(PATIENCE):
                content = await self._post(request)
            (answer,), _ = loads(content)
        except TimeoutError:
            raise TimeoutError(f"no answer within {PATIENCE:g} s") from None
        except MALFORMED as error:
            raise OddAnswerError(f"{self.uri} is no node of ROS: {error}") from error
        return value_of(method, answer)

    async def connect(self) -> Connection:
        """Open a connection; OSError where nobody is there."""
        async with asyncio.timeout(PATIENCE):
            return await connect(*self._address)

    @property
    def _address(self) -> tuple[str, int]:
        address = urlsplit(self.uri)
        return address.hostname or "", address.port or PORT

    async def _post(self, content: bytes) -> bytes:
        """Return the content of the response to a request."""
        host, port = self._address
        head = f"POST /RPC2 HTTP/1.1\r\nHost: {bracketed(host)}:{port}\r\nConnection: close\r\n"
        reader, writer = await connect(host, port)
        try:
            writer.write(_with_length(f"{head}Content-Type: text/xml\r\n", content))
            status, fields = await _read_head(reader)
            length = int(fields.get(LENGTH, LONGEST_ANSWER + 1))
            if status.split()[1:2] != ["200"] or length > LONGEST_ANSWER:
                raise OddAnswerError(f"{self.uri} says {status}, in {length} bytes")
            return await reader.readexactly(length)
        finally:
            writer.close()


class NodeApi:
    """Our own part: others find it at `host`, and it listens on `bind`; see :meth:`open`.

    The answers are functions by method, given the name of the caller and its arguments.
    """

    def __init__(self, host: str, bind: str, answers: Mapping[str, Callable[..., object]]) -> None:
        self._host, self._bind, self._answers = host, bind, answers
        self._open: dict[asyncio.StreamWriter, asyncio.Task[None] | None] = {}
        self.uri = ""

    async def open(self) -> None:
        """Listen; OSError where that address is not of this computer."""
        self._server = await asyncio.start_server(self._take, self._bind, 0)
        port = self._server.sockets[0].getsockname()[1]
        self.uri = f"http://{bracketed(self._host)}:{port}/"

    async def close(self) -> None:
        """Listen no more."""
        self._server.close()
        for task in list(self._open.values()):
            if task is not None:
                task.cancel()
        await asyncio.gather(*filter(None, self._open.values()), return_exceptions=True)

    async def _take(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Respond to the requests on a connection."""
        self._open[writer] = asyncio.current_task()
        if len(self._open) > CONNECTIONS:
            oldest = next(iter(self._open))
            oldest.close()
        try:
            while await self._respond(reader, writer):
                pass
        except (*LOST, *MALFORMED, asyncio.CancelledError) as error:
            log.debug("a request of another node: %s", error)
        finally:
            self._open.pop(writer, None)
            writer.close()

    async def _respond(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bool:
        """Respond to a request; return whether another one may follow."""
        async with asyncio.timeout(WAITING):
            _, fields = await _read_head(reader)
            length = fields.get(LENGTH, "")
            if not (length.isdecimal() and int(length) <= LONGEST_REQUEST):
                writer.write(_with_length("HTTP/1.1 413 Too long\r\nConnection: close\r\n", b""))
                return False
            arguments, method = loads(await reader.readexactly(int(length)))
        answer = self._answer(str(method), arguments)
        content = dumps((answer,), methodresponse=True, allow_none=True).encode()
        writer.write(_with_length("HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\n", content))
        await writer.drain()
        return fields.get("connection", "").lower() != "close"

    def _answer(self, method: str, arguments: tuple[object, ...]) -> list[object]:
        """Return an answer in ROS's way: a code, words and a value."""
        try:
            return [DONE, "", self._answers[method](*arguments)]
        except KeyError:
            return [-1, f"no method {method}", 0]
        except (MasterRefusalError, TypeError) as error:
            return [0, str(error), 0]


def _with_length(head: str, content: bytes) -> bytes:
    return f"{head}Content-Length: {len(content)}\r\n\r\n".encode() + content


async def _read_head(reader: asyncio.StreamReader) -> tuple[str, dict[str, str]]:
    """Return the first line of a request or response of HTTP, and its fields."""
    head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1")
    first, *lines = head.splitlines()
    fields = dict(line.partition(":")[::2] for line in lines if line)
    return first, {name.lower(): value.strip() for name, value in fields.items()}
