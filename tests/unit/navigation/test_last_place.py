"""The place that is remembered from one program to the next."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.navigation.last_place import (
    LastPlace,
    last_place_file,
    read_last_place,
    write_last_place,
)
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity

MAP = LineMap(name="one", walls=np.array([[0.0, 0.0, 1.0, 0.0]]))
LEFT = LastPlace(Pose2(3.0, 1.0, 0.5), Pose2(2.0, 0.0, 0.1))


def test_odometry_that_went_on_and_odometry_that_began_anew_give_different_guesses() -> None:
    there = LEFT.odom_in_map @ LEFT.robot_in_odom
    assert LEFT.guesses(ORIGIN) == [there]
    assert LEFT.guesses(LEFT.robot_in_odom) == [there]
    now = Pose2(4.0, 0.5, 0.0)
    assert LEFT.guesses(now) == [LEFT.odom_in_map @ now, there]
    assert LEFT.goes_on(LEFT.robot_in_odom)
    assert not LEFT.goes_on(ORIGIN)
    assert not LastPlace(Pose2(3.0), ORIGIN).goes_on(ORIGIN)


def test_a_place_is_kept_until_it_is_forgotten(tmp_path: Path) -> None:
    file = tmp_path / "places" / "a.json"
    assert read_last_place(file) is None
    write_last_place(file, LEFT)
    assert read_last_place(file) == LEFT
    assert [each.name for each in file.parent.iterdir()] == ["a.json"]
    write_last_place(file, None)
    write_last_place(file, None)
    assert read_last_place(file) is None


@pytest.mark.parametrize("text", [b"", b"{}", b"[1]", b"\xff", b'{"odom_in_map": NaN}'])
def test_a_spoilt_file_is_no_place(tmp_path: Path, text: bytes) -> None:
    file = tmp_path / "a.json"
    file.write_bytes(text)
    assert read_last_place(file) is None


def test_a_folder_that_cannot_be_written_to_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "places").write_text("a file")
    write_last_place(tmp_path / "places" / "a.json", LEFT)


def test_robots_and_maps_have_files_of_their_own() -> None:
    model = load_model("p3dx-sh")
    ann = RobotInfo(
        identity=Identity(name="Ann", family="Pioneer", model="p3dx-sh"),
        model=model,
        limits=limits_for(model, None),
        config=None,
        url="/dev/ttyUSB0",
        speed=9600,
    )
    home = {"XDG_STATE_HOME": "/state"}
    file = last_place_file(ann, MAP, home)
    assert file.parent == Path("/state/pioneer3/places")
    assert last_place_file(replace(ann, url="/dev/ttyUSB1"), MAP, home) == file
    ben = replace(ann, identity=replace(ann.identity, name="Ben"))
    other = LineMap(name="one", walls=MAP.walls + 1.0)
    assert len({file, last_place_file(ben, MAP, home), last_place_file(ann, other, home)}) == 3
    one, two = (
        replace(ann, identity=replace(ann.identity, name="MobileSim"), url=f"tcp://a:{port}")
        for port in (8101, 8102)
    )
    assert last_place_file(one, MAP, home) != last_place_file(two, MAP, home)
