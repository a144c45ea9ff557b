"""What a gripper's switches say, and its exercise; pure (arcos.md 4.7, 5.6, 8.5)."""

from dataclasses import dataclass
from enum import StrEnum

from pioneer3.arcos.commands import GripperAction
from pioneer3.arcos.reports import GripperSwitch, Sip

USER_IO, GENERAL_IO = 1, 2
"""How a gripper is wired, as GRIPPER packets tell it (arcos.md 5.6)."""
SENSORS = 0x3F
LIFT_MOVES, GRIP_MOVES_ON_USER_IO = 0x40, 0x04
"""Bits of the SIP's byte that user-IO grippers have besides the digital inputs (arcos.md 4.7)."""

LIFT_LEAST, LIFT_PATIENCE, GRIP_PATIENCE = 3.0, 30.0, 10.0
"""Of the exercise [s] (arcos.md 8.5)."""
FOLLOWS = {
    GripperAction.LIFT_UP: GripperAction.CLOSE,
    GripperAction.CLOSE: GripperAction.LIFT_DOWN,
    GripperAction.LIFT_DOWN: GripperAction.OPEN,
    GripperAction.OPEN: GripperAction.LIFT_UP,
}
"""What the exercise does after what."""


class Paddles(StrEnum):
    """Where the paddles are."""

    OPEN = "open"
    BETWEEN = "between"
    CLOSED = "closed"


@dataclass(frozen=True, slots=True, kw_only=True)
class GripperReading:
    """The gripper at one instant.

    Attributes:
        stamp: When it was received [s, monotonic].
        paddles: Open, closed or in between.
        lift_at_limit: Whether the lift is all the way up or down ("maxed").
        left_touches: The left paddle is triggered.
        right_touches: The right paddle is triggered.
        outer_beam_broken: Something is between the paddles' tips.
        inner_beam_broken: Something is between the paddles' roots.
        lift_moves: The lift's motor runs.
        paddles_move: The paddles' motor runs.
    """

    stamp: float
    paddles: Paddles
    lift_at_limit: bool
    left_touches: bool
    right_touches: bool
    outer_beam_broken: bool
    inner_beam_broken: bool
    lift_moves: bool
    paddles_move: bool


def read_switches(seen: GripperSwitch, stamp: float) -> GripperReading:
    """Return what the switches mean, as ARIA reads them (arcos.md 4.7)."""
    left = GripperSwitch.LEFT_PADDLE_LOW not in seen
    right = GripperSwitch.RIGHT_PADDLE_LOW not in seen
    is_open = GripperSwitch.OPEN_LOW not in seen
    return GripperReading(
        stamp=stamp,
        paddles=Paddles.CLOSED if left and right else Paddles.OPEN if is_open else Paddles.BETWEEN,
        lift_at_limit=GripperSwitch.LIFT_LIMIT_LOW not in seen,
        left_touches=left,
        right_touches=right,
        outer_beam_broken=GripperSwitch.OUTER_BEAM_BROKEN in seen,
        inner_beam_broken=GripperSwitch.INNER_BEAM_BROKEN in seen,
        lift_moves=GripperSwitch.LIFT_MOVING in seen,
        paddles_move=GripperSwitch.GRIP_MOVING in seen,
    )


def switches_in(sip: Sip, wiring: int) -> GripperSwitch | None:
    """Return the switches that a standard report shows, or `None` if it ends before."""
    if sip.gripper_state is None or sip.digital_in is None:
        return None
    if wiring == GENERAL_IO:
        return GripperSwitch(sip.gripper_state)
    seen = GripperSwitch(sip.digital_in & SENSORS | sip.gripper_state & LIFT_MOVES)
    moves = sip.gripper_state & GRIP_MOVES_ON_USER_IO
    return seen | GripperSwitch.GRIP_MOVING if moves else seen


class Exercise:
    """ARIA's: up and open, close, down, open, up, and so on (arcos.md 8.5)."""

    FIRST = (GripperAction.LIFT_UP, GripperAction.OPEN)

    def __init__(self, now: float) -> None:
        self._doing, self._since = GripperAction.LIFT_UP, now

    def step(self, gripper: GripperReading, now: float) -> GripperAction | None:
        """Return what to do next, or `None` while it is doing something."""
        if not self._done(gripper, now - self._since):
            return None
        self._doing, self._since = FOLLOWS[self._doing], now
        return self._doing

    def _done(self, gripper: GripperReading, passed: float) -> bool:
        match self._doing:
            case GripperAction.CLOSE:
                return gripper.paddles is Paddles.CLOSED or passed >= GRIP_PATIENCE
            case GripperAction.OPEN:
                return gripper.paddles is Paddles.OPEN or passed >= GRIP_PATIENCE
        return (passed >= LIFT_LEAST and gripper.lift_at_limit) or passed >= LIFT_PATIENCE
