"""`pioneer3 monitor`: everything on 80 columns and 24 rows."""

from dataclasses import replace
from io import StringIO
from math import inf, nan, pi

import pytest
from rich.console import Console

from pioneer3.cli.screen import bar, line, screen
from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import load_model
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import Connection, ConnectionStatus, RobotInfo
from pioneer3.state import (
    Battery,
    Bumpers,
    Identity,
    Inputs,
    LinkQuality,
    Motors,
    Odometry,
    Snapshot,
    Sonar,
)

MODEL = load_model("p3at-sh")
ROBOT = RobotInfo(
    identity=Identity(name="Bender", family="Pioneer", model="p3at-sh"),
    model=MODEL,
    limits=limits_for(MODEL, None),
    config=None,
    url="serial:/dev/ttyUSB0",
    speed=9600,
)
WORST = Snapshot(
    stamp=0.0,
    sequence=7,
    odometry=Odometry(
        robot_in_odom=Pose2(-1.25, 2.5, pi / 2),
        twist=Twist2(0.3, -pi / 4),
        left_speed=0.4,
        right_speed=0.2,
    ),
    battery=Battery(voltage=11.2, charge=0.3, low=True),
    motors=Motors(enabled=True, left_stalled=True, moving=True, stop_button=True),
    sonar=Sonar(ranges=(0.3, 0.8, inf, nan, *(2.0,) * 12), enabled=True),
    bumpers=Bumpers(front=(False, True, False, False, False), rear=(False,) * 5),
    inputs=Inputs(digital_in=0xF0, analog=2.5, compass=pi, temperature=40),
    link=LinkQuality(reports=100, bad_checksums=3, bytes_skipped=99, rate=10.0, sessions=2),
    faults=("gyro fault",),
)
BECAUSE = Reason(ReasonKind.FAULT, "Because.")
CONNECTED = ConnectionStatus(Connection.CONNECTED, "Bender")


def shown(
    snapshot: Snapshot | None, status: ConnectionStatus = CONNECTED, width: int = 80
) -> list[str]:
    """Return the lines of the screen."""
    console = Console(file=StringIO(), width=width, height=24, highlight=False)
    console.print(screen(ROBOT, snapshot, BECAUSE, status, width=width))
    return console.file.getvalue().splitlines()  # type: ignore[attr-defined, no-any-return]


def test_everything_fits_on_24_rows_of_80_columns() -> None:
    lines = shown(WORST)
    text = "\n".join(lines)
    assert len(lines) == 24
    assert max(map(len, lines)) <= 80
    for word in (
        "ROBOT  Bender, Pioneer 3-AT",
        "-1.250 m",
        "+90.0 deg",
        "-45.0 deg/s",
        "11.2 V, 30%, LOW",
        "on, moving",
        "PRESSED",
        "LEFT",
        "bumps front □■□□□ ",
        "bumps rear  □□□□□ ",
        "11110000 2.50 V ",
        "+180 deg",
        "40 °C",
        "gyro fault",
        "nearest 0.30 m, pinging",
        "3 bad checksums, 99 bytes lost",
        "Because.",
    ):
        assert word in text


def test_front_and_rear_ring_stand_side_by_side() -> None:
    heads = [row for row in shown(WORST) if "front " in row and "rear " in row]
    assert any("□" not in row for row in heads)


def test_a_lost_link_is_said_loudly_and_why() -> None:
    text = "\n".join(shown(None, ConnectionStatus(Connection.LOST, "cable pulled")))
    assert "no readings: the link is lost" in text
    assert "lost: cable pulled" in text


def test_robots_with_four_rings_or_none_are_shown_too() -> None:
    many = replace(WORST, sonar=Sonar(ranges=(1.0,) * 32))
    assert "from number 16" in "\n".join(shown(many))
    assert "no sonar" in "\n".join(shown(replace(WORST, sonar=Sonar())))


@pytest.mark.parametrize(
    ("metres", "drawn"), [(5.0, "████"), (inf, "████"), (2.5, "██  "), (0.0, "    "), (nan, "?")]
)
def test_a_bar_is_as_long_as_the_range(metres: float, drawn: str) -> None:
    assert bar(metres, 4).plain == drawn


def test_a_line_says_the_same_without_a_screen() -> None:
    text = line(WORST)
    assert text.startswith("#7  x -1.250 m")
    assert "STOP BUTTON  STALLED  BUMPED  GYRO FAULT" in text
    assert "\n" not in text
