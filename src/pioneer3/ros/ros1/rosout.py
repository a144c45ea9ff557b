"""Logs of this node on `/rosout`, without waiting for the master.

rospy asks the master for a parameter whenever something is logged, without a timeout: in a network
that is cut, the thread that logs a warning hangs. That must not be the one that stops the robot.
"""

import logging
from logging.handlers import QueueHandler, QueueListener
from queue import Full, Queue
from typing import Final

from pioneer3.names import printable

LONGEST: Final = 100
"""Records that wait while the master is silent; further ones are on the terminal only."""


class BoundedQueueHandler(QueueHandler):
    """Puts records into a queue; drops those that find it full."""

    def enqueue(self, record: logging.LogRecord) -> None:
        """Put a record into the queue if there is room."""
        try:
            self.queue.put_nowait(record)
        except Full:
            return


def _on_one_line(record: logging.LogRecord) -> bool:
    """Let a terminal obey nothing in a record."""
    record.msg, record.args = printable(record.getMessage()), None
    return True


def log_in_background() -> None:
    """Let a thread of its own publish the records of rospy; `rospy.init_node` comes first.

    Records are on the terminal at once, as before.
    """
    from rospy.impl.rosout import RosOutHandler

    log = logging.getLogger("rosout")
    log.addFilter(_on_one_line)
    publishers = [each for each in log.handlers if isinstance(each, RosOutHandler)]
    if not publishers:
        return
    waiting: Queue[logging.LogRecord] = Queue(LONGEST)
    for each in publishers:
        log.removeHandler(each)
    log.addHandler(BoundedQueueHandler(waiting))
    QueueListener(waiting, *publishers).start()  # a daemon: it may hang when the program ends
