"""Services as rmw_cyclonedds_cpp has them: two topics, and a header before each message.

Other middleware tells in another way which request a response belongs to, so that its requests
would hang: services are offered only where somebody says that the peers have this one.
"""

import logging
import struct
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from itertools import count
from secrets import randbits
from threading import BoundedSemaphore
from typing import Any, Final

from pioneer3.ros.ros2.backend import Respond, Unread

ENCAPSULATION: Final = 4
"""Length of the header of CDR."""
REQUEST_ID: Final = struct.Struct("<Qq")
"""Identity of the client and number of the request; before the message, and aligned as it is."""
HEAD: Final = {"client_id": "uint64", "sequence": "int64"}
"""Head of requests and responses, as fields of the type."""
WAITING: Final = 32
"""Requests of a service that wait, with the one that is worked on."""
log = logging.getLogger(__name__)


def with_id(cdr: bytes, client: int, sequence: int) -> bytes:
    """Return a message after the header that names its request."""
    return cdr[:ENCAPSULATION] + REQUEST_ID.pack(client, sequence) + cdr[ENCAPSULATION:]


def without_id(cdr: bytes) -> tuple[bytes, int, int]:
    """Return a message, and client and number of its request; ValueError if it is too short."""
    end = ENCAPSULATION + REQUEST_ID.size
    if len(cdr) < end:
        raise ValueError("a request without its header")
    client, sequence = REQUEST_ID.unpack(cdr[ENCAPSULATION:end])
    return cdr[:ENCAPSULATION] + cdr[end:], client, sequence


class ServiceResponder:
    """Responds to requests of one service, in a thread of its own; `write` sends with its header.

    `refusal` responds to a request that cannot be answered: the protocol has no errors, and without
    any response a client waits for ever.
    """

    def __init__(
        self, name: str, respond: Respond, refusal: bytes, write: Callable[[bytes], None]
    ) -> None:
        self._name, self._respond, self._refusal, self._write = name, respond, refusal, write
        self._worker = ThreadPoolExecutor(1, f"dds-service{name}")
        self._room = BoundedSemaphore(WAITING)
        self._full = False
        self._unread = Unread(f"requests of {name}")

    def take(self, cdr: bytes, _: bytes) -> None:
        """Take a request, without a wait; one without a header is left out."""
        try:
            request, client, sequence = without_id(cdr)
        except ValueError as error:
            self._unread.add(error)
            return
        if self._room.acquire(blocking=False):
            self._full = False
            with suppress(RuntimeError):  # closed meanwhile
                self._worker.submit(self._answer, request, client, sequence)
            return
        if not self._full:
            self._full = True
            log.warning("%d requests of %s wait: those that come now fail", WAITING, self._name)
        self._write(with_id(self._refusal, client, sequence))

    def close(self) -> None:
        """Respond to no more requests."""
        self._worker.shutdown(wait=False, cancel_futures=True)
        self._unread.close()

    def _answer(self, request: bytes, client: int, sequence: int) -> None:
        response = self._refusal
        try:
            response = self._respond(request)
        except ValueError as error:  # bytes that are no request
            self._unread.add(error)
        except Exception:
            log.exception("a request of %s could not be answered", self._name)
        finally:
            self._room.release()
        self._write(with_id(response, client, sequence))


class ServiceClient:
    """Calls a service; `write` sends a request with its header."""

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self._write = write
        self._id = randbits(64)
        self._numbers = count(1)
        self._waiting: dict[int, Any] = {}

    def take(self, cdr: bytes, _: bytes) -> None:
        """Take a response; those to other clients are left out."""
        try:
            response, client, sequence = without_id(cdr)
        except ValueError:
            return
        if client == self._id and (waits := self._waiting.get(sequence)) is not None:
            waits[1].append(response)
            waits[0].set()

    def call(self, request: bytes, timeout: float) -> bytes:
        """Return the response to a request; TimeoutError if none came within `timeout` [s]."""
        number, done, responses = next(self._numbers), threading.Event(), list[bytes]()
        self._waiting[number] = done, responses
        try:
            self._write(with_id(request, self._id, number))
            if not done.wait(timeout):
                raise TimeoutError(f"no response within {timeout:g} s")
            return responses[0]
        finally:
            del self._waiting[number]
