"""When a message arrived at this computer, whenever rospy's thread for it gets its turn."""

import socket
import struct
import time
from typing import Any, Final

SO_TIMESTAMPNS: Final = 35
"""Linux's option to tell the arrival of data; Python has no name for it (socket(7))."""
TIME: Final = struct.Struct("@qq")
"""A `timespec`."""
LONGEST: Final = 1.0
"""A message does not wait longer than this for its thread [s]."""


class Arrivals:
    """Knows when messages arrived, on one topic.

    rospy reads each connection in a thread of its own; on a busy computer these take turns in any
    order. So each connection's socket is asked to note when data came in.

    Args:
        subscriber: A `rospy.Subscriber`.
    """

    def __init__(self, subscriber: Any) -> None:
        self._topic = subscriber.impl

    def age(self, message: Any) -> float:
        """Return how long ago a message just received arrived [s].

        It is 0 for the first one of each connection, and where the system does not tell.
        """
        for connection in self._topic.connections:
            if connection.header is message._connection_header:
                if not isinstance(connection.socket, NotingSocket):
                    connection.socket = NotingSocket(connection.socket)
                return float(connection.socket.age())
        return 0.0


class NotingSocket:
    """A socket that notes when the system received what was read last.

    Args:
        inner: Connected; all that is not said here, it does.
    """

    def __init__(self, inner: socket.socket) -> None:
        self._inner = inner
        self._arrived: float | None = None
        inner.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)

    def recv(self, size: int) -> bytes:
        """Read, and note."""
        data, notes, _, _ = self._inner.recvmsg(size, socket.CMSG_SPACE(TIME.size))
        self._arrived = None
        for level, kind, note in notes:
            if (level, kind) == (socket.SOL_SOCKET, SO_TIMESTAMPNS):
                seconds, nanoseconds = TIME.unpack(note)
                self._arrived = seconds + nanoseconds * 1e-9
        return data

    def age(self) -> float:
        """Return how long ago what was read last arrived [s]; 0 if nobody told."""
        if self._arrived is None:
            return 0.0
        return min(max(0.0, time.time() - self._arrived), LONGEST)  # the clock may be set meanwhile

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)
