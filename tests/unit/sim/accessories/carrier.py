"""A robot as its accessories feel it, moved by hand."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from pioneer3.arcos.reports import Report
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.accessories.base import Accessory


@dataclass
class FakeBattery:
    charge: float = 1.0
    fixed: float | None = None


@dataclass
class FakeCarrier:
    model: RobotModel = field(default_factory=lambda: load_model("p3dx-sh"))
    robot_in_world: Pose2 = ORIGIN
    battery: FakeBattery = field(default_factory=FakeBattery)
    wheel_travel: tuple[float, float] = (0.0, 0.0)


def cycles(accessory: Accessory, count: int, start: float = 0.0) -> list[Report]:
    """Return what `accessory` sends in `count` cycles of 0.1 s."""
    sent: list[Report] = []
    for number in range(1, count + 1):
        sent += accessory.reports(start + number * 0.1, cycle=True)
    return sent


def answers(accessory: Accessory, now: float = 0.0) -> Sequence[Report]:
    """Return what `accessory` sends between two cycles."""
    return accessory.reports(now, cycle=False)
