"""The demo's laser mode with several lasers: digits choose, and the picture follows."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import pi
from types import SimpleNamespace
from typing import Any, cast

from pioneer3.demo.mode import Context, DemoMode
from pioneer3.demo.modes import MODES
from pioneer3.demo.modes.sensors import laser
from pioneer3.geometry import Pose2
from pioneer3.robot.devices import Presence
from pioneer3.state import Scan

LASER = next(about for about in MODES if about.key == "l")


class Source:
    """A laser that sees one thing `metres` ahead of it."""

    lost: str | None = None

    def __init__(self, name: str, metres: float, pose: Pose2) -> None:
        self.presence = Presence(True, f"{name}.")
        self.users = 0
        self.latest = Scan(
            stamp=0.0,
            sequence=1,
            robot_in_odom=Pose2(),
            sensor_in_robot=pose,
            angles=(0.0,),
            ranges=(metres,),
        )

    @contextmanager
    def wanted(self) -> Iterator[None]:
        """Count who looks."""
        self.users += 1
        yield
        self.users -= 1


FRONT, REAR = Source("front", 2.0, Pose2()), Source("rear", 1.0, Pose2(-0.2, 0.0, pi))


def mode(*lasers: Source) -> tuple[DemoMode, list[str]]:
    """Return the mode on a robot with these lasers, and what it says."""
    said: list[str] = []
    robot: Any = SimpleNamespace(lasers=lasers, laser=lasers[0])
    context: Any = SimpleNamespace(robot=robot, say=said.append, snapshot=object())
    return laser(cast("Context", context), LASER), said


def drawn(shown: DemoMode) -> list[tuple[float, float]]:
    """Return the points of the picture, in cm."""
    return [(round(100 * x), round(100 * y)) for x, y in shown.points()]


def test_a_digit_chooses_another_laser_for_the_picture_and_lets_the_first_go() -> None:
    shown, said = mode(FRONT, REAR)
    with shown.enter():
        assert (drawn(shown), FRONT.users, REAR.users) == ([(200, 0)], 1, 0)
        assert shown.on_key("2")
        assert (drawn(shown), FRONT.users, REAR.users) == ([(-120, 0)], 0, 1)
    assert said == ["Laser 2 it is: rear."]
    assert REAR.users == 0


def test_a_laser_that_is_not_there_is_refused_with_those_that_are() -> None:
    shown, said = mode(FRONT, REAR)
    alone, alone_said = mode(FRONT)
    assert shown.on_key("3")
    assert alone.on_key("2")
    assert said == ["There is no laser 3: there are lasers 1 to 2."]
    assert alone_said == ["There is no laser 2: laser 1 is the only one."]
    assert drawn(shown) == [(200, 0)]


def test_a_lost_laser_is_told_beside_its_last_readings() -> None:
    gone = Source("front", 2.0, Pose2())
    gone.lost = "the laser is lost"
    shown, _ = mode(gone)
    row = shown.row()
    assert row is not None
    assert row.tail.endswith("1 readings   LOST")
