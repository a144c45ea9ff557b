"""The interface of a byte pipe between a host and a robot."""

from collections.abc import Awaitable, Callable, Generator
from contextlib import AbstractContextManager
from typing import Final, Protocol, runtime_checkable

HUNG_UP = "a robot takes one program at a time: is another one connected to it?"
"""A hint for messages when the far end closes the link."""


class Written:
    """An awaitable that is done: to wait for it takes no task and no round of the event loop."""

    def __await__(self) -> Generator[None, None, None]:
        """Return at once."""
        yield from ()


WRITTEN: Final = Written()
"""Returned by a link that has sent all."""


class Link(Protocol):
    """A byte pipe to one robot, or to one host.

    Attributes:
        url: For messages and logs.
        speeds: Baud rates to which this link can be set, best guess first; empty on links without.
    """

    url: str
    speeds: tuple[int, ...]

    @property
    def round_trip(self) -> float:
        """Extra delay of an answer compared with a cable [s], as measured when opening the link."""

    async def read(self) -> bytes:
        """Return the next bytes, at least one; `b""` once the far end has closed.

        Raises:
            LinkError: the link failed.
        """

    def write(self, data: bytes) -> Awaitable[None]:
        """Send all of `data`, at once; LinkError if the link is down.

        Returns :data:`WRITTEN` where nothing is left to wait for.
        """

    async def set_speed(self, baud: int) -> None:
        """Change the line speed; does nothing on links without one."""

    async def close(self) -> None:
        """Send the buffered bytes, then close; safe to call twice."""


@runtime_checkable
class TimedLink(Link, Protocol):
    """A link that tells when its last bytes were read, as a log has it [s, of the event loop]."""

    read_at: float


@runtime_checkable
class HandingLink(Link, Protocol):
    """A link that can hand over bytes at once, without a task that reads them."""

    def handing(self, take: Callable[[bytes], None]) -> AbstractContextManager[None]:
        """Give what comes to `take` during the block; `read` returns what it cannot give so."""


Opener = Callable[[], Awaitable[Link]]
"""Opens the same link again at each call."""
