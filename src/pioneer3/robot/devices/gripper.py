"""The gripper: paddles, lift and beams (protocol.md 5.6, facts.md 8.5)."""

import asyncio
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import GripperAction, RequestMode
from pioneer3.arcos.reports import GripperSwitch, Report, Sip
from pioneer3.errors import DeviceError
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import PATIENCE, Sensor, SensorKind, Shown
from pioneer3.robot.report_requests import ReportRequest
from pioneer3.robot.supervisor import Supervisor

USER_IO = 1
"""Wiring of a gripper to the user's inputs, as in GRIPPER packets (protocol.md 5.6)."""
GENERAL_IO = 2
"""Wiring of a gripper to the general inputs, as in GRIPPER packets."""
SENSORS = 0x3F
LIFT_MOVES = 0x40
"""Bit of a lift that moves, in the SIP's byte for user-IO grippers (protocol.md 4.7)."""
GRIP_MOVES_ON_USER_IO = 0x04
"""Bit of a grip that moves, in that byte."""

LIFT_LEAST = 3.0
"""Least time of a lift in the exercise [s] (facts.md 8.5)."""
LIFT_PATIENCE = 30.0
"""Longest wait for a lift [s] (facts.md 8.5)."""
GRIP_PATIENCE = 10.0
"""Longest wait for a grip [s] (facts.md 8.5)."""
NEXT_ACTION = {
    GripperAction.LIFT_UP: GripperAction.CLOSE,
    GripperAction.CLOSE: GripperAction.LIFT_DOWN,
    GripperAction.LIFT_DOWN: GripperAction.OPEN,
    GripperAction.OPEN: GripperAction.LIFT_UP,
}
"""The next action of the exercise after each."""


class PaddlePosition(StrEnum):
    """Positions of the paddles."""

    OPEN = "open"
    BETWEEN = "between"
    CLOSED = "closed"


@dataclass(frozen=True, slots=True, kw_only=True)
class GripperReading:
    """The gripper at one instant.

    Attributes:
        lift_at_limit: Whether the lift is all the way up or down ("maxed").
        outer_beam_broken: Something is between the paddles' tips.
        inner_beam_broken: Something is between the paddles' roots.
    """

    stamp: float
    paddles: PaddlePosition
    lift_at_limit: bool
    left_touches: bool
    right_touches: bool
    outer_beam_broken: bool
    inner_beam_broken: bool
    lift_moves: bool
    paddles_move: bool


def read_switches(seen: GripperSwitch, stamp: float) -> GripperReading:
    """Return the reading of the switches, as ARIA does (protocol.md 4.7)."""
    left = GripperSwitch.LEFT_PADDLE_LOW not in seen
    right = GripperSwitch.RIGHT_PADDLE_LOW not in seen
    is_open = GripperSwitch.OPEN_LOW not in seen
    return GripperReading(
        stamp=stamp,
        paddles=PaddlePosition.CLOSED
        if left and right
        else PaddlePosition.OPEN
        if is_open
        else PaddlePosition.BETWEEN,
        lift_at_limit=GripperSwitch.LIFT_LIMIT_LOW not in seen,
        left_touches=left,
        right_touches=right,
        outer_beam_broken=GripperSwitch.OUTER_BEAM_BROKEN in seen,
        inner_beam_broken=GripperSwitch.INNER_BEAM_BROKEN in seen,
        lift_moves=GripperSwitch.LIFT_MOVING in seen,
        paddles_move=GripperSwitch.GRIP_MOVING in seen,
    )


def switches_in(sip: Sip, wiring: int) -> GripperSwitch | None:
    """Return the switches in a standard report, or `None` if it is too short."""
    if sip.gripper_state is None or sip.digital_in is None:
        return None
    if wiring == GENERAL_IO:
        return GripperSwitch(sip.gripper_state)
    seen = GripperSwitch(sip.digital_in & SENSORS | sip.gripper_state & LIFT_MOVES)
    moves = sip.gripper_state & GRIP_MOVES_ON_USER_IO
    return seen | GripperSwitch.GRIP_MOVING if moves else seen


class Exercise:
    """ARIA's exercise: up and open, close, down, open, up, and so on (facts.md 8.5)."""

    FIRST = (GripperAction.LIFT_UP, GripperAction.OPEN)

    def __init__(self, now: float) -> None:
        self._doing, self._since = GripperAction.LIFT_UP, now

    def step(self, gripper: GripperReading, now: float) -> GripperAction | None:
        """Return the next action, or `None` while one goes on."""
        if not self._done(gripper, now - self._since):
            return None
        self._doing, self._since = NEXT_ACTION[self._doing], now
        return self._doing

    def _done(self, gripper: GripperReading, passed: float) -> bool:
        match self._doing:
            case GripperAction.CLOSE:
                return gripper.paddles is PaddlePosition.CLOSED or passed >= GRIP_PATIENCE
            case GripperAction.OPEN:
                return gripper.paddles is PaddlePosition.OPEN or passed >= GRIP_PATIENCE
        return (passed >= LIFT_LEAST and gripper.lift_at_limit) or passed >= LIFT_PATIENCE


WIRINGS = {GENERAL_IO: "general", USER_IO: "user"}


def _request(mode: RequestMode) -> ReportRequest:
    return ReportRequest(
        begin=(commands.GripperPacRequest(mode),),
        end=(commands.GripperPacRequest(RequestMode.STOP),),
        answers=(reports.GripperState,),
    )


