"""A mode of the demo: its description, and functions that know the robot, but no screen."""

from collections.abc import Callable, Coroutine, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

from pioneer3.behaviors.action import Stack
from pioneer3.demo.columns import ColumnRow
from pioneer3.errors import Refusal
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.robot.devices import Acts, Presence
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot

ALWAYS = Presence(True, "Every robot can do this.")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gauge:
    """A value to be drawn as a bar, and its text in words.

    A full bar has the `share` 1, or -1 to the other side if it is `signed`. People should look at
    an `alarm`; the main value of the mode is `big`.
    """

    name: str
    share: float
    text: str
    alarm: bool = False
    big: bool = False
    signed: bool = False


class Context:
    """The robot and the people at it, as every mode of the demo sees them.

    `work` runs a coroutine while the mode is active, and tells what it fails with; it returns what
    ends it before. The pose is 0, 0, 0 at `origin` in odometry's frame; only what is shown depends
    on it.
    """

    def __init__(
        self,
        robot: Robot,
        say: Callable[[str], None],
        work: Callable[[Coroutine[Any, Any, object]], Callable[[], None]],
        acts: Acts,
    ) -> None:
        self.robot = robot
        self.say = say
        self.work = work
        self.acts = acts
        self.origin: Pose2 = ORIGIN

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` while the link is lost."""
        return self.robot.snapshot

    def pose(self, snapshot: Snapshot) -> Pose2:
        """Return where the robot is, seen from :attr:`origin` [m, rad]."""
        return self.origin.inverse() @ snapshot.odometry.robot_in_odom

    def drives(self, stack: Stack | None) -> bool:
        """Whether `stack` drives the robot."""
        return stack is not None and self.robot.arbiter.mode is stack

    def start(self, stack: Stack) -> None:
        """Stop, then let `stack` drive; tell why it does not."""
        self.tell(self.robot.arbiter.start(stack))

    def tell(self, refused: Refusal | None) -> None:
        """Tell that the robot ignores a command, if it does."""
        if refused:
            self.say(refused.text)


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """A mode of the demo in words (facts.md 8).

    `key` activates it, in lower or upper case. `name` is ARIA's, and `label` a shorter one for
    lists. It `needs` equipment, and tells the source from which the demo knows; `help` has its own
    keys and their effects, a line each. `by_hand`: what its keys set goes on until another key, so
    that hands must stay near.
    """

    key: str
    name: str
    hint: str
    make: "Callable[[Context, Description], DemoMode]"
    needs: str = ""
    help: Sequence[str] = ()
    label: str = ""
    by_hand: bool = False


@dataclass(frozen=True, slots=True)
class DemoMode:
    """A mode of the demo for one robot.

    `presence` is that of its equipment. It begins by `begin`, and holds the block `enter` while it
    is active; `again` is called when it is chosen once more. `on_key` takes a key, and returns
    whether that means anything. It shows ARIA's columns in a `row`, if there is anything to show,
    bars, longer texts of a line each, and points to draw around the robot, x ahead and y to the
    left of it [m].
    """

    about: Description
    presence: Callable[[], Presence] = lambda: ALWAYS
    begin: Callable[[], object] = lambda: None
    enter: Callable[[], AbstractContextManager[object]] = nullcontext
    on_key: Callable[[str], bool] = lambda key: False
    again: Callable[[], object] = lambda: None
    row: Callable[[], ColumnRow | None] = lambda: None
    gauges: Callable[[], Sequence[Gauge]] = lambda: ()
    details: Callable[[], Sequence[str]] = lambda: ()
    points: Callable[[], Sequence[tuple[float, float]]] = lambda: ()
