"""What all modes share: the robot, a voice, a hand for what takes time."""

from collections.abc import Callable, Coroutine
from typing import Any

from pioneer3.behaviors.action import Stack
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.robot.devices import Acts
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot


class Cockpit:
    """Given to every mode.

    Args:
        robot: Connected.
        say: Tells people a sentence.
        work: Runs a coroutine while the mode is active, and tells what it fails with; returns what
            ends it before.
        acts: The colour tracker.

    Attributes:
        origin: Where the pose is 0, 0, 0 in odometry's frame; only what is shown depends on it.
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
        """The latest reading, or `None` while the link is lost."""
        return self.robot.snapshot

    def pose(self, snapshot: Snapshot) -> Pose2:
        """Return where the robot is, seen from :attr:`origin` [m, rad]."""
        return self.origin.inverse() @ snapshot.odometry.robot_in_odom

    def drives(self, stack: Stack | None) -> bool:
        """Whether `stack` is what drives the robot."""
        return stack is not None and self.robot.arbiter.mode is stack

    def start(self, stack: Stack) -> None:
        """Stop, then let `stack` drive; tell why it does not."""
        self.tell(self.robot.arbiter.start(stack))

    def tell(self, refused: str | None) -> None:
        """Tell why the robot ignores what it was asked, if it does."""
        if refused:
            self.say(refused)
