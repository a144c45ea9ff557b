"""From options to a running simulator."""

import asyncio
from pathlib import Path

import pytest

from pioneer3 import ConfigError, LinkError, PortBusyError, connect_async
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.runtime.simulation import RunningSimulation, simulator

MAP = """2D-Map
NumLines: 1
LineMinPos: 5000 -1000
LineMaxPos: 5000 1000
Cairn: RobotHome 1000 2000 90 "" ICON "home"
LINES
5000 -1000 5000 1000
"""


async def is_open(running: RunningSimulation) -> bool:
    host, port = running.url.removeprefix("tcp://").split(":")
    try:
        _, writer = await asyncio.open_connection(host, port)
    except ConnectionRefusedError:
        return False
    writer.close()
    await writer.wait_closed()
    return True


@pytest.mark.realtime
async def test_the_simulator_listens_while_it_is_entered_and_not_after() -> None:
    async with simulator(port=0) as running:
        assert await is_open(running)
    assert not await is_open(running)


@pytest.mark.realtime
async def test_a_simulator_that_is_left_at_once_closes_its_port_too() -> None:
    async with simulator(port=0) as running:
        pass
    assert not await is_open(running)


@pytest.mark.realtime
async def test_a_free_port_is_found_and_told() -> None:
    async with simulator(port=0) as one, simulator(port=0) as two:
        assert one.url != two.url
        assert one.url.startswith("tcp://127.0.0.1:")


@pytest.mark.realtime
async def test_the_robot_starts_at_the_home_of_the_map(tmp_path: Path) -> None:
    (tmp_path / "lab.map").write_text(MAP)
    async with simulator(map_name=tmp_path / "lab.map", robot="p3dx-sh", port=0) as running:
        home = running.body.robot_in_world
        assert (home.x, home.y, home.theta) == pytest.approx((1.0, 2.0, 1.5708), abs=1e-4)
        assert running.scene.robot_in_map(ORIGIN) == home
        assert running.body.model.name == "p3dx-sh"


@pytest.mark.realtime
async def test_the_scene_follows_the_true_robot() -> None:
    async with simulator(port=0) as running:
        running.body.advance(Pose2(0.5, 0.0, 0.0))
        assert running.scene.robot_in_map(ORIGIN) == running.body.robot_in_world
        assert running.body.robot_in_world != running.body.home


@pytest.mark.realtime
async def test_a_host_connects_to_the_url() -> None:
    async with simulator(robot="p3dx-sh", port=0) as running, connect_async(running.url) as robot:
        assert robot.info.identity.model == "p3dx-sh"


@pytest.mark.realtime
async def test_a_port_in_use_is_refused() -> None:
    async with simulator(port=0) as running:
        port = int(running.url.rsplit(":", 1)[1])
        with pytest.raises(PortBusyError, match=str(port)):
            async with simulator(port=port):
                pass


@pytest.mark.realtime
@pytest.mark.parametrize("port", [-1, 70000])
async def test_a_port_that_is_none_is_refused(port: int) -> None:
    with pytest.raises(LinkError, match=str(port)):
        async with simulator(port=port):
            pass


@pytest.mark.parametrize(
    "options", [{"map_name": "nowhere"}, {"robot": "r2d2"}, {"robot": "none.toml"}]
)
async def test_a_wrong_option_is_refused_before_anything_runs(options: dict[str, str]) -> None:
    with pytest.raises(ConfigError):
        async with simulator(port=0, **options):
            pass
    assert asyncio.all_tasks() == {asyncio.current_task()}
