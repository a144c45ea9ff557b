"""The map that a simulator names, over cables in memory."""

from pathlib import Path

import pytest

from pioneer3 import ConfigError, connect_async
from pioneer3.navigation import simulator
from pioneer3.navigation.simulator import known_map, map_of_simulator
from pioneer3.sim.worldfile import load_map
from tests.support import SimulatedRobot, wall_at


@pytest.mark.realtime
async def test_a_simulator_names_its_map() -> None:
    async with SimulatedRobot(load_map("lab")) as sim, connect_async(sim.open) as robot:
        assert (await map_of_simulator(robot)).name == "lab"


@pytest.mark.realtime
async def test_a_map_that_is_not_here_is_asked_for() -> None:
    async with SimulatedRobot(wall_at(2.0)) as sim, connect_async(sim.open) as robot:
        with pytest.raises(ConfigError, match=r"there is no map 'wall' here; .* --map"):
            await map_of_simulator(robot)


async def test_a_robot_is_not_asked_for_a_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulator, "is_simulator", lambda _: False)
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        with pytest.raises(ConfigError, match=r"a robot names no map: .* --map"):
            await map_of_simulator(robot)


async def test_a_simulator_that_names_no_map_is_not_waited_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        monkeypatch.setattr(type(robot), "send", lambda *_: None)
        with pytest.raises(ConfigError, match=r"this simulator names no map: .* --map"):
            await map_of_simulator(robot)


def test_maps_are_known_by_the_names_that_ship_and_by_files_of_this_folder_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    lines = "2D-Map\nLineMinPos: 0 0\nLineMaxPos: 1 1\nNumLines: 1\nLINES\n0 0 1000 1000\nDATA\n"
    (tmp_path / "here" / "hall.map").write_text(lines)
    (tmp_path / "up.map").write_text(lines)
    assert known_map("hall")[0].name == "hall"
    assert known_map("office.map")[0].name == "office"
    line_map, relief = known_map("ramps")
    assert "ramp_0" in relief.solids
    assert len(relief.heights_of(line_map)) == len(line_map.walls)
    (tmp_path / "here" / "link.map").symlink_to(tmp_path / "up.map")
    for name in ("../up", str(tmp_path / "up"), "up", "", "link", "a\0b", "é" * 130, "x" * 5000):
        with pytest.raises(ConfigError, match="there is no map"):
            known_map(name)
