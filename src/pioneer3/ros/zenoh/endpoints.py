"""Publishers, subscribers and services of a Zenoh session, as ROS 2 has them."""

import logging
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from math import isinf
from threading import BoundedSemaphore, RLock, Thread
from typing import TYPE_CHECKING, Any, Final

from pioneer3.ros.ros2.backend import Left, Qos, Received, Unread
from pioneer3.ros.zenoh.keys import GID_BYTES, PLAIN, Attachment, parse_attachment

if TYPE_CHECKING:
    import zenoh

HEARTBEAT: Final = 0.5
"""Time between a reliable publisher's heartbeats [s], as in rmw_zenoh_cpp."""
REQUESTS: Final = 32
"""Requests of a service that are worked on at the same time."""

log = logging.getLogger(__name__)


def attachment(sequence: int, gid: bytes) -> bytes:
    """Return the attachment of a message that is sent now."""
    return PLAIN.pack(sequence, time.time_ns(), GID_BYTES, gid)


def read_attachment(data: "zenoh.ZBytes | None") -> Attachment | None:
    """Return an attachment that was received; `None` if it is none of ROS's."""
    try:
        return None if data is None else parse_attachment(data.to_bytes())
    except ValueError:
        return None


def matching(end: "zenoh.Publisher | zenoh.Querier") -> bool:
    """Return whether anybody is at the other end; takes about a microsecond."""
    status: Any = end.matching_status  # zenoh's stubs call it a bool; as one it is always true
    return bool(status.matching)


def in_its_thread(call: Callable[[Any], None]) -> Any:
    """Return a callback for quick work that calls nothing of Zenoh, in Zenoh's own thread.

    Any other has a thread of its own that waits for it.
    """
    from zenoh.handlers import Callback

    return Callback(call, indirect=False)


class ZenohWriter:
    """A publisher; its `gid` comes with its messages, and `release` is called when it is closed.

    Attributes:
        matched: Whether anybody subscribes.
    """

    def __init__(
        self, session: "zenoh.Session", key: str, qos: Qos, gid: bytes, release: Callable[[], None]
    ) -> None:
        import zenoh

        self._gid = gid
        self._release = release
        self._error = zenoh.ZError
        self._numbers = count(1)
        self.is_open = True
        self.matched = False
        self._publisher: Any  # zenoh's stubs leave the end of the latched one untyped
        self._publisher = self._plain = _publisher(session, key, qos)
        if qos.transient_local:  # which does not tell whether anybody subscribes
            self._publisher = _latched_publisher(session, key, qos)
        self._matching = self._plain.declare_matching_listener(in_its_thread(self._match))
        self.matched |= matching(self._plain)

    def _match(self, status: Any) -> None:
        self.matched = self.is_open and bool(status.matching)

    def write(self, cdr: bytes) -> None:
        """Send a message; after :meth:`close` nothing."""
        if not self.is_open:
            return
        try:
            self._publisher.put(cdr, attachment=attachment(next(self._numbers), self._gid))
        except self._error as error:
            if self.is_open:
                log.debug("not sent: %s", error)

    def close(self) -> None:
        """Publish no more."""
        if self.is_open:
            self.is_open = self.matched = False
            self._release()
            for each in {self._publisher, self._plain}:
                each.undeclare()


def _publisher(session: "zenoh.Session", key: str, qos: Qos) -> "zenoh.Publisher":
    import zenoh

    reliability = zenoh.Reliability.RELIABLE if qos.reliable else zenoh.Reliability.BEST_EFFORT
    return session.declare_publisher(
        key, congestion_control=zenoh.CongestionControl.DROP, reliability=reliability
    )


def _latched_publisher(
    session: "zenoh.Session", key: str, qos: Qos
) -> "zenoh.ext.AdvancedPublisher":
    import zenoh
    from zenoh import ext

    # its cache has no lifespan, nor has that of rmw_zenoh_cpp: only subscribers limit the age
    heartbeat = ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT)
    return ext.declare_advanced_publisher(
        session,
        key,
        congestion_control=zenoh.CongestionControl.DROP,
        reliability=zenoh.Reliability.RELIABLE if qos.reliable else zenoh.Reliability.BEST_EFFORT,
        cache=ext.CacheConfig(qos.depth),
        sample_miss_detection=heartbeat if qos.reliable else None,
        publisher_detection=True,
    )


