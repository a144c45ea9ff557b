"""Whether anybody listens to a ROS 1 topic: nobody is asked again and again."""

import asyncio
from collections.abc import Callable
from contextlib import suppress


class Audience:
    """A listener of rospy's publishers, called by its threads.

    Attributes:
        there: Set while anybody listens.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self.there = asyncio.Event()
        self._loop = loop

    def peer_subscribe(self, _topic: str, _send: object, _peer: object) -> None:
        """Take note of one more."""
        self._tell(self.there.set)

    def peer_unsubscribe(self, _topic: str, left: int) -> None:
        """Take note of one less."""
        if not left:
            self._tell(self.there.clear)

    def _tell(self, function: Callable[[], None]) -> None:
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(function)
