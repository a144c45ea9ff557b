"""The dialogue that makes a laser scan, whatever state it is in (scip.md 6). No I/O.

::

    each speed: LF QT ─00─► VV, PP, II ─► [SS] ─► [TM0, TM1, TM2] ─► BM ─► MD, ME, ... ─00─► scans
                 │ 0E: TM2, again
                 │ E: SCIP2.0, again; still E: V, L1 ─► G, G, ... (SCIP 1.1)
                 │ others: a pause, then anew
                 └ nothing: the next speed

Rules:

1. The first LF ends a command that another program, or the search at another speed, left half
   sent. QT is harmless in every state, and every state answers it in its own way. What was in the
   line before its answer belongs to an old stream.
2. A question without a good answer is asked three times. Then the dialogue begins anew.
3. A laser that reports an error is reset, twice. One that says that it is not ready yet is asked
   again.
4. A dialogue that follows one in vain begins after a pause, so that no laser is flooded that
   answers at once, but wrongly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

from pioneer3.lasers.client import (
    Identified,
    LaserIdentity,
    LineSpeedWanted,
    Remarked,
    ScanSettings,
)
from pioneer3.lasers.dialogue import HopelessError, Pause, Script
from pioneer3.lasers.scip.identity import FIRST_URG, identity_from, is_healthy, steps_from
from pioneer3.lasers.scip.stream import ScanStream, fits, streams
from pioneer3.lasers.scip.timing import ScipClock
from pioneer3.lasers.scip.wire import decode_stamp, from_pairs
from pioneer3.models.lasers import Steps

TRIES: Final = 3
COMPARISONS: Final = 8
"""Answers to TM1; the quickest is the best of them."""
STAGGER: Final = 0.002
"""Each TM1 waits so much longer than the one before [s]: they meet USB frames and other cycles on
their way at different phases."""
TM1_LONGER: Final = 11
"""Bytes that the answer to TM1 has more than the request."""
RESETS: Final = 2
BREATH: Final = 0.05
"""A laser changes its speed, or is reset, within this [s]."""
NOT_READY: Final = "0M"
IN_VAIN: Final = 0.5
"""Pause after a dialogue that has not brought scans [s]."""
OK: Final = {"00", "0"}
LASER_ON: Final = {"00", "02"}
IN_TM_MODE: Final = "0E"
UNKNOWN_IN_SCIP1: Final = "E"
ALREADY_SET: Final = "03"
NO_SCANS: Final = "it agrees to measure, but sends nothing: does its mirror turn?"
CANNOT: Final = {"01", "02", "03", "04", "05", "06", "07", "0C", "0D", "0E", "0F", "E"}
"""The laser does not know a measuring command, or not with these parameters."""


@dataclass(frozen=True, slots=True)
class Ask:
    """Send a command and wait for its answer."""

    command: bytes
    prefix: bytes = b""


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer to :class:`Ask`; its status is empty if there was no good one in time.

    The command was sent when `asked`, and the whole answer had come when `answered` [s, monotonic].
    """

    status: str = ""
    lines: Sequence[bytes] = ()
    asked: float = 0.0
    answered: float = 0.0


NOTHING: Final = Reply()
T = TypeVar("T")
ScipScript = Script[Ask, Reply, T]


class _NoAnswerError(Exception):
    """A laser that answered before does so no more."""


