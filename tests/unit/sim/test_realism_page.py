"""docs/explanation/realism.md says what the code does: every parameter, every number."""

from dataclasses import fields
from math import degrees
from pathlib import Path

import pytest

from docs.plots import sonar_angle
from pioneer3.cli.sim import ErrorOptions
from pioneer3.maps.materials import MATERIALS, REMISSION
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.realism import MODES, OdometryErrors, RangeFinderErrors, Realism, SonarErrors

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/explanation/realism.md").read_text()
PARTS: dict[str, OdometryErrors | SonarErrors | RangeFinderErrors | Realism] = {
    "odometry.": OdometryErrors(),
    "sonar.": SonarErrors(),
    "range_finder.": RangeFinderErrors(),
    "": Realism(),
}
IN_DEGREES = {"width", "critical"}


def rows(part: str) -> dict[str, tuple[str, str]]:
    """Return default and value for "off" of each parameter in a table of the page."""
    head = f"`{part}`" if part else "parameter"
    table = PAGE.split(f"| {head} | unit |")[1].split("\n\n")[0]
    cells = [[c.strip(" `") for c in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    return {name: (default, off) for name, _, default, _, off in cells}


@pytest.mark.parametrize("part", PARTS)
def test_every_parameter_is_on_the_page_with_its_default(part: str) -> None:
    errors, told = PARTS[part], rows(part)
    nested = {"odometry", "sonar", "range_finder"}
    assert list(told) == [field.name for field in fields(errors) if field.name not in nested]
    for name, (default, _) in told.items():
        value = getattr(errors, name)
        shown = f"{degrees(value):.9g}" if name in IN_DEGREES else f"{value}".lower()
        assert shown == default, name


def test_what_is_off_is_ideal() -> None:
    ideal = Realism.ideal()
    parts = {"sonar.": ideal.sonar, "range_finder.": ideal.range_finder, "": ideal}
    for part, errors in parts.items():
        for name, (_, off) in rows(part).items():
            value = getattr(errors, name)
            shown = f"{degrees(value) if name in IN_DEGREES else value:g}"
            assert off == "false" if value is False else shown == off, name
    told = {name: off for name, (_, off) in rows("odometry.").items() if name != "mode"}
    neutral = {name: "1" if "ratio" in name or name == "scale" else "0" for name in told}
    assert told == neutral
    assert rows("odometry.")["mode"][1] == ideal.odometry.mode


def test_the_materials_are_on_the_page_with_their_remission() -> None:
    for material, remission in zip(MATERIALS, REMISSION, strict=True):
        assert f"| {material} | {remission:g} |" in PAGE


def test_the_page_names_the_modes_and_what_the_command_line_does() -> None:
    for mode in MODES:
        assert f"| `{mode}` |" in PAGE
    assert ErrorOptions().realism() == Realism()
    assert ErrorOptions(ideal=True).realism() == Realism.ideal()
    no_error = ErrorOptions(no_error=True).realism()
    assert no_error == Realism().with_odometry("none")


def test_gyro_and_compass_are_exact_unless_told_otherwise() -> None:
    equipment = Equipment()
    for name, (default, _) in rows("equipment.").items():
        assert getattr(equipment, name) == float(default) == 0


def test_the_sonar_table_is_what_the_simulator_computes() -> None:
    assert sonar_angle.table() in PAGE
    assert (ROOT / "docs/images" / sonar_angle.PICTURE.name).is_file()
