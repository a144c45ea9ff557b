"""A robot as a notebook shows it, from readings that are given."""

import re
from dataclasses import dataclass, field, replace
from math import inf, nan
from typing import Any, cast
from xml.etree import ElementTree

import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.maps import shipped_map
from pioneer3.models import load_model
from pioneer3.navigation.notebook import LiveView, leave
from pioneer3.navigation.picture import FAR_COLOUR, NEAR_COLOUR, card
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.facade import LoopThread
from pioneer3.runtime.robot import Robot
from pioneer3.state import Battery, Identity, Motors, Odometry, Scan, Snapshot, Sonar

MODEL = load_model("p3dx")
INFO = RobotInfo(
    identity=Identity(name="<b>", family="Pioneer", model="p3dx"),
    model=MODEL,
    limits=cast("Limits", None),
    config=None,
    url="serial:/dev/ttyUSB0",
    speed=9600,
)
HERE = Pose2(1.0, 2.0, 0.5)
SNAPSHOT = Snapshot(
    stamp=10.0,
    sequence=1,
    odometry=Odometry(robot_in_odom=HERE, twist=Twist2(), left_speed=0.0, right_speed=0.0),
    battery=Battery(voltage=12.4, low=True),
    motors=Motors(),
    sonar=Sonar(ranges=(0.3, 2.0, inf, nan)),
    faults=("history<",),
)
SCAN = Scan(
    stamp=9.5,
    sequence=1,
    robot_in_odom=HERE,
    sensor_in_robot=Pose2(),
    angles=(0.0, 0.1),
    ranges=(1.5, inf),
)


@dataclass
class FakeRobot:
    """Readings in the place of a robot."""

    snapshot: Snapshot | None = SNAPSHOT
    info: RobotInfo = INFO
    lasers: list[Any] = field(default_factory=list)
    navigator: Any = None

    def why_not_moving(self) -> Reason:
        return Reason(ReasonKind.FAULT, "No robot is connected: <lost>.")

    def card(self) -> str:
        return card(cast("Robot", self), [(-1.0, 0.5), (0.0, 0.0)])


@dataclass
class FakeLaser:
    """A laser with its last scan."""

    latest: Scan | None


def drawn(html: str) -> ElementTree.Element:
    """Return the last drawing; a browser takes more than this parser does."""
    return ElementTree.fromstring(re.findall(r"<svg.*?</svg>", html, re.DOTALL)[-1])


def test_the_ring_has_an_arc_for_each_echo_and_the_trail_behind() -> None:
    html = FakeRobot().card()
    assert drawn(html) is not None
    assert html.count('class="sonar"') == 2
    assert NEAR_COLOUR in html
    assert FAR_COLOUR in html
    assert 'points="-1.00,-0.50 0.00,-0.00"' in html  # left of a robot is up in its frame


def test_a_fresh_scan_is_drawn_and_an_old_one_is_not() -> None:
    fresh = FakeRobot(lasers=[FakeLaser(SCAN)]).card()
    assert re.findall(r'd="(M\S+ \S+h0)"', fresh) in (["M1.50 0.00h0"], ["M1.50 -0.00h0"])
    assert "h0" not in FakeRobot(lasers=[FakeLaser(replace(SCAN, stamp=8.0))]).card()
    assert "h0" not in FakeRobot(lasers=[FakeLaser(None)]).card()


def test_texts_of_the_robot_are_no_markup() -> None:
    html = FakeRobot().card()
    for text in ("&lt;b&gt;, Pioneer 3-DX", "HISTORY&lt;", "&lt;lost&gt;", "12.4 V, LOW"):
        assert text in html


def test_a_lost_robot_says_why() -> None:
    html = FakeRobot(snapshot=None).card()
    assert "No robot is connected" in html
    assert "<svg" not in html


def test_a_map_has_the_colour_of_the_text_in_a_notebook() -> None:
    html = shipped_map("office")._repr_html_()
    assert drawn(html).tag.endswith("svg")
    assert 'class="wall" stroke="currentColor"' in html
    assert ">Kitchen</text>" in html
    assert "white" not in html


def test_a_snapshot_shows_its_readings() -> None:
    html = SNAPSHOT._repr_html_()
    assert "<tr><th>sonar [m]</th><td>0.30 2.00 - -</td></tr>" in html
    assert "HISTORY&lt;" in html


def test_without_a_notebook_nothing_is_closed_and_a_view_says_so() -> None:
    leave("tcp://localhost:8101")
    with pytest.raises(ConfigError, match="this is no notebook; in a terminal: pioneer3 monitor"):
        LiveView(cast("Robot", FakeRobot()), cast("LoopThread", None))
