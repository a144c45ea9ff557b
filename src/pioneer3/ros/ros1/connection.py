"""Connections of rospy's publishers and subscribers that wake no thread for a message."""

from asyncio import AbstractEventLoop
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from socket import MSG_DONTWAIT, socket
from threading import Event, Lock, Thread
from typing import Any, Final

from pioneer3.tasks import hand_over

READ: Final = 1 << 14
"""Most that is read at once [bytes]."""


class DirectConnection:
    """Stands for a transport of rospy, in place of its `QueuedConnection`.

    That wakes a thread for each message, which costs more than all else about it. Here a thread
    sends only what the system does not take at once. Of `queue` messages that wait for it the
    newest stay.
    """

    def __init__(self, transport: Any, queue: int) -> None:
        self._transport = transport
        self._waiting: deque[bytes] = deque(maxlen=queue)
        self._blocked = False
        self._lock = Lock()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def write_data(self, data: bytes) -> None:
        """Send a message, in any thread; OSError where the connection is lost."""
        transport = self._transport
        with self._lock:
            if self._blocked:
                self._waiting.append(data)
                return
            if (connection := transport.socket) is None:
                raise ConnectionError(f"{transport.name}: the connection is closed")
            try:
                sent = connection.send(data, MSG_DONTWAIT)
            except BlockingIOError:
                sent = 0
            rest = memoryview(data)[sent:]
            self._blocked = bool(rest)
            transport.stat_bytes += len(data)
            transport.stat_num_msg += 1
        if rest:
            Thread(target=self._send, args=(connection, rest), daemon=True).start()

    def _send(self, connection: socket, data: bytes | memoryview) -> None:
        """Send until nothing waits, in a thread."""
        try:
            while data:
                connection.sendall(data)
                with self._lock:
                    data = self._waiting.popleft() if self._waiting else b""
                    self._blocked = bool(data)
        except OSError:
            with self._lock:
                self._blocked = False  # the next message finds it closed, and rospy removes it
            self._transport.close()


class DirectReading:
    """Reads a connection of a `rospy.Subscriber` in the event loop, not in a thread of rospy's.

    That would be woken for each message, and wake the loop: more work than the command itself. Now
    it waits for the end of the connection. `receive` is given messages and transport, as by rospy.
    """

    def __init__(
        self, transport: Any, receive: Callable[[list[Any], Any], None], loop: AbstractEventLoop
    ) -> None:
        self._transport, self._receive, self._loop = transport, receive, loop
        self._buffer, self._protocol = transport.read_buff, transport.protocol
        self._read_as_rospy = transport.receive_once
        self._ended = Event()
        transport.receive_once = self.wait

    def wait(self) -> list[Any]:
        """Return when the loop reads no more, in rospy's thread, which then finds the reason."""
        transport = self._transport
        transport.receive_once = self._read_as_rospy
        with suppress(OSError, AttributeError):  # rospy has closed it
            connection = transport.socket.dup()  # while it is read, its number is no other's
            hand_over(self._loop, self._loop.add_reader, connection, self._read, connection)
            self._ended.wait()
        messages: list[Any] = self._read_as_rospy()
        return messages

    def end(self) -> None:
        """Let rospy's thread go on, in any thread: the connection is closed."""
        self._ended.set()

    def _read(self, connection: socket) -> None:
        """Take new bytes, in the loop; a malformed message ends the connection, as in rospy."""
        goes_on = False
        try:
            goes_on = self._take(connection)
        finally:
            if not goes_on:
                self._loop.remove_reader(connection)
                connection.close()
                self.end()

    def _take(self, connection: socket) -> bool:
        """Pass on the messages that are whole; return whether more may come."""
        try:
            data = connection.recv(READ, MSG_DONTWAIT)
        except BlockingIOError:
            return True
        except OSError:
            return False
        messages: list[Any] = []
        self._buffer.write(data)
        self._protocol.read_messages(self._buffer, messages, connection)
        for message in messages:
            message._connection_header = self._transport.header
        self._transport.stat_bytes += len(data)
        self._transport.stat_num_msg += len(messages)
        self._receive(messages, self._transport)
        return bool(data)
