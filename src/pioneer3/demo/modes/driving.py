"""Driving with keys, guarded and not, and by itself (facts.md 8.3, 8.4)."""

from collections.abc import Callable, Sequence

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import RatioInput
from pioneer3.behaviors.modes import Mode
from pioneer3.behaviors.modes import by_hand as stacks
from pioneer3.demo.columns import (
    ColumnCell,
    ColumnRow,
    degrees_tenths,
    millimetres,
    tenths,
    whole_degrees,
)
from pioneer3.demo.mode import Context, DemoMode, Description, Gauge
from pioneer3.geometry import Pose2
from pioneer3.state import Snapshot
from pioneer3.units import DEGREE

WIDTH = 10


def motion(snapshot: Snapshot, pose: Pose2) -> tuple[ColumnCell, ...]:
    """Return `transVel rotVel x y th volts`, each ten wide."""
    twist = snapshot.odometry.twist
    return (
        ColumnCell("transVel", WIDTH, millimetres(twist.v)),
        ColumnCell("rotVel", WIDTH, whole_degrees(twist.w)),
        ColumnCell("x", WIDTH, millimetres(pose.x)),
        ColumnCell("y", WIDTH, millimetres(pose.y)),
        ColumnCell("th", WIDTH, degrees_tenths(pose.theta)),
        ColumnCell("volts", WIDTH, tenths(snapshot.battery.voltage)),
    )


def motion_row(context: Context) -> ColumnRow | None:
    """Return the columns of a mode that drives by itself."""
    snapshot = context.snapshot
    return ColumnRow(motion(snapshot, context.pose(snapshot))) if snapshot else None


def driving_row(
    snapshot: Snapshot, pose: Pose2, *, has_charge: bool = False, emergency: bool = False
) -> ColumnRow:
    """Return the columns of the teleop modes, for a robot at `pose` [m, rad].

    `has_charge`: it has told its state of charge; `emergency`: our own stop is latched, too.
    """
    cells = motion(snapshot, pose)
    if has_charge:
        cells += (ColumnCell("soc", WIDTH, tenths(100 * (snapshot.battery.charge or 0.0))),)
    flags = {
        "[ESTOP]": snapshot.motors.stop_button or emergency,
        "[STALL]": snapshot.motors.stalled,
        "[DISABLED]": not snapshot.motors.enabled,
    }
    return ColumnRow(cells, tail="".join(f" {flag}" for flag, up in flags.items() if up))


def speed_gauges(context: Context) -> tuple[Gauge, ...]:
    """Return the speeds of the robot as shares of its limits."""
    snapshot, limits = context.snapshot, context.robot.info.limits
    if snapshot is None:
        return ()
    twist = snapshot.odometry.twist
    return (
        Gauge(
            name="speed", share=twist.v / limits.max_speed, text=f"{twist.v:+z.2f} m/s", signed=True
        ),
        Gauge(
            name="turn",
            share=-twist.w / limits.max_turn_rate,
            text=f"{twist.w / DEGREE:+z.0f} deg/s",
            signed=True,
        ),
    )


def teleop(context: Context, about: Description) -> DemoMode:
    """Return the mode that stops before obstacles."""
    return _Hand(context, stacks.teleop).mode(about)


def unguarded(context: Context, about: Description) -> DemoMode:
    """Return the mode that does not."""
    return _Hand(context, stacks.unguarded).mode(about)


class _Hand:
    """Keys set a share of full speed; the robot keeps it until the next key."""

    def __init__(self, context: Context, make: Callable[[RatioInput], Stack]) -> None:
        self._context = context
        self._make = make
        self._ratios = RatioInput()
        self._stack: Stack | None = None
        self._has_charge = False

    def mode(self, about: Description) -> DemoMode:
        return DemoMode(
            about,
            begin=self._begin,
            on_key=self._on_key,
            again=self._again,
            row=self._row,
            gauges=self._gauges,
        )

    def _begin(self) -> None:
        """Stop, and begin with no speed set."""
        self._ratios = RatioInput()
        self._stack = self._make(self._ratios)
        self._context.start(self._stack)

    def _again(self) -> None:
        if not self._context.drives(self._stack):
            self._begin()

    def _on_key(self, key: str) -> bool:
        match key:
            case "up" | "down" | "left" | "right":
                self._steer(key)
            case "space":
                self._begin()
            case "e" | "E":
                self._context.tell(self._context.robot.arbiter.set_motors(on=True))
                self._begin()
            case "z" | "x" | "Z" | "X":
                self._context.say("z, x drive sideways: no Pioneer 3 can.")
            case _:
                return False
        return True

    def _steer(self, key: str) -> None:
        if self._context.snapshot is None:
            self._context.say("No robot is connected.")
            return
        self._again()  # what ended must be started anew, with no speed set
        ratios = self._ratios
        {"up": ratios.up, "down": ratios.down, "left": ratios.left, "right": ratios.right}[key]()
        self._context.tell(self._context.robot.arbiter.decide())

    def _row(self) -> ColumnRow | None:
        snapshot = self._context.snapshot
        if snapshot is None:
            return None
        self._has_charge = self._has_charge or snapshot.battery.charge is not None
        return driving_row(
            snapshot,
            self._context.pose(snapshot),
            has_charge=self._has_charge,
            emergency=self._context.robot.supervisor.pilot.emergency,
        )

    def _gauges(self) -> Sequence[Gauge]:
        share = self._ratios.keyed if self._context.drives(self._stack) else 0.0
        idle = share and self._ratios.too_little
        return (
            Gauge(
                name="SET",
                share=share,
                text=f"{round(100 * share):+d}%" + (" too little" if idle else ""),
                alarm=share != 0,
                big=True,
                signed=True,
            ),
            *speed_gauges(self._context),
        )


def by_itself(mode: Mode) -> Callable[[Context, Description], DemoMode]:
    """Return the maker of a mode of the demo that runs `mode`."""

    def make(context: Context, about: Description) -> DemoMode:
        stack: Stack | None = None

        def begin() -> None:
            nonlocal stack
            if not context.drives(stack):
                stack = mode.stack(context.robot.info.limits)
                context.start(stack)

        return DemoMode(
            about,
            begin=begin,
            again=begin,
            row=lambda: motion_row(context),
            gauges=lambda: speed_gauges(context),
        )

    return make
