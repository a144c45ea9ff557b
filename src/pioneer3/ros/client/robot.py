"""A robot on the other side of topics, driven by the same arbiter and rules as one at a cable."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import Final

from pioneer3.errors import Refusal, Symptom
from pioneer3.geometry import STILL, Twist2
from pioneer3.robot.explain import Reason, ReasonKind, why_not_moving
from pioneer3.robot.pilot import STOPPED, Pilot, VelocityCommand, stands
from pioneer3.robot.supervisor import Connection, ConnectionStatus, Feed, RobotInfo
from pioneer3.runtime.arbiter import Arbiter
from pioneer3.runtime.driven import Driven
from pioneer3.state import Snapshot

LOOK: Final = 0.05
"""Pause between two looks for expired requests [s]."""
SILENT: Final = 1.0
"""Without a snapshot for this long [s], nobody drives."""
STUCK: Final = 1.5
"""A robot that stands for this long [s] though it should move is stalled: no topic says so."""
HELD: Final = Reason(
    ReasonKind.FAULT,
    "Its emergency stop is latched, or its stop button pressed: reset it, or pull the button out,"
    " then ask again.",
    Symptom.EMERGENCY_STOP,
)


class TopicSupervisor:
    """Turns decisions of the pilot into messages, and hands it snapshots to observe.

    A velocity goes out with each snapshot, and at once when it changes. Without a request nothing
    goes out: somebody else may drive.

    `switch` asks for power on the motors, or none; `latch` asks the node for its emergency stop, or
    to release it, and without it the motors lose their power. `unclear` tells why the snapshots are
    not those of one robot, if so; none is taken then. With `tells_stops` the node publishes the
    state of its emergency stop.
    """

    def __init__(
        self,
        info: RobotInfo,
        publish: Callable[[Twist2], None],
        switch: Callable[[bool], None],
        latch: Callable[[bool], None] | None = None,
        *,
        unclear: str = "",
        tells_stops: bool = False,
    ) -> None:
        self.pilot = Pilot()
        self.snapshots: Feed[Snapshot] = Feed()
        self.status: Feed[ConnectionStatus] = Feed()
        self.info: RobotInfo | None = info
        self.snapshot_taken: Callable[[Snapshot], None] = lambda snapshot: None
        self._publish = publish
        self._switch = switch
        self._latch = latch
        self._unclear, self._tells_stops = unclear, tells_stops
        self.snapshot: Snapshot | None = None
        self.taken = False  # a node takes commands of all programs
        self._sent = STILL
        self._moved_at = -inf
        self._clock = asyncio.get_running_loop().time

    @property
    def without_power(self) -> bool:
        """Whether the robot reports that its motors have no power, as after an emergency stop.

        Where its node tells of emergency stops, only while one holds the robot.
        """
        if self.snapshot is None:
            return False
        motors = self.snapshot.motors
        return not motors.enabled and (motors.stop_button or not self._tells_stops)

    async def run(self) -> None:
        """Let requests expire, and notice silence; cancelled, it stops the robot."""
        try:
            while True:
                await asyncio.sleep(LOOK)
                now = self._clock()
                if self.snapshot is not None and now - self.snapshot.stamp > SILENT:
                    self._lose(now)
                self.pilot.tick(now)
                self._flush()
        finally:
            if not self._sent.is_zero:
                self.stop()
            for feed in (self.snapshots, self.status):
                feed.close()

    def take(self, snapshot: Snapshot) -> None:
        """Take a snapshot made from the topics, and act on it; an old one counts as silence."""
        assert self.info is not None
        now = self._clock()
        if self._unclear or now - snapshot.stamp > SILENT:
            return
        if self.snapshot is None:
            if self.pilot.emergency:
                self._stop_hard()  # it may have been out of reach when that was asked for
            self.pilot.session_opened(self.info.limits, now)
            self.status.publish(ConnectionStatus(Connection.CONNECTED, self.info.url))
        self.snapshot = snapshot = self._with_stall(snapshot, now)
        self.pilot.observe(snapshot, now)
        self.snapshot_taken(snapshot)
        self.snapshots.publish(snapshot)
        self._flush(again=True)

    def drive(self, command: VelocityCommand) -> Refusal | None:
        """See :meth:`Pilot.drive`; the robot's node keeps its own accelerations."""
        refused = self.pilot.drive(command, self._clock())
        self._flush()
        return refused

    def stop(self, why: str = STOPPED) -> None:
        """Stop, whichever action has been driving; commands from before end by this reason."""
        self.pilot.stop(self._clock(), why)
        self._send(STILL)
        self._flush()

    def emergency_stop(self) -> None:
        """Stop, motors off, latched in this program, and in the node if it can."""
        self.pilot.emergency_stop(self._clock())
        self._send(STILL)
        self._stop_hard()
        self._flush()

    def reset_emergency_stop(self) -> None:
        """Release the latches; the motors stay off."""
        self.pilot.reset_emergency_stop()
        if self._latch is not None:
            self._latch(False)

    def set_motors(self, *, on: bool) -> Refusal | None:
        """Ask for power on the motors, or none."""
        refused = self.pilot.set_motors(on=on, now=self._clock())
        if refused is None:
            self._send(STILL)
            self._switch(on)
        self._flush()
        return refused

    def why_not_moving(self, decided: str | None = None) -> Reason | None:
        """Return the reason why the robot stands still, or `None` while it moves."""
        if self._unclear:
            return Reason(ReasonKind.FAULT, self._unclear)
        if self.snapshot is None and self.pilot.limits is None and self.info is not None:
            url = self.info.url
            return Reason(ReasonKind.FAULT, f"{url} has not reported: has it lost its robot?")
        why = why_not_moving(self.pilot, self.snapshot, self._clock(), decided)
        held = self.snapshot is not None and self.snapshot.motors.stop_button
        return HELD if held and why and not self.pilot.emergency else why

    def _stop_hard(self) -> None:
        """Ask the node for its emergency stop, or for no power on the motors."""
        if self._latch is not None:
            self._latch(True)
        else:
            self._switch(False)

    def _with_stall(self, snapshot: Snapshot, now: float) -> Snapshot:
        """Return `snapshot`, its wheels stalled if they have not moved as commanded."""
        if not stands(snapshot) or self._sent.is_zero or not snapshot.motors.enabled:
            self._moved_at = now
        if now - self._moved_at < STUCK:
            return snapshot
        self._moved_at = now
        stalled = replace(snapshot.motors, left_stalled=True, right_stalled=True)
        return replace(snapshot, motors=stalled)

    def _lose(self, now: float) -> None:
        self.snapshot = None
        why = f"its topics are silent for {SILENT:g} s"
        self.pilot.session_lost(why, now)
        self._send(STILL)
        self.status.publish(ConnectionStatus(Connection.LOST, why))

    def _flush(self, *, again: bool = False) -> None:
        """Send the motion that the pilot wants, or the last velocity `again`.

        Motors and accelerations are left to the node, which has a pilot, too.
        """
        request = self.pilot.outgoing()
        wanted = STILL if request.stop and request.twist is None else request.twist
        if wanted is None and again:
            wanted = self._sent
        if wanted is not None and not (wanted.is_zero and self._sent.is_zero):
            self._send(wanted)

    def _send(self, twist: Twist2) -> None:
        self._sent = twist
        self._publish(twist)


class TopicRobot(Driven):
    """A robot as programs see it that reach it by topics only.

    Its :attr:`info` has the name of its node as URL.
    """

    def __init__(self, supervisor: TopicSupervisor) -> None:
        self._supervisor = supervisor
        self.arbiter = Arbiter(supervisor)

    @property
    def supervisor(self) -> TopicSupervisor:
        """Its topics, as the arbiter drives by them."""
        return self._supervisor
