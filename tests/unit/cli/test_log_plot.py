"""`pioneer3 log plot` draws the way and the curves of a run, in the terminal or as a picture."""

from dataclasses import replace
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import pioneer3
from pioneer3.analysis.curves import run_drawn
from pioneer3.cli.log_plot import plot
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.maps.write import aria_text
from pioneer3.navigation.recording import EstimateMade, MapUsed
from pioneer3.runtime.recording import DecisionMade
from pioneer3.state import Snapshot
from tests.unit.analysis.support import Message, decided, driven, snapshot, topic, write_log

ESTIMATES = topic("estimate", EstimateMade)
ROOM = LineMap(name="room", walls=np.array([[0.0, 0.0, 9.0, 0.0], [9.0, 0.0, 9.0, 4.0]]))


def placed(time: float, x: float | None) -> Message:
    pose = None if x is None else Pose2(x, 3.0, 0.0)
    told = EstimateMade(map="room", robot_in_map=pose, odom_in_map=None, sure=pose is not None)
    return time, ESTIMATES, told


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Return a log of a drive on a map."""
    used = MapUsed(name="room", file="", sha256="", text=aria_text(ROOM))
    messages = [
        *driven(2.0),
        (0.1, topic("map", MapUsed), used),
        (0.5, topic("decision", DecisionMade), decided("", 0.5)),
        *(placed(time, x) for time, x in ((0.2, None), (0.5, 4.0), (1.0, 5.0), (1.5, 6.0))),
    ]
    return write_log(tmp_path / "a.mcap", messages, robots={"": "b\x1b[31mob"})


def test_the_way_is_on_the_map_where_that_is_known(log: Path, tmp_path: Path) -> None:
    run = run_drawn(pioneer3.log.open(log))
    assert run.way.tolist() == [[4.0, 3.0], [5.0, 3.0], [6.0, 3.0]]
    assert run.line_map is not None
    assert [chart.title for chart in run.charts] == ["speed", "turn rate", "battery", "link"]
    wanted, measured = run.charts[0].curves
    assert (wanted.values.tolist(), set(measured.values)) == ([0.5], {0.5})
    by_odometry = run_drawn(pioneer3.log.open(write_log(tmp_path / "b.mcap", driven(1.0))))
    assert by_odometry.line_map is None
    assert by_odometry.way[-1] == pytest.approx([0.5, 0.0])


def test_numbers_that_no_robot_has_are_left_out(tmp_path: Path) -> None:
    wrong = [
        (1.0 + number, topic("snapshot", Snapshot), replace(snapshot(1.0), odometry=odometry))
        for number, odometry in enumerate(
            replace(snapshot(1.0).odometry, robot_in_odom=Pose2(*each, 0.0))
            for each in ((nan, 0.0), (0.0, inf), (-1e300, 0.0))
        )
    ]
    run = run_drawn(pioneer3.log.open(write_log(tmp_path / "a.mcap", [*driven(1.0), *wrong])))
    assert run.way[-1] == pytest.approx([0.5, 0.0])


def test_a_terminal_shows_the_map_the_curves_and_no_escape_of_a_name(
    log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert plot(str(log)) == 0
    text = capsys.readouterr().out
    assert "\x1b" not in text
    words = ("on the map room, to x 6.0, y 3.0 m", "■", "speed [m/s]", "battery [V]", "12.50")
    assert [each for each in words if each not in text] == []
    assert max(map(len, text.splitlines())) <= 80


def test_a_picture_is_drawn_with_ink(log: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    picture = tmp_path / "a.png"
    assert plot(str(log), output=picture) == 0
    with Image.open(picture) as drawn:
        assert drawn.size == (1320, 770)
        assert len(drawn.convert("RGB").getcolors(1 << 20) or []) > 50
    for wrong in (tmp_path / "none" / "a.png", tmp_path / "a.nix"):
        with pytest.raises(ConfigError, match="cannot be written"):
            plot(str(log), output=wrong)


def test_a_log_without_a_report_says_so(tmp_path: Path) -> None:
    path = write_log(tmp_path / "b.mcap", [])
    with pytest.raises(ConfigError, match="no report of a robot was logged"):
        plot(str(path))