STREAMING = _request(RequestMode.STREAM)


GRIPPER: Final = SensorKind(
    name="gripper",
    title="the gripper",
    request=_request(RequestMode.ONCE),
    reports=(Sip, reports.GripperState),
    shown=(
        Shown("paddles", "paddles"),
        Shown("outer_beam_broken", "outer beam broken"),
        Shown("inner_beam_broken", "inner beam broken"),
        Shown("lift_at_limit", "lift at its end"),
    ),
)


class Gripper(Sensor[GripperReading]):
    """Opens, closes and lifts, and reads its switches.

    Like ARIA it asks for one GRIPPER packet, which has the wiring, and reads the switches from the
    standard report; where that is too short, it asks for a packet in every cycle.
    """

    def __init__(self, supervisor: Supervisor) -> None:
        super().__init__(supervisor, GRIPPER, self._read_switches)
        self._clock = asyncio.get_running_loop().time
        self._wiring: int | None = None
        self._exercise: Exercise | None = None

    @property
    def presence(self) -> Presence:
        """Whether there is one: its own answer counts, then CONFIG (protocol.md 5.1, field 14)."""
        if self._wiring is not None:
            if self._wiring in WIRINGS:
                return Presence(True, f"The gripper answers: on the {WIRINGS[self._wiring]} I/O.")
            return Presence(False, "The robot has no gripper: it says so in its GRIPPER packet.")
        config = self._supervisor.info.config if self._supervisor.info else None
        if config is None or config.has_gripper is None:
            return Presence(None, "Nobody knows of a gripper: the robot's CONFIG does not tell.")
        if config.has_gripper:
            return Presence(True, "The robot has a gripper: its CONFIG says HasGripper.")
        return Presence(False, "The robot has no gripper: its CONFIG says HasGripper 0.")

    async def reading(self, patience: float = PATIENCE) -> GripperReading:
        """Return the next reading; DeviceError if there is none, or no answer."""
        self._require()
        return await super().reading(patience)

    def open(self) -> None:
        """Open the paddles. Any action ends an exercise.

        Raises:
            DeviceError: the robot has no gripper; also for all other actions.
            CommandError: no robot is connected; also for all other actions.
        """
        self._act(GripperAction.OPEN)

    def close(self) -> None:
        """Close the paddles until they touch something."""
        self._act(GripperAction.CLOSE)

    def lift_up(self) -> None:
        """Raise the lift to its upper end."""
        self._act(GripperAction.LIFT_UP)

    def lift_down(self) -> None:
        """Lower the lift to its lower end."""
        self._act(GripperAction.LIFT_DOWN)

    def stop_paddles(self) -> None:
        """Stop the paddles where they are."""
        self._act(GripperAction.STOP)

    def stop_lift(self) -> None:
        """Stop the lift where it is."""
        self._act(GripperAction.LIFT_STOP)

    def halt(self) -> None:
        """Stop paddles and lift."""
        self._act(GripperAction.HALT)

    def store(self) -> None:
        """Close and raise, to drive."""
        self._act(GripperAction.STORE)

    def deploy(self) -> None:
        """Lower and open, to grasp."""
        self._act(GripperAction.DEPLOY)

    def set_grasp_time(self, seconds: float) -> None:
        """Set the time for which the paddles go on pressing, in steps of 20 ms."""
        self._act(GripperAction.PRESSURE)
        self._supervisor.send(commands.GripperVal(seconds))

    def carry_lift(self, seconds: float) -> None:
        """Raise the lift for `seconds`, in steps of 20 ms."""
        self._act(GripperAction.LIFT_CARRY)
        self._supervisor.send(commands.GripperVal(seconds))

    async def exercise(self) -> None:
        """Open, close, raise and lower until any other action; DeviceError without a gripper."""
        self._require()
        exercise = self._exercise = Exercise(self._clock())
        for action in Exercise.FIRST:
            self._supervisor.send(commands.Gripper(action))
        try:
            async for reading in self.values():
                if self._exercise is not exercise:
                    return
                following = exercise.step(reading, self._clock())
                if following is not None:
                    self._supervisor.send(commands.Gripper(following))
        finally:
            if self._exercise is exercise:
                self._exercise = None
                if self._supervisor.snapshot is not None:
                    self._supervisor.send(commands.Gripper(GripperAction.HALT))

    @property
    def exercising(self) -> bool:
        """Whether an exercise goes on."""
        return self._exercise is not None

    def _act(self, action: GripperAction) -> None:
        self._require()
        if self._exercise is not None:  # halt it before any other action
            self._exercise = None
            self._supervisor.send(commands.Gripper(GripperAction.HALT))
        self._supervisor.send(commands.Gripper(action))

    def _require(self) -> None:
        if self.presence.there is False:
            raise DeviceError(str(self.presence))

    def _read_switches(self, report: Report, stamp: float) -> GripperReading | None:
        match report:
            case reports.GripperState(wiring, seen):
                self._wiring = wiring
                return read_switches(seen, stamp) if wiring in WIRINGS else None
            case Sip() if self.presence.there:
                seen_in_sip = switches_in(report, self._wiring or GENERAL_IO)
                if seen_in_sip is not None:
                    return read_switches(seen_in_sip, stamp)
                if self.kind.request != STREAMING:
                    self.kind = replace(self.kind, request=STREAMING)
                    self.change(STREAMING)
        return None
