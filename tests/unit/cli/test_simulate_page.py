"""The commands of docs/how-to/simulate.md are taken as they stand."""

import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from pioneer3.cli import sim as sim_module
from pioneer3.cli.main import execute
from pioneer3.sim.worldfile import parse_world

PAGE = (Path(__file__).parents[3] / "docs/how-to/simulate.md").read_text()
SHELL = "".join(re.findall(r"```sh[^\n]*\n(.*?)```", PAGE, re.DOTALL))
LINES = [line.partition("#")[0].strip() for line in SHELL.splitlines()]
SIMS = [line for line in LINES if line.startswith("pioneer3 sim") and "--like" not in line]
"""Commands that take no files of the reader's: those are in tests/e2e/test_twin.py."""
WORLDS = re.findall(r"```toml[^\n]*\n(.*?)```", PAGE, re.DOTALL)


def test_there_is_something_to_try() -> None:
    assert len(SIMS) >= 10
    assert all(line.startswith("pioneer3 ") for line in LINES if line)


@pytest.mark.parametrize("line", SIMS)
def test_every_command_is_taken(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[dict[str, Any]] = []

    async def stay(simulation: object, *, announce: bool) -> int:
        return 0

    monkeypatch.setattr(
        "pioneer3.sim.server.start.simulator", lambda **choices: seen.append(choices)
    )
    monkeypatch.setattr(sim_module, "_simulate", stay)
    assert execute(shlex.split(line)[1:]) == 0
    assert len(seen) == 1


def test_the_world_of_a_class_is_one(tmp_path: Path) -> None:
    world = parse_world(tmp_path / "class.toml", WORLDS[0])
    assert [(robot.name, robot.port) for robot in world.robots] == [("anna", 8101), ("ben", 8102)]


def test_a_part_of_a_world_is_one(tmp_path: Path) -> None:
    world = parse_world(tmp_path / "ramp.toml", f"[world]\n{WORLDS[1]}")
    assert [solid.table for solid in world.solids] == ["ramp"]
