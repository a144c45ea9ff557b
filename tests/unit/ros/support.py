"""Messages without ROS: whatever is asked for is there."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import RobotModel, load_model
from pioneer3.models.description.tree import tree_of
from pioneer3.ros.messages.update import MessageOptions, StateUpdate
from pioneer3.state import Battery, Motors, Odometry, Snapshot


class Blank(SimpleNamespace):
    """A message of any type, empty; parts that are read before they are set are blank too.

    Such a part may stand for a list, and has nothing in it.
    """

    def __getattr__(self, name: str) -> Any:
        if name.isupper() or name.startswith("_"):  # constants, which not every version has
            raise AttributeError(name)
        part = Blank()
        setattr(self, name, part)
        return part

    def __len__(self) -> int:
        return 0

    def __iter__(self) -> Iterator[Any]:
        return iter(())


def seen(
    robot_in_odom: Pose2 | None = None,
    twist: Twist2 | None = None,
    *,
    left: float = 0.0,
    right: float = 0.0,
    **parts: Any,
) -> Snapshot:
    """Return a snapshot of a robot at this pose, with these speeds."""
    parts = {"battery": Battery(voltage=12.4), "motors": Motors(), **parts}
    return Snapshot(
        stamp=5.0,
        sequence=1,
        odometry=Odometry(
            robot_in_odom=robot_in_odom or Pose2(),
            twist=twist or Twist2(),
            left_speed=left,
            right_speed=right,
        ),
        **parts,
    )


P3AT = load_model("p3at-sh")


def update(
    snapshot: Snapshot,
    options: MessageOptions | None = None,
    model: RobotModel = P3AT,
    **parts: Any,
) -> StateUpdate:
    """Return `snapshot` of a P3-AT, ready to convert; its stamp is a word."""
    chosen = options or MessageOptions()
    return StateUpdate(
        snapshot=snapshot,
        model=model,
        tree=tree_of(model, chosen.frames, chosen.wheel_joints, chosen.sonar_height),
        frames=chosen.frames.with_prefix(chosen.prefix),
        options=chosen,
        stamp="now",
        make=lambda kind: Blank(kind=kind),
        **parts,
    )
