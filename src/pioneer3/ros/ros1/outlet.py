"""A topic's way out: what the network takes goes at once, and only what it does not take waits.

rospy's own queue hands every message to a thread of its connection. At ten readings a second that
costs more than all the rest of a node, and half a millisecond.
"""

import threading
from collections import deque
from socket import MSG_DONTWAIT
from typing import Any, Final

from pioneer3.ros.ros1.messages import message_class

QUEUE: Final = 10
"""Messages that wait for a slow subscriber; without a bound rospy blocks the publisher."""


def outlet(name: str, kind: str, *, latch: bool = False, listener: object = None) -> Any:
    """Return a `rospy.Publisher` of `kind` that neither waits nor hands on without need.

    Args:
        name: Of the topic.
        kind: Of its messages, as "nav_msgs/Odometry".
        latch: Whether who comes later is sent the last message.
        listener: A `rospy.SubscribeListener`.
    """
    import rospy  # noqa: PLC0415

    publisher = rospy.Publisher(
        name,
        message_class(kind),
        queue_size=QUEUE,
        latch=latch,
        subscriber_listener=listener,
    )
    topic = publisher.impl
    add = topic.add_connection
    topic.add_connection = lambda connection: add(PromptConnection(connection))
    topic.set_queue_size(None)  # who has come before this line is in rospy's own queue
    return publisher


class PromptConnection:
    """A connection of rospy's that never waits, and keeps the newest messages.

    Args:
        connection: rospy's; all that is not said here, it does.
    """

    def __init__(self, connection: Any) -> None:
        self._connection = connection
        self._lock = threading.Lock()
        self._waiting: deque[bytes] = deque(maxlen=QUEUE)
        self._relaying = False

    def write_data(self, data: bytes) -> bool:
        """Send `data`, or keep it until what was kept before has gone.

        Raises:
            OSError: the other end has gone; rospy then forgets the connection.
        """
        with self._lock:
            if self._relaying:
                self._waiting.append(data)
            elif rest := data[self._send(data) :]:
                self._relaying = True
                threading.Thread(target=self._relay, args=(rest,), daemon=True).start()
        return True

    def _send(self, data: bytes) -> int:
        """Return how much of `data` the network takes at once."""
        socket = self._connection.socket
        if socket is None:
            raise OSError("the connection is closed")
        try:
            sent: int = socket.send(data, MSG_DONTWAIT)
        except BlockingIOError:
            return 0
        self._connection.stat_bytes += sent
        self._connection.stat_num_msg += 1
        return sent

    def _relay(self, rest: bytes) -> None:
        """Send the `rest` of a message, then those that have come meanwhile."""
        try:
            while True:
                self._connection.socket.sendall(rest)
                with self._lock:
                    if not self._waiting:
                        self._relaying = False
                        return
                    rest = self._waiting.popleft()
        except (OSError, AttributeError):  # closed meanwhile, and then without a socket
            self._connection.close()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)