class Start:
    """Finds the laser and starts its scans; :meth:`run` may be called again if they stop.

    It tries `speeds` [baud] in their order; links without a speed have none, and `baud` is `None`.
    `started_at` is the speed at which the laser was found, where it has been changed since [baud].
    `refused` counts answers whose data were spoilt; `findings` tell the latest trouble, for the
    reason of a loss.
    """

    def __init__(self, speeds: Sequence[int], settings: ScanSettings) -> None:
        self.clock = ScipClock()
        self.identity: LaserIdentity | None = None
        self.started_at: int | None = None
        self.refused = 0
        self.findings = ""
        self._speeds = tuple(speeds)
        self.baud = speeds[0] if speeds else None
        self._settings = settings
        self._keep_speed = False
        self._scip1 = False
        self._resets = 0
        self._in_vain = False

    def run(self) -> ScipScript[ScanStream]:
        """Return the stream that has been started."""
        while True:
            if self._in_vain:
                yield Pause(IN_VAIN)
            self._in_vain = True
            try:
                yield from self._find()
                steps = yield from self._get_acquainted()
                yield from self._speed_up(steps)
                self.clock = ScipClock()
                if self._settings.calibrate_time and not self._scip1:
                    yield from self._compare_clocks()
                stream = yield from self._measure(steps)
            except _NoAnswerError:
                self.findings = self.findings or "it answers, but not all questions"
                continue
            if stream is not None:
                self._resets = 0
                self.findings = self._on_scip1() if self._scip1 else NO_SCANS
                return stream

    def scanned(self) -> None:
        """Note that a scan has come."""
        self.findings, self._in_vain = "", False

    def _on_scip1(self) -> str:
        firmware = f" (firmware {self.identity.firmware})" if self.identity else ""
        return (
            f"it speaks SCIP 1{firmware}, but does not measure: "
            "switch it off and on, or give it firmware 3.3.00 or later, which knows SCIP 2.0"
        )

    def _find(self) -> ScipScript[None]:
        """Go over all speeds until the laser answers and is idle."""
        number = self._speeds.index(self.baud) if self.baud is not None else 0
        while True:
            if self._speeds:
                self.baud = self._speeds[number % len(self._speeds)]
                yield LineSpeedWanted(self.baud)
            if (yield from self._wake()):
                return
            number += 1

    def _wake(self) -> ScipScript[bool]:
        """End old scans and modes; return whether it answers; _NoAnswerError if it is not idle."""
        self._scip1 = switched = False
        for _ in range(TRIES):
            reply = yield Ask(b"QT", prefix=b"\n")
            if reply.status == IN_TM_MODE:
                yield Ask(b"TM2")
            elif reply.status == UNKNOWN_IN_SCIP1:
                if switched or (yield Ask(b"SCIP2.0")).status == UNKNOWN_IN_SCIP1:
                    self._scip1 = True
                    return True
                switched = True
            elif reply.status and reply.status not in OK:
                self.findings = f"it answers QT with status {reply.status}: switch it off and on"
                raise _NoAnswerError
            else:
                return reply.status in OK
        raise _NoAnswerError

    def _get_acquainted(self) -> ScipScript[Steps]:
        if self._scip1:
            version, steps = (yield from self._pairs(b"V")), FIRST_URG
            state: Mapping[str, str] = {}
        else:
            version = yield from self._pairs(b"VV")
            found = steps_from((yield from self._pairs(b"PP")))
            if found is None:
                self.findings = "its answer to PP is not the geometry of a laser"
                raise _NoAnswerError
            steps = found
            state = yield from self._pairs(b"II", needed=False)
        identity = identity_from(version, state)
        if self.identity != identity:
            self.identity = identity
            yield Identified(identity)
            if not is_healthy(identity.status):
                yield Remarked(f"the laser reports {identity.status!r}")
        return steps

    def _speed_up(self, steps: Steps) -> ScipScript[None]:
        """Change to the fastest speed that both know, where the line is too slow for the scans."""
        wanted = next(streams(steps, self._settings, self.baud, scip1=self._scip1))
        if self.baud is None or self._keep_speed or fits(wanted, self.baud):
            return
        slow = self.baud
        for baud in sorted((speed for speed in self._speeds if speed > slow), reverse=True):
            text = f"S{baud:06}7654321" if self._scip1 else f"SS{baud:06}"
            reply = yield Ask(text.encode())
            if reply.status in OK:
                self.baud = baud
                self.started_at = self.started_at or slow
                yield LineSpeedWanted(baud)
                yield Pause(BREATH)
                if (yield from self._wake()):
                    return
                yield Remarked(f"the laser does not answer at {baud} baud, which it agreed to")
            if not reply.status or reply.status in OK:
                self._keep_speed, self.baud = True, slow
                raise _NoAnswerError
            if reply.status == ALREADY_SET:
                return

    def _compare_clocks(self) -> ScipScript[None]:
        lead = TM1_LONGER * 10 / self.baud if self.baud else 0.0
        reply = yield Ask(b"TM0")
        if reply.status in {"00", "02"}:
            for number in range(COMPARISONS):
                yield Pause(number * STAGGER)
                reply = yield Ask(b"TM1")
                stamp_ms = decode_stamp(reply.lines[0]) if len(reply.lines) == 1 else None
                if reply.status in OK and stamp_ms is None:
                    self.refused += 1
                elif reply.status in OK and stamp_ms is not None:
                    self.clock.compare(stamp_ms, reply.asked, reply.answered, lead)
        yield from self._ask(b"TM2")
        if not self.clock.compared:
            yield Remarked("the laser does not tell its time: scans are dated as they come")

    def _measure(self, steps: Steps) -> ScipScript[ScanStream | None]:
        """Switch the laser on and start scans; return `None` if it has to be found again."""
        if self._scip1:
            yield from self._ask(b"L1")
            return next(streams(steps, self._settings, self.baud, scip1=True))
        reply = yield from self._ask(b"BM")
        if reply.status in LASER_ON:
            for stream in streams(steps, self._settings, self.baud):
                reply = yield from self._ask(stream.command)
                if reply.status in OK:
                    return stream
                if reply.status not in CANNOT:
                    break
        yield from self._mend(reply.status)
        return None

    def _mend(self, status: str) -> ScipScript[None]:
        """Wait for a laser that is not ready; reset one that reports an error."""
        stat = self.identity.status if self.identity and self.identity.status else ""
        reports = f"status {status}" + (f", {stat!r}" if stat else "")
        self.findings = f"it answers, but does not measure: {reports}"
        if status == NOT_READY:
            yield Remarked(f"the laser is not ready yet: {reports}")
            return
        if self._resets >= RESETS:
            raise HopelessError(
                f"the laser reports an error ({reports}) after {RESETS} resets, too: "
                "switch it off and on; if the error stays, the laser is broken"
            )
        self._resets += 1
        yield Remarked(f"the laser reports an error ({reports}): resetting it")
        yield Ask(b"RS")
        yield Pause(BREATH)
        if self.started_at is not None:  # a reset also resets the speed
            self.baud, self.started_at = self.started_at, None

    def _ask(self, command: bytes) -> ScipScript[Reply]:
        """Return the answer to `command`; _NoAnswerError if none of three came."""
        for _ in range(TRIES):
            reply = yield Ask(command)
            if reply.status:
                return reply
        raise _NoAnswerError

    def _pairs(self, command: bytes, *, needed: bool = True) -> ScipScript[Mapping[str, str]]:
        """Return the keys and values of an answer."""
        for _ in range(TRIES):
            reply = yield Ask(command)
            pairs = from_pairs(reply.lines, summed=not self._scip1)
            if reply.status in OK and pairs:
                return pairs
            self.refused += pairs is None
            if reply.status and not needed:
                break
        if needed:
            raise _NoAnswerError
        return {}
