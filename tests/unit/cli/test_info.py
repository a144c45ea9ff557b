"""`pioneer3 info`: tables for people, JSON for programs."""

from dataclasses import replace
from io import StringIO

import pytest
from msgspec import structs
from rich.console import Console

from pioneer3.arcos.reports import Config
from pioneer3.cli.diagnosis import info
from pioneer3.cli.options import LinkOptions
from pioneer3.cli.tables import robot_tables
from pioneer3.errors import PortNotFoundError
from pioneer3.models import load_model
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity

MODEL = load_model("p3at-sh")
CONFIG = Config(family="Pioneer", model="p3at-sh", serial_number="42", speed_top_mm_s=1500)
ROBOT = RobotInfo(
    identity=Identity(name="Bender [red]", family="Pioneer", model="p3at-sh"),
    model=MODEL,
    limits=limits_for(MODEL, None),
    config=CONFIG,
    url="serial:/dev/ttyUSB0",
    speed=38400,
)


def shown(robot: RobotInfo) -> str:
    """Return the tables as they look on 80 columns."""
    console = Console(file=StringIO(), width=80, highlight=False)
    for table in robot_tables(robot, None):
        console.print(table)
    return console.file.getvalue()  # type: ignore[attr-defined, no-any-return]


def test_robot_and_simulator_are_told_apart_in_capitals() -> None:
    simulated = replace(ROBOT, config=structs.replace(CONFIG, serial_number="SIM"))
    assert " ROBOT " in shown(ROBOT).splitlines()[0]
    assert " SIMULATOR " in shown(simulated).splitlines()[0]


def test_the_names_of_robots_are_no_markup() -> None:
    assert "Bender [red]" in shown(ROBOT)


def test_nothing_goes_to_stdout_when_there_is_no_robot(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(PortNotFoundError):
        info(link=LinkOptions(port="/dev/no-such-port"), json=True)
    assert capsys.readouterr().out == ""
