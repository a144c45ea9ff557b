"""The Pioneer gripper: two paddles with break beams on a lift (protocol.md 3.2, 4.7, 5.6).

Paddles and lift move at constant speed until something stops them. The bits are those that ARIA
reads; Player reads the same byte in another way (facts.md 13, row 20).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import copysign, inf
from types import MappingProxyType
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, GripperAction
from pioneer3.arcos.reports import GripperState, GripperSwitch, Report
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories.base import ReportingAccessory, SipFields

OPENING = 0.215
"""Between the open paddles [m]; unverified, like the next two."""
OPENING_TIME = 2.0
"""From open to closed [s]."""
LIFTING_TIME = 3.0
"""From the lower to the upper end [s]."""
CONTACT = 1e-9
"""The paddles touch from this distance on [m]: steps of any length end at the same time."""
SAME = 1e-9
"""Heights and times [s] that differ by less are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldObject:
    """An object between the paddles, so wide from one to the other [m].

    It breaks the `outer` beam at the paddles' tips, and the `inner` one at their root.
    """

    width: float = 0.05
    outer: bool = True
    inner: bool = True

    def __post_init__(self) -> None:
        """Refuse an object that no gripper can hold."""
        if not 0 < self.width <= OPENING:
            raise ConfigError(f"object of {self.width} m: a gripper opens to {OPENING} m")


class Paddles:
    """The opening between two paddles that move together [m].

    They `squeeze` for so long after they have met resistance [s].
    """

    def __init__(self) -> None:
        self.opening = OPENING
        self.squeeze = 0.0
        self._direction = 0
        self._pressed = 0.0

    @property
    def moving(self) -> bool:
        """Whether their motor runs."""
        return self._direction != 0

    def drive(self, direction: int) -> None:
        """Open (1), close (-1) or stop (0)."""
        self._direction, self._pressed = direction, 0.0

    def step(self, dt: float, closest: float) -> None:
        """Move for `dt` [s]; they cannot come closer than `closest` [m]."""
        way = OPENING / OPENING_TIME * dt
        if self._direction > 0:
            self.opening += way
            if self.opening >= OPENING - CONTACT:
                self.opening = OPENING
                self.drive(0)
        elif self._direction < 0:
            free = max(0.0, self.opening - closest)
            self.opening -= min(way, free)
            if way >= free - CONTACT:
                self._pressed += max(0.0, way - free) / OPENING * OPENING_TIME
                if self._pressed >= self.squeeze - SAME:
                    self.drive(0)


class Lift:
    """The lift that carries the gripper; its height is 0 at the lower end to 1 at the upper."""

    def __init__(self) -> None:
        self.height = 0.0
        self._direction = 0
        self._left = inf

    @property
    def moving(self) -> bool:
        """Whether its motor runs."""
        return self._direction != 0

    @property
    def at_limit(self) -> bool:
        """Whether it is all the way up or down."""
        return self.height in (0.0, 1.0)

    def drive(self, direction: int, duration: float = inf) -> None:
        """Go up (1), down (-1) or stop (0), for `duration` [s] at most."""
        self._direction, self._left = direction, duration

    def step(self, dt: float) -> None:
        """Move for `dt` [s]."""
        if not self._direction:
            return
        time = min(dt, self._left)
        self._left -= time
        self.height += copysign(time / LIFTING_TIME, self._direction)
        end = 1.0 if self._direction > 0 else 0.0
        if (self.height - end) * self._direction >= -SAME:
            self.height = end
        if self.height == end or self._left <= SAME:
            self.drive(0)


NO_GRIPPER, GENERAL_IO = 0, 2
IDLE = (
    GripperSwitch.OPEN_LOW
    | GripperSwitch.LIFT_LIMIT_LOW
    | GripperSwitch.LEFT_PADDLE_LOW
    | GripperSwitch.RIGHT_PADDLE_LOW
)
"""The active-low switches while none is pressed."""
GRASP_TIME = 0.2
"""Time for which the paddles press after they have met resistance, until PRESSURE sets it [s]."""
TWENTY_MS = 0.02
VALUED = (GripperAction.PRESSURE, GripperAction.LIFT_CARRY)
DIRECTIONS: Final[Mapping[GripperAction, tuple[int | None, int | None]]] = MappingProxyType(
    {
        GripperAction.OPEN: (1, None),
        GripperAction.CLOSE: (-1, None),
        GripperAction.STOP: (0, None),
        GripperAction.LIFT_UP: (None, 1),
        GripperAction.LIFT_DOWN: (None, -1),
        GripperAction.LIFT_STOP: (None, 0),
        GripperAction.STORE: (-1, 1),
        GripperAction.DEPLOY: (1, -1),
        GripperAction.HALT: (0, 0),
    }
)
"""Directions of the paddles and of the lift, `None` for one that goes on as it does."""


