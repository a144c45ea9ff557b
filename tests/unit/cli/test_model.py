"""`pioneer3 model`: show, export."""

import json
from pathlib import Path
from typing import get_args
from xml.etree import ElementTree as ET

import pytest

from pioneer3.cli.main import Exit, execute
from pioneer3.cli.model import Format
from pioneer3.models import load_model, model_names

ROOTS = {"urdf": "robot", "sdf": "sdf", "mjcf": "mujoco"}


def test_show_prints_numbers_with_units_and_sources(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    assert execute(["model", "show", "p3at-sh"]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["track", "0.394", "m", "amr-ros-config"] in lines
    (mass,) = [line for line in lines if line[:1] == ["body_mass"]]
    assert mass[1:3] == ["12", "kg"]
    assert "Webots;" in mass
    assert not [line for line in lines if line[:1] == ["caster_mass"]]


@pytest.mark.parametrize("name", model_names())
def test_every_number_has_a_source(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["model", "show", name, "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert len(numbers) > 25
    assert all(number["source"] and number["value"] for number in numbers)


def test_show_says_when_parameters_are_from_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "p3at-sh-mine.toml"
    file.write_text('like = "p3at"\n', "utf-8")
    monkeypatch.chdir(tmp_path)
    assert execute(["model", "show", file.name, "--json"]) == 0
    sources = {each["name"]: each["source"] for each in json.loads(capsys.readouterr().out)}
    assert sources["width"] == "the robot's parameter file"


@pytest.mark.parametrize("form", get_args(Format))
def test_export_writes_to_the_terminal_or_to_a_file(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["model", "export", "p3dx-sh", "--format", form]) == 0
    text = capsys.readouterr().out
    file = tmp_path / "robot"
    assert execute(["model", "export", "p3dx-sh", "--format", form, "-o", str(file)]) == 0
    assert capsys.readouterr().out == f"wrote {file}\n"
    assert file.read_text("utf-8") == text
    if form in ROOTS:
        assert ET.fromstring(text).tag == ROOTS[form]


def test_a_file_is_only_written_over_when_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text("mine")
    command = ["model", "export", "p3at", "--output", str(file)]
    assert execute(command) == Exit.USAGE
    assert "is there already; --force writes over it" in capsys.readouterr().err
    assert file.read_text() == "mine"
    assert execute([*command, "--force"]) == 0
    assert ET.parse(file).getroot().get("name") == load_model("p3at").name
    assert execute(["model", "export", "p3at", "-o", str(tmp_path / "no" / "x")]) == Exit.USAGE
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["show", "export"])
def test_a_wrong_name_gets_the_nearest_one(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["model", command, "p3att-sh"]) == Exit.USAGE
    (line,) = capsys.readouterr().err.splitlines()
    assert "did you mean p3at-sh?" in line
