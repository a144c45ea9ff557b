"""ARIA maps become walls [m]; what is wrong with one is said in one line."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, empty_map, read_map
from pioneer3.text import LARGEST_FILE

SQUARE = "2D-Map\nLINES\n0 0 1000 0\n1000 0 1000 2000\n"


def written(folder: Path, content: str | bytes) -> Path:
    path = folder / "m.map"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def read(folder: Path, content: str | bytes) -> LineMap:
    return read_map(written(folder, content))


def test_lines_become_metres(tmp_path: Path) -> None:
    drawn = read(tmp_path, SQUARE)
    np.testing.assert_allclose(drawn.walls, [[0, 0, 1, 0], [1, 0, 1, 2]])
    assert drawn.bounds == (0.0, 0.0, 1.0, 2.0)
    assert drawn.name == "m"


def test_an_empty_map_has_no_walls_and_no_extent() -> None:
    assert empty_map().walls.shape == (0, 4)
    assert empty_map().bounds == (0.0, 0.0, 0.0, 0.0)


def test_walls_cannot_be_changed(tmp_path: Path) -> None:
    mine = np.zeros((1, 4))
    drawn = LineMap(name="m", walls=mine)
    mine[0, 0] = 7.0
    assert drawn.walls[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        drawn.walls[0, 0] = 7.0


@pytest.mark.parametrize("header", ["2D-Map", "2D-Map-Ex", "2D-Map-Ex2"])
def test_every_header_is_read(tmp_path: Path, header: str) -> None:
    assert len(read(tmp_path, SQUARE.replace("2D-Map", header)).walls) == 2


@pytest.mark.parametrize("key", ["OriginLatLonAlt", "OriginLatLongAlt"])
def test_both_spellings_of_the_origin_are_accepted(tmp_path: Path, key: str) -> None:
    assert len(read(tmp_path, SQUARE.replace("LINES", f"{key}: 42.8 -71.5 72\nLINES")).walls) == 2


def test_comments_blank_lines_and_windows_line_ends_are_tolerated(tmp_path: Path) -> None:
    text = "# ours\n\n" + SQUARE.replace("LINES\n", "; doors\nLINES\n\n# north\n  ")
    for content in (text, text.replace("\n", "\r\n"), "\ufeff" + text):
        assert len(read(tmp_path, content).walls) == 2


def test_counts_in_the_file_are_not_trusted(tmp_path: Path) -> None:
    text = SQUARE.replace("LINES", "NumLines: 77\nLineMinPos: 5 5\nLineMaxPos: x\nLINES")
    assert read(tmp_path, text).bounds == (0.0, 0.0, 1.0, 2.0)


def test_walls_of_all_sensors_are_read(tmp_path: Path) -> None:
    text = (
        "2D-Map-Ex\nSources: low high\nResolution: 20\nhighResolution: 100\n"
        "LINES\n0 0 1 1\nhigh_LINES\n0 0 2 2\nhigh_DATA\n0 0\nDATA\n0 0\n"
    )
    walls = read(tmp_path, text).walls
    assert len(walls) == 2 + 4 + 4
    np.testing.assert_allclose(abs(walls[2:6]), np.full((4, 4), 0.05))
    np.testing.assert_allclose(abs(walls[6:]), np.full((4, 4), 0.01))


def test_a_point_is_the_centre_of_a_cell_of_20_mm_unless_told(tmp_path: Path) -> None:
    assert read(tmp_path, "2D-Map\nDATA\n100 200\n").bounds == pytest.approx(
        (0.09, 0.19, 0.11, 0.21)
    )


def test_cairns_are_places_lines_and_areas(tmp_path: Path) -> None:
    text = (
        '2D-Map\nCairn: Goal 1000 -2000 -91.9 "" ICON "Lab door"\n'
        'Cairn: RobotHome 1 2 180 "" ICON ""\n'
        'Cairn: ForbiddenLine 9 9 45 "" ICON "" 0 0 1000 0\n'
        'MapInfo: BoundaryType Name=Tape "Desc=on the floor"\n'
        'Cairn: Tape 0 0 0 "" ICON "t" 0 0 0 1000\n'
        'Cairn: ForbiddenArea 0 0 90 "" ICON "" 0 0 2000 1000\n'
    )
    goal, home, line, tape, area = read(tmp_path, text).objects
    assert (goal.kind, goal.name, goal.outline) == ("Goal", "Lab door", ())
    assert goal.pose.x == pytest.approx(1.0)
    assert goal.pose.theta == pytest.approx(-91.9 * pi / 180)
    assert read(tmp_path, text).homes == (home.pose,) == (Pose2(0.001, 0.002, pi),)
    assert line.outline == ((0, 0), (1, 0))
    assert tape.outline == ((0, 0), (0, 1))
    corners = np.array([[0, 0], [0, 2], [-1, 2], [-1, 0]])
    np.testing.assert_allclose(area.outline, corners, atol=1e-12)


def test_a_box_obstacle_is_four_walls_turned_about_the_map_origin(tmp_path: Path) -> None:
    text = '2D-Map\nCairn: Sim.BoxObstacle 5 5 90 "" ICON "" 1000 1000 2000 1500\n'
    walls = [(-1, 1, -1, 2), (-1, 2, -1.5, 2), (-1.5, 2, -1.5, 1), (-1.5, 1, -1, 1)]
    np.testing.assert_allclose(read(tmp_path, text).walls, np.array(walls), atol=1e-12)


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ("", "1: header: the file is empty"),
        ("\n\n\n", "1: header: the file is empty"),
        ("hello\n", "1: header: expected 2D-Map"),
        (b"\x89PNG\r\n\x1a\n\0\0\0", "1: header: expected 2D-Map"),
        (bytes(range(256)), "header: expected 2D-Map"),
        ("2D-Map\n1 2 3 4\n", "2: header: expected 'Key: value'"),
        ("2D-Map\nLINES\n1 2 3\n", "3: LINES: expected numbers x1 y1 x2 y2, not '1 2 3'"),
        ("2D-Map\nDATA\n1 2 3\n", "3: DATA: expected numbers x y, not '1 2 3'"),
        ("2D-Map\nLINES\n1 2 3 four\n", "3: LINES: '1 2 3 four' is not all numbers"),
        ("2D-Map\nLINES\n1 2 3 nan\n", "3: LINES: 'nan' is not within 100 km"),
        ("2D-Map\nDATA\n1 -inf\n", "3: DATA: '-inf' is not within 100 km"),
        ("2D-Map\nLINES\n1 2 3 1e9\n", "3: LINES: '1e9' is not within 100 km"),
        ("2D-Map\nResolution: 20000\nDATA\n1 1\n", "2: Resolution: 20000 mm is not in 1 to"),
        ("2D-Map\nResolution: 1 2\nDATA\n1 1\n", "2: Resolution: expected one number"),
        ("2D-Map\nCairn: Goal 1 2\n", "2: Cairn: 3 fields instead of 7 or 11"),
        ('2D-Map\nCairn: Goal 1 2 x "" ICON ""\n', "2: Cairn: '1 2 x' is not all numbers"),
        ('2D-Map\nCairn: Goal 1 2 3 "" ICON "" 1 2 3 inf\n', "2: Cairn: 'inf' is not within"),
    ],
)
def test_what_is_wrong_with_a_map_is_said_in_one_line(
    tmp_path: Path, content: str | bytes, complaint: str
) -> None:
    path = written(tmp_path, content)
    with pytest.raises(ConfigError) as caught:
        read_map(path)
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    assert complaint in message
    assert message.isprintable()


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"nope\.map: cannot read .*No such file"):
        read_map(tmp_path / "nope.map")


def test_a_directory_is_not_a_map(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is a directory"):
        read_map(tmp_path)


def test_a_device_is_not_read() -> None:
    with pytest.raises(ConfigError, match="not a regular file"):
        read_map(Path("/dev/zero"))


def test_a_file_that_is_not_ours_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    # file modes would not stop a test that runs as root
    path = written(tmp_path, SQUARE)
    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(ConfigError, match=r"m\.map: cannot read .*Permission denied"):
        read_map(path)


@pytest.mark.parametrize("name", ["a\0b", "x" * 5000, "line\nbreak"])
def test_a_name_no_file_can_have_is_a_one_line_error(name: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read_map(Path(name))
    assert str(caught.value).isprintable()


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.map"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    with pytest.raises(ConfigError, match="larger than 16 MB"):
        read_map(path)


@pytest.mark.parametrize("edition", ["", "-Ex", "-Ex2", "-Ex3", "-Ex4"])
def test_every_edition_of_the_format_is_read(tmp_path: Path, edition: str) -> None:
    drawn = read(tmp_path, SQUARE.replace("2D-Map", f"2D-Map{edition}"))
    assert len(drawn.walls) == 2


@pytest.mark.parametrize("resolution", ["0", "-1", "0.0"])
def test_no_resolution_counts_as_the_usual_one(tmp_path: Path, resolution: str) -> None:
    text = SQUARE.replace("2D-Map\n", f"2D-Map\nResolution: {resolution}\n")
    assert len(read(tmp_path, text + "DATA\n").walls) == 2
    cells = read(tmp_path, f"2D-Map\nResolution: {resolution}\nDATA\n100 100\n")
    assert cells.grids[0].resolution == pytest.approx(0.02)


def test_walls_of_two_sources_are_one_map(tmp_path: Path) -> None:
    text = "2D-Map-Ex\nSources: laser sonar\nlaser_LINES\n0 0 1 0\nsonar_LINES\n0 0 0 1\n"
    assert len(read(tmp_path, text + "laser_DATA\nsonar_DATA\n").walls) == 2
