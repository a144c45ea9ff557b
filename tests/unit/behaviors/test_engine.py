"""Who drives when several want to."""

from dataclasses import dataclass
from math import inf

import pytest

from pioneer3.behaviors.engine import Decision, Desire, resolve
from pioneer3.geometry import ORIGIN, STILL, Twist2
from pioneer3.state import Battery, Motors, Odometry, Snapshot

ODOMETRY = Odometry(robot_in_odom=ORIGIN, twist=STILL, left_speed=0, right_speed=0)
NOW = Snapshot(
    stamp=0.0, sequence=1, odometry=ODOMETRY, battery=Battery(voltage=12), motors=Motors()
)


@dataclass
class Wants:
    name: str
    priority: int
    desire: Desire | None

    def decide(self, snapshot: Snapshot, now: float) -> Desire | None:
        return self.desire


def decided(*actions: Wants) -> Decision:
    return resolve(actions, NOW, 0.0)


WEB = Wants("web", 80, Desire(v=0.2, w=0.5, until=3.0))
STICK = Wants("stick", 100, Desire(v=-0.1, w=0.0, until=1.0))
STEER = Wants("steer", 90, Desire(w=-0.3, until=2.0))
CAUTION = Wants("caution", 10, Desire(v_max=0.05))


@pytest.mark.parametrize(
    ("actions", "decision"),
    [
        ((), Decision(STILL)),
        ((Wants("idle", 99, None),), Decision(STILL)),
        ((WEB,), Decision(Twist2(0.2, 0.5), 3.0, "web", "web")),
        ((WEB, STICK), Decision(Twist2(-0.1, 0.0), 1.0, "stick", "stick")),
        ((WEB, STEER), Decision(Twist2(0.2, -0.3), 2.0, "web", "steer")),
        ((WEB, CAUTION), Decision(Twist2(0.05, 0.5), 3.0, "web", "web")),
        ((STICK, CAUTION), Decision(Twist2(-0.1, 0.0), 1.0, "stick", "stick")),
        ((CAUTION,), Decision(STILL, inf, None, None)),
    ],
)
def test_each_channel_goes_to_the_highest_priority_that_speaks(
    actions: tuple[Wants, ...], decision: Decision
) -> None:
    assert decided(*actions) == decision
    assert decided(*reversed(actions)) == decision


def test_a_limit_alone_asks_for_nothing() -> None:
    assert not decided(CAUTION).wanted
    assert decided(WEB).wanted
    assert decided(STEER).wanted