class ZenohReader:
    """A subscriber: messages and departures in Zenoh's own threads, one at a time.

    `left` is given each publisher that is gone.
    """

    def __init__(self, received: Received, left: Left) -> None:
        self._received = received
        self._left = left
        self._lock = RLock()
        self.is_open = True
        self._releases: list[Callable[[], None]] = []

    def start(
        self, session: "zenoh.Session", key: str, qos: Qos, releases: list[Callable[[], None]]
    ) -> None:
        """Subscribe to a key; `releases` are called when the reader is closed."""
        subscriber = (
            _latched_subscriber(session, key, qos, in_its_thread(self._take))
            if qos.transient_local
            else session.declare_subscriber(key, in_its_thread(self._take))
        )
        self._releases = [*releases, subscriber.undeclare]

    def close(self) -> None:
        """Receive no more."""
        with self._lock:
            if not self.is_open:
                return
            self.is_open = False
        for release in self._releases:
            release()

    def gone(self, gid: bytes) -> None:
        """Tell that a publisher is gone."""
        self._tell(self._left, gid)

    def _take(self, sample: "zenoh.Sample") -> None:
        found = read_attachment(sample.attachment)
        self._tell(self._received, sample.payload.to_bytes(), found.gid if found else b"")

    def _tell(self, callback: Callable[..., None], *given: bytes) -> None:
        with self._lock:
            if self.is_open:
                try:
                    callback(*given)
                except Exception:
                    log.exception("a message could not be taken")


def _latched_subscriber(
    session: "zenoh.Session", key: str, qos: Qos, put: Any
) -> "zenoh.ext.AdvancedSubscriber[None]":
    from zenoh import ext

    recovery = ext.RecoveryConfig(periodic_queries=None, heartbeat=True)
    age = None if isinf(qos.lifespan) else qos.lifespan
    return ext.declare_advanced_subscriber(
        session,
        key,
        put,
        history=ext.HistoryConfig(detect_late_publishers=True, max_samples=qos.depth, max_age=age),
        recovery=recovery if qos.reliable else None,
        subscriber_detection=True,
    )


class ZenohServer:
    """A service: each request in a thread of its own; `release` is called when it is closed."""

    def __init__(
        self,
        session: "zenoh.Session",
        key: str,
        respond: Callable[[bytes], bytes],
        release: Callable[[], None],
    ) -> None:
        self._key = key
        self._respond = respond
        self._release = release
        self.is_open = True
        self._room = BoundedSemaphore(REQUESTS)
        self._unread = Unread(f"requests of {key}")
        self._queryable = session.declare_queryable(key, in_its_thread(self._asked), complete=True)

    def close(self) -> None:
        """Offer the service no more."""
        if self.is_open:
            self.is_open = False
            self._release()
            self._queryable.undeclare()
            self._unread.close()

    def _asked(self, query: "zenoh.Query") -> None:
        if not self.is_open or not self._room.acquire(blocking=False):
            query.reply_err(b"too many requests")
            query.drop()
            return
        Thread(target=self._answer, args=(query,), name="zenoh-service", daemon=True).start()

    def _answer(self, query: "zenoh.Query") -> None:
        asked = read_attachment(query.attachment) or Attachment(0, 0, bytes(GID_BYTES))
        try:
            request = query.payload.to_bytes() if query.payload is not None else b""
            response = self._respond(request)
            query.reply(self._key, response, attachment=replace(asked, stamp=time.time_ns()).pack())
        except ValueError as error:  # bytes that are no request
            self._unread.add(error)
            query.reply_err(f"the request cannot be read: {error}".encode())
        except Exception:
            log.exception("a request of %s could not be answered", self._key)
            query.reply_err(b"the request could not be answered; the server's log has the reason")
        finally:
            query.drop()
            self._room.release()
