"""`pioneer3 map`: show, check, convert."""

import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from pioneer3.cli.map import _print_map, check, convert, map_app, show
from pioneer3.cli.map_drawing import CharacterCanvas
from pioneer3.errors import ConfigError
from pioneer3.maps import shipped_map
from pioneer3.maps.drawing import Layer
from pioneer3.sim.map_convert import look
from pioneer3.sim.worldfile import load_map, load_world

BAD = "2D-Map\nLINES\n1 2 3\n"


def printed(name: str, width: int, height: int) -> list[str]:
    console = Console(width=width, height=height, record=True, force_terminal=False)
    with console.capture() as capture:
        _print_map(look(name), console)
    return capture.get().splitlines()


@pytest.mark.parametrize(("width", "height"), [(80, 24), (120, 40), (40, 12), (200, 10)])
def test_a_map_fits_the_terminal(width: int, height: int) -> None:
    lines = printed("office", width, height)
    assert len(lines) < max(height, 11)
    assert max(map(len, lines)) <= width
    assert lines[0].startswith("office  20.0 x 14.0 m, 396 walls")


def test_the_drawing_names_places_and_has_a_scale() -> None:
    text = "\n".join(printed("office", 120, 40))
    for part in ("●Workshop", "■Dock", "→Home", "┤ 5 m", "2 RobotHome, 1 Dock"):
        assert part in text


def test_a_wall_is_drawn_where_it_stands(tmp_path: Path) -> None:
    path = tmp_path / "l.map"
    path.write_text("2D-Map\nLINES\n0 0 10000 0\n0 0 0 10000\n")
    rows = CharacterCanvas(look(str(path)).drawing, 40, 10).text().plain.splitlines()
    # an L: a stroke down the left, and one along the bottom
    assert [row[0] for row in rows[:-1]] == ["⡇"] * (len(rows) - 1)
    assert set(rows[-1][1:-1]) == {"⣀"}
    assert {letter for row in rows[:-1] for letter in row[1:]} == {" "}


@pytest.mark.parametrize("text", ["", "LINES\n5 5 5 5\n", "LINES\n0 0 0 9000\n"])
def test_maps_without_extent_can_be_shown(tmp_path: Path, text: str) -> None:
    path = tmp_path / "m.map"
    path.write_text(f"2D-Map\n{text}")
    assert printed(str(path), 80, 24)


def test_show_prints_to_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert show("office") == 0
    assert "Workshop" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("2D-Map\nLINES\n", 1, "warning: there is no wall"),
        (BAD, 2, ":3: error: LINES: expected numbers"),
    ],
)
def test_check_tells_and_says_how_bad(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, code: int, words: str
) -> None:
    path = tmp_path / "m.map"
    path.write_text(text)
    assert check(str(path)) == code
    assert words in capsys.readouterr().out


def test_a_fine_map_is_said_to_be_fine(capsys: pytest.CaptureFixture[str]) -> None:
    assert check("office") == 0
    assert capsys.readouterr().out == "office: all fine\n"


def test_check_speaks_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "m.map"
    path.write_text(BAD)
    assert check(str(path), json=True) == 2
    told = json.loads(capsys.readouterr().out)
    assert (told["file"], told["exit_code"]) == (str(path), 2)
    remark = told["remarks"][0]
    assert (remark["level"], remark["line"]) == ("error", 3)


def test_an_unknown_robot_is_an_error() -> None:
    with pytest.raises(ConfigError, match="no such robot model"):
        check("office", robot="p9")


def test_a_map_becomes_every_format(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    office = shipped_map("office")
    for ending in ("map", "yaml", "toml", "svg", "png"):
        assert convert("office", tmp_path / f"o.{ending}") == 0
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"o.map", "o.yaml", "o.pgm", "o.toml", "o.svg", "o.png"}
    assert f"wrote {tmp_path / 'o.pgm'}\n" in capsys.readouterr().out
    np.testing.assert_allclose(load_map(tmp_path / "o.map").walls, office.walls, atol=0.0006)
    assert load_world(tmp_path / "o.toml").map == "office"
    assert (tmp_path / "o.png").read_bytes().startswith(b"\x89PNG")
    svg = (tmp_path / "o.svg").read_text()
    assert svg.startswith("<svg")
    assert ">Workshop</text>" in svg


