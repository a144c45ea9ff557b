"""The laser's side of SCIP: a unit and its hosts. No I/O.

Rules:

1. A unit on a serial line has one connection for ever, whoever opens the port: its stream goes on
   until QT, RS or a power cycle. Over a network, and over USB, each host has its own.
2. The laser is off after power-on. Commands that stream switch it on; those for one scan do not.
3. A scan is sent when its turn is over, and left out where the line still carries another one.

Facts: scip.md 1 to 6.
"""

from math import inf

from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.scip.session import HostSession
from pioneer3.lasers.scip.unit import WELL, ScipUnit
from pioneer3.models.lasers import LaserModel


class ScipDevice:
    """One laser that speaks SCIP: :attr:`unit` and its hosts.

    `start_speed` is that of its serial line after power-on [baud], `None` for that at delivery of
    lasers with several speeds; the others, on USB or a network, have none. `scip1`: it speaks SCIP
    1.1 after power-on, `None` as its type does; without `scip2` it never speaks SCIP 2.0, as the
    first URG-04LX. It is deaf for `boot_time` after :meth:`switch_on` [s]; real ones up to 10 s.
    """

    def __init__(
        self,
        model: LaserModel,
        *,
        serial: str = "H0012345",
        start_speed: int | None = None,
        scip1: bool | None = None,
        scip2: bool = True,
        status: str = WELL,
        firmware: str = "3.3.00(12/Sep./2012)",
        boot_time: float = 1.0,
    ) -> None:
        if start_speed is None and model.speeds:
            start_speed = model.speeds[0]
        if scip1 is None:  # as ARIA calls lasers that begin with it (scip.md 1.5)
            scip1 = "urg" in model.kinds
        self.unit = ScipUnit(
            model,
            serial=serial,
            firmware=firmware,
            status=status,
            start_speed=start_speed,
            begins_in_scip1=scip1 or not scip2,
            knows_scip2=scip2,
            boot_time=boot_time,
        )
        self.speed = start_speed
        self.deadline = inf
        self._boots = 0
        self._sessions: list[HostSession] = []
        if start_speed is not None:
            self._add_session()

    @property
    def turn(self) -> MirrorTurn | None:
        """The mirror's next turn, or `None` while nobody wants readings."""
        return self.unit.turn if any(s.wants_readings for s in self._sessions) else None

    def connect(self, *, network: bool = False) -> HostSession:
        """Return the connection of one more host; on a serial line it is always the same."""
        if self.unit.start_speed is None:
            return self._add_session()
        self._sessions[0].serve(network=network)
        return self._sessions[0]

    def measured(self, sweep: Sweep, now: float) -> None:
        """Take the readings of a turn that is over."""
        step_0 = sweep.began - self.unit.steps.first * sweep.turn.beam_time
        stamp_ms = self.unit.stamp(step_0)
        for session in self._sessions:
            session.measured(sweep, stamp_ms, now)
        self._plan()

    def tick(self, now: float) -> None:
        """Do nothing: all follows from commands, readings and bytes that leave."""

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: bytes that have not left are lost."""
        self.unit.restart(now)
        for session in self._sessions:
            session.cut_off()
        self._plan()

    def _add_session(self) -> HostSession:
        session = HostSession(self.unit, changed=self._plan)
        self._sessions.append(session)
        return session

    def _plan(self) -> None:
        """Take over the changes that a session made."""
        if self._boots != self.unit.boots:
            self._boots = self.unit.boots
            for session in self._sessions:
                session.restart()
        if self.unit.start_speed is not None:
            self.speed = self._sessions[0].line.speed
        else:
            self._sessions = [session for session in self._sessions if not session.closed]
        self.deadline = min((session.line.due for session in self._sessions), default=inf)
