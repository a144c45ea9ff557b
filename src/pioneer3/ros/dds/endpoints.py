"""Publishers and subscribers of a participant, as ROS 2 has them."""

import logging
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any, Final

from pioneer3.ros.dds.settings import LARGEST
from pioneer3.ros.ros2.backend import Left, Received

SAMPLES: Final = 64
"""Taken at a time: then it is the turn of others."""
REMEMBERED: Final = 256
"""Publishers that are gone and are remembered."""
GONE: Final = b""
"""Identity of a publisher that is gone, or that nothing is known of."""
log = logging.getLogger(__name__)


class DdsWriter:
    """A publisher; a message that finds its history full, or is too long, is dropped and counted.

    `writer` and `sample`, the class of its samples, are of the library; `release` is called when it
    is closed.

    Attributes:
        matched: Whether anybody subscribes.
    """

    def __init__(self, writer: Any, sample: Any, release: Callable[[], None]) -> None:
        core: Any = import_module("cyclonedds.core")  # without the types of its stubs
        self._writer, self._sample, self._release = writer, sample, release
        self._error: type[Exception] = core.DDSException
        self._open, self._told = True, False
        self.dropped = 0
        self.matched = False
        writer.set_listener(core.Listener(on_publication_matched=self._match))
        self.matched |= bool(writer.get_matched_subscriptions())  # those that came before

    def _match(self, writer: Any, status: Any) -> None:
        """Take note of subscribers that come and go, in a thread of the library's."""
        self.matched = self._open and status.current_count > 0

    def write(self, cdr: bytes) -> None:
        """Send a serialized message."""
        if not self._open:
            return
        try:
            self._writer.write(self._sample(cdr))
        except self._error:  # a timeout of 0: somebody is slow
            self.dropped += 1
            if len(cdr) > LARGEST and not self._told:
                self._told = True
                log.warning(
                    "a message of %d bytes is not sent: DDS takes %d at most, unless CYCLONEDDS_URI"
                    " has another MaxSampleSize, on both sides",
                    len(cdr),
                    LARGEST,
                )

    def close(self) -> None:
        """Publish no more."""
        if self._open:
            self._open = self.matched = False
            self._release()


class DdsReader:
    """A subscriber to `topic`; `reader` is of the library.

    `received` is given each message and its publisher, `left` each publisher that is gone, also if
    messages of it come later still; `release` is given this when it is closed.
    """

    def __init__(
        self,
        reader: Any,
        topic: str,
        received: Received,
        left: Left,
        release: "Callable[[DdsReader], None]",
    ) -> None:
        self.reader, self.topic = reader, topic
        self._received, self._left, self._release = received, left, release
        self._gids: dict[int, bytes] = {}
        self._gone: deque[bytes] = deque(maxlen=REMEMBERED)
        self._open = True

    def take(self) -> None:
        """Hand over some of the messages that have come, in the backend's thread.

        DDSException comes through: the library has failed.
        """
        from cyclonedds.core import DDSException

        try:
            samples = self.reader.take(SAMPLES)
        except DDSException:
            if self._open:
                raise
            return
        late = False
        for sample in samples:
            if sample.sample_info.valid_data and self._open:
                gid = self._publisher(sample.sample_info.publication_handle)
                late |= gid == GONE
                self._call(self._received, sample.cdr, gid)
        if late:  # an emergency stop counts nevertheless, a velocity does not
            self.lose(GONE)

    def lose(self, gid: bytes) -> None:
        """Tell that a publisher is gone; in the backend's thread."""
        if gid != GONE:
            self._gone.append(gid)
            self._gids = {handle: each for handle, each in self._gids.items() if each != gid}
        if self._open:
            self._call(self._left, gid)

    def lose_all(self) -> None:
        """Tell that all publishers of messages are gone; in the backend's thread."""
        for gid in {*self._gids.values(), GONE}:
            self.lose(gid)

    @property
    def matched(self) -> bool:
        """Whether anybody publishes."""
        return bool(self.reader.get_matched_publications())

    def close(self) -> None:
        """Receive no more."""
        if self._open:
            self._open = False
            self._release(self)

    def _call(self, callback: Callable[..., None], *given: bytes) -> None:
        """Call somebody; an error of theirs must not end the thread, which hears for all."""
        try:
            callback(*given)
        except Exception:
            log.exception("a message on %s could not be taken", self.topic)

    def _publisher(self, handle: int) -> bytes:
        """Return the identity of a publisher; `GONE` if it is not there any more."""
        if handle not in self._gids:
            found = None
            with suppress(Exception):  # its description cannot be read; the library has no class
                found = self.reader.get_matched_publication_data(handle)
            if found is None or found.key.bytes in self._gone:
                return GONE
            self._gids[handle] = found.key.bytes
        return self._gids[handle]