def test_a_converted_world_finds_its_map_again(tmp_path: Path) -> None:
    convert("office", tmp_path / "o.map")
    (tmp_path / "sub").mkdir()
    convert(str(tmp_path / "o.map"), tmp_path / "sub" / "w.toml")
    assert len(load_map(tmp_path / "sub" / "w.toml").walls) == 396


def test_what_a_format_cannot_hold_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world = tmp_path / "w.toml"
    world.write_text(
        "[world]\n[[robot]]\n[[box]]\ncenter=[3,3]\nsize=[1,1]\nmovable=true\n"
        "[[person]]\npath=[[0,0]]\n[[wall]]\npoints=[[0,0],[9,0]]\n"
    )
    convert(str(world), tmp_path / "w.map")
    assert "no place for it: 1 robots, 1 people\n" in capsys.readouterr().out
    (box,) = load_map(tmp_path / "w.map").objects
    assert (box.kind, box.solid) == ("Sim.BoxObstacle", True)
    convert(str(world), tmp_path / "w.yaml")
    assert "1 robots, 1 people, 1 movable boxes" in capsys.readouterr().out
    convert(str(world), tmp_path / "v.toml")
    assert "left out" not in capsys.readouterr().out


def test_solids_are_drawn_counted_and_left_out_of_maps_without_heights(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world = tmp_path / "w.toml"
    world.write_text(
        "[world]\n[[wall]]\npoints=[[0,0],[9,0]]\nheight=2\n"
        "[[ramp]]\ncenter=[2,3]\nsize=[2,1]\ntheta_deg=90\nheight=0.2\n"
        "[[step]]\ncenter=[5,3]\nsize=[1,1]\nheight=0.1\n"
        "[[carpet]]\ncenter=[5,6]\nsize=[1,1]\n"
        "[[table]]\ncenter=[8,6]\nsize=[1,1]\nheight=0.7\n"
    )
    drawing = look(str(world)).drawing
    assert len(drawing.lines[Layer.RAMP]) == 7
    up = drawing.lines[Layer.RAMP][4]
    assert up.tolist() == pytest.approx([2.0, 2.2, 2.0, 3.8])
    for layer in (Layer.STEP, Layer.CARPET, Layer.TABLE):
        assert len(drawing.lines[layer]) == 4
    show(str(world))
    told = capsys.readouterr().out
    for words in ("1 ramp, 1 carpet, 1 table", "ramp  ", "carpet  "):
        assert words in told
    for ending in (".map", ".yaml"):
        convert(str(world), tmp_path / f"o{ending}")
        left = capsys.readouterr().out
        assert "1 heights of walls and boxes, 1 step, 1 ramp, 1 carpet, 1 table\n" in left
    convert(str(world), tmp_path / "o.svg")
    svg = (tmp_path / "o.svg").read_text()
    assert all(f'class="{layer}"' in svg for layer in ("ramp", "step", "carpet", "table"))
    convert(str(world), tmp_path / "o.png")


def test_nothing_is_written_over_unless_told(tmp_path: Path) -> None:
    target = tmp_path / "o.map"
    convert("office", target)
    with pytest.raises(ConfigError, match=r"is there already; --force"):
        convert("office", target)
    assert convert("office", target, force=True) == 0
    with pytest.raises(ConfigError, match="is the source"):
        convert(str(target), target, force=True)


@pytest.mark.parametrize("name", ["o", "o.mp", "o.jpg", "o.\n"])
def test_an_unknown_ending_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ConfigError, match="unknown format") as caught:
        convert("office", tmp_path / name)
    assert str(caught.value).isprintable()


def test_names_in_a_picture_are_escaped(tmp_path: Path) -> None:
    path = tmp_path / "m.map"
    path.write_text('2D-Map\nCairn: Goal 0 0 0 "" ICON "<a&b>"\nLINES\n0 0 9 9\n')
    convert(str(path), tmp_path / "m.svg")
    assert "&lt;a&amp;b&gt;" in (tmp_path / "m.svg").read_text()


def test_the_command_has_three_parts(capsys: pytest.CaptureFixture[str]) -> None:
    map_app(["--help"], result_action="return_value")
    out = capsys.readouterr().out
    assert all(word in out for word in ("show", "check", "convert"))
