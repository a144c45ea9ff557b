"""A connection of a `rospy.Publisher` to a subscriber, which sends at once and never waits."""

from collections import deque
from contextlib import suppress
from socket import MSG_DONTWAIT, socket
from threading import Lock, Thread
from typing import Any


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
            sent = 0
            with suppress(BlockingIOError):
                sent = connection.send(data, MSG_DONTWAIT)
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