class SimulatedGripper(ReportingAccessory):
    """A gripper on the general inputs (type 2), delivered open and down.

    GRIPPER 16 (PRESSURE) and 17 (LIFT_CARRY) wait for the GRIPPERVAL that ARIA sends next: it sets
    the grasp time, or raises the lift for that long.
    """

    def __init__(self) -> None:
        super().__init__()
        self._paddles, self._lift = Paddles(), Lift()
        self._paddles.squeeze = GRASP_TIME
        self._held: HeldObject | None = None
        self._valued: GripperAction | None = None
        self._time: float | None = None

    @property
    def held(self) -> HeldObject | None:
        """The object between the paddles."""
        return self._held

    @property
    def opening(self) -> float:
        """Between the paddles [m], as of the last command or report."""
        return self._paddles.opening

    @property
    def height(self) -> float:
        """Height of the lift, 0 down to 1 up, as of the last command or report."""
        return self._lift.height

    @property
    def awaits_value(self) -> bool:
        """Whether the next command 36 is GRIPPERVAL, not the old simulator's laser start."""
        return self._valued is not None

    def put(self, held: HeldObject | None) -> None:
        """Put an object between the paddles, or `None`; ConfigError if it is too wide for them."""
        if held is not None and held.width > self.opening:
            raise ConfigError(
                f"{held.width} m do not fit between paddles {self.opening:.3f} m apart"
            )
        self._held = held

    def switches(self, now: float) -> GripperSwitch:
        """Return the states of its switches and beams."""
        self._advance(now)
        seen = GripperSwitch(0)
        if self.opening < OPENING:
            seen |= GripperSwitch.OPEN_LOW
        if not self._lift.at_limit:
            seen |= GripperSwitch.LIFT_LIMIT_LOW
        if self.opening > self._closest() + CONTACT:
            seen |= GripperSwitch.LEFT_PADDLE_LOW | GripperSwitch.RIGHT_PADDLE_LOW
        if self._held is not None and self._held.outer:
            seen |= GripperSwitch.OUTER_BEAM_BROKEN
        if self._held is not None and self._held.inner:
            seen |= GripperSwitch.INNER_BEAM_BROKEN
        if self._lift.moving:
            seen |= GripperSwitch.LIFT_MOVING
        if self._paddles.moving:
            seen |= GripperSwitch.GRIP_MOVING
        return seen

    def obey(self, command: Command, now: float) -> bool:
        """Move, set durations, take requests for reports."""
        match command:
            case commands.Gripper(action):
                self._advance(now)
                self._act(action)
            case commands.GripperVal(duration):
                self._advance(now)
                self._value(duration)
            case commands.GripperPacRequest(how):
                self._request.set(how)
            case _:
                return False
        return True

    def _act(self, action: GripperAction) -> None:
        self._valued = action if action in VALUED else None
        paddles, lift = DIRECTIONS.get(action, (None, None))
        if paddles is not None:
            self._paddles.drive(paddles)
        if lift is not None:
            self._lift.drive(lift)

    def _value(self, duration: float) -> None:
        if self._valued is GripperAction.PRESSURE:
            self._paddles.squeeze = duration
        elif self._valued is GripperAction.LIFT_CARRY:
            self._lift.drive(1, duration)
        self._valued = None

    def read(self, now: float) -> Report:
        grasp_time = min(0xFF, round(self._paddles.squeeze / TWENTY_MS))
        return GripperState(GENERAL_IO, self.switches(now), grasp_time)

    def inputs(self, sip: SipFields, now: float) -> SipFields:
        """Show the switches in the second I/O byte."""
        return replace(sip, gripper_state=int(self.switches(now)))

    def hang_up(self) -> None:
        """Stand still and send no more reports; a held object stays held."""
        self._act(GripperAction.HALT)
        super().hang_up()

    def _advance(self, now: float) -> None:
        if self._time is not None and now > self._time:
            self._paddles.step(now - self._time, self._closest())
            self._lift.step(now - self._time)
        self._time = now

    def _closest(self) -> float:
        return self._held.width if self._held else 0.0


class NoGripper(ReportingAccessory):
    """No gripper: it answers requests with "none", and ARIA's gripper stops asking."""

    def obey(self, command: Command, now: float) -> bool:
        """Take requests for reports; ignore commands to move."""
        match command:
            case commands.GripperPacRequest(how):
                self._request.set(how)
            case commands.Gripper() | commands.GripperVal():
                pass
            case _:
                return False
        return True

    def read(self, now: float) -> Report:
        return GripperState(NO_GRIPPER, IDLE, 0)
