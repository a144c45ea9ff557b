"""Driving with keys, guarded and not (facts.md 8.3)."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from pioneer3.behaviors import modes as stacks
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import RatioInput
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.driving import driving_row, speed_gauges
from pioneer3.demo.modes.mode import Gauge, Mode
from pioneer3.demo.modes.row import Row

HELP = (
    "up, down: speed ±5 %",
    "left, right: turn a little",
    "space: stop",
    "e: motors on",
)
WARNING = "NOTHING KEEPS IT FROM HITTING THINGS AND PEOPLE"


def teleop(cockpit: Cockpit) -> Mode:
    """Return the mode that stops before obstacles."""
    hand = _Hand(cockpit, stacks.teleop)
    return hand.mode("t", "teleop", "teleop", HELP)


def unguarded(cockpit: Cockpit) -> Mode:
    """Return the mode that does not."""
    hand = _Hand(cockpit, stacks.unguarded)
    return hand.mode("u", "unguarded teleop", "unguarded", (WARNING, *HELP))


class _Hand:
    """Keys set a share of full speed; the robot keeps it until the next key."""

    def __init__(self, cockpit: Cockpit, make: Callable[[RatioInput], Stack]) -> None:
        self._cockpit = cockpit
        self._make = make
        self._ratios = RatioInput()
        self._stack: Stack | None = None
        self._has_charge = False

    def mode(self, key: str, name: str, label: str, help_: Sequence[str]) -> Mode:
        return Mode(
            key=key,
            name=name,
            label=label,
            help=help_,
            by_hand=True,
            enter=self._enter,
            on_key=self._on_key,
            again=self._again,
            row=self._row,
            gauges=self._gauges,
        )

    @contextmanager
    def _enter(self) -> Iterator[None]:
        self._begin()
        yield

    def _begin(self) -> None:
        """Stop, and begin with no speed set."""
        self._ratios = RatioInput()
        self._stack = self._make(self._ratios)
        self._cockpit.start(self._stack)

    def _again(self) -> None:
        if not self._cockpit.drives(self._stack):
            self._begin()

    def _on_key(self, key: str) -> bool:
        match key:
            case "up" | "down" | "left" | "right":
                self._steer(key)
            case "space":
                self._begin()
            case "e" | "E":
                self._cockpit.tell(self._cockpit.robot.arbiter.set_motors(on=True))
                self._begin()
            case "z" | "x" | "Z" | "X":
                self._cockpit.say("z, x drive sideways: no Pioneer 3 can.")
            case _:
                return False
        return True

    def _steer(self, key: str) -> None:
        if self._cockpit.snapshot is None:
            self._cockpit.say("No robot is connected.")
            return
        self._again()  # what ended must be started anew, with no speed set
        ratios = self._ratios
        {"up": ratios.up, "down": ratios.down, "left": ratios.left, "right": ratios.right}[key]()
        self._cockpit.tell(self._cockpit.robot.arbiter.decide())

    def _row(self) -> Row | None:
        snapshot = self._cockpit.snapshot
        if snapshot is None:
            return None
        self._has_charge = self._has_charge or snapshot.battery.charge is not None
        return driving_row(
            snapshot,
            self._cockpit.pose(snapshot),
            has_charge=self._has_charge,
            emergency=self._cockpit.robot.supervisor.pilot.emergency,
        )

    def _gauges(self) -> Sequence[Gauge]:
        share = self._ratios.keyed if self._cockpit.drives(self._stack) else 0.0
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
            *speed_gauges(self._cockpit),
        )
