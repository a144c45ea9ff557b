"""From options to a running simulator."""

import asyncio
import gc
import socket
import subprocess
import sys
import warnings
from contextlib import ExitStack
from math import hypot, pi
from pathlib import Path

import pytest

from pioneer3 import (
    CommandError,
    ConfigError,
    LinkError,
    PortBusyError,
    PortNotFoundError,
    connect_async,
)
from pioneer3.arcos.commands import Open, SimCtrl, SimOperation
from pioneer3.arcos.packet import encode
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.jit import KernelCache
from pioneer3.links.hosts import machine_address, url_of
from pioneer3.links.urls import open_link, split_host
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.kernels import WORTH_COMPILING
from pioneer3.sim.realism import Realism
from pioneer3.sim.server import start
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import Box, Person, RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.web.scene import RobotScene
from tests.support import SYNCS, frame, is_at, until

BUMPERS = EquipmentOptions(bumpers=5)
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
        assert RobotScene.of(running, running.robots[0]).robot_in_map(ORIGIN) == home
        assert running.body.model.name == "p3dx-sh"


@pytest.mark.realtime
async def test_the_scene_follows_the_true_robot() -> None:
    async with simulator(port=0) as running:
        running.body.robot_in_world = running.body.home @ Pose2(0.5, 0.0, 0.0)
        assert (
            RobotScene.of(running, running.robots[0]).robot_in_map(ORIGIN)
            == running.body.robot_in_world
        )
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
    ("map_name", "robot"), [("nowhere", None), ("office", "r2d2"), ("office", "none.toml")]
)
async def test_a_wrong_option_is_refused_before_anything_runs(
    map_name: str, robot: str | None
) -> None:
    with pytest.raises(ConfigError):
        async with simulator(map_name=map_name, robot=robot, port=0):
            pass
    assert asyncio.all_tasks() == {asyncio.current_task()}


async def test_a_factory_of_nothing_is_refused_at_once() -> None:
    with pytest.raises(ConfigError, match="r2d2"):
        async with simulator(port=0, overrides=WorldOverrides(factory="r2d2")):
            pass


WORLD = """
[world]
name = "two"
seed = 5

[[wall]]
points = [[0, 0], [9, 0], [9, 9], [0, 9]]
closed = true

[[robot]]
name = "alice"
model = "p3dx-sh"
start = { x = 2, y = 2, theta_deg = 90 }
equipment = { gripper = true }

[[robot]]
name = "bob"
start = { x = 5, y = 2 }

[[box]]
name = "crate"
center = [2, 4]
size = [1, 1]
movable = true

[[person]]
name = "Ada"
path = [[7, 2], [7, 8]]
"""


@pytest.fixture
def two(tmp_path: Path) -> Path:
    path = tmp_path / "two.toml"
    path.write_text(WORLD)
    return path


@pytest.mark.realtime
async def test_a_world_file_brings_robots_boxes_and_people(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        alice, bob = running.robots
        assert (alice.name, alice.model.name) == ("alice", "p3dx-sh")
        assert (bob.name, bob.model.name) == ("bob", "p3at-sh")
        assert alice.body.robot_in_world.theta == pytest.approx(pi / 2)
        assert alice.firmware.accessories.equipment.gripper
        assert not bob.firmware.accessories.equipment.gripper
        assert [thing.name for thing in running.world.obstacles] == ["crate", "Ada"]
        assert running.world.sonar(alice.body).min() < 1.5  # the crate
        assert running.url == alice.url != bob.url
        assert running.robot("bob") is bob
        assert running.notes == []
        with pytest.raises(KeyError):
            running.robot("eve")


@pytest.mark.realtime
async def test_what_a_plane_makes_of_heights_is_a_note() -> None:
    async with simulator(map_name="ramps", port=0) as running:
        (note,) = running.notes
        assert note.startswith("on a plane 4 steps, 1 ramp and 1 carpet are flat floor")
        assert "ramp_0" in running.world.relief.solids


@pytest.mark.realtime
async def test_every_robot_has_a_host_of_its_own(two: Path) -> None:
    async with (
        simulator(map_name=two, port=0) as running,
        connect_async(running.robots[0].url) as first,
        connect_async(running.robots[1].url) as second,
    ):
        assert first.info.identity.model == "p3dx-sh"
        assert second.info.identity.model == "p3at-sh"
        assert {first.info.identity.name, second.info.identity.name} == {"MobileSim"}
        second.drive(0.2, 0.0)
        await until(lambda: running.robots[1].body.drive.linear.velocity > 0.1)
        assert running.robots[0].body.drive.linear.velocity == 0.0


@pytest.mark.realtime
async def test_the_only_robot_may_be_given_in_place_of_the_worlds(two: Path) -> None:
    async with simulator(map_name=two, robot="amigo-sh", port=0) as running:
        (robot,) = running.robots
        assert robot.model.name == robot.name == "amigo-sh"


@pytest.mark.realtime
async def test_ports_follow_each_other_around_those_that_are_given() -> None:
    first, own = await free_run(3), await free_run(1)
    robots = (RobotSpec(), RobotSpec(port=own), RobotSpec())
    async with simulator(
        map_name="empty", port=first, overrides=WorldOverrides(robots=robots)
    ) as running:
        ports = [int(robot.url.rpartition(":")[2]) for robot in running.robots]
        assert ports == [first, own, first + 1]


async def free_run(count: int) -> int:
    """Return the first of `count` free ports in a row."""
    for _ in range(50):
        with socket.create_server(("127.0.0.1", 0)) as server:
            first: int = server.getsockname()[1]
        with ExitStack() as stack:
            try:
                for number in range(first, first + count):
                    stack.enter_context(socket.create_server(("127.0.0.1", number)))
            except OSError:
                continue
        return first
    raise AssertionError("no free ports")


@pytest.mark.realtime
async def test_each_robot_may_have_a_serial_port_besides() -> None:
    async with simulator(port=0, ptys=True) as running:
        (robot,) = running.robots
        assert robot.pty is not None
        assert robot.pty.startswith("/dev/")
        async with connect_async(f"serial:{robot.pty}") as connected:
            assert connected.info.identity.model == "p3at-sh"


@pytest.mark.realtime
async def test_the_seed_repeats_random_places() -> None:
    async def places(seed: int | None) -> list[Pose2]:
        overrides = WorldOverrides(robots=(RobotSpec(start="random"),) * 3, seed=seed)
        async with simulator(port=0, overrides=overrides) as running:
            return [robot.body.robot_in_world for robot in running.robots]

    assert await places(3) == await places(3)
    assert await places(3) != await places(4)
    assert await places(None) != await places(None)


@pytest.mark.realtime
async def test_robots_are_ideal_unless_told_otherwise() -> None:
    async with simulator(port=0) as ideal, simulator(port=0, realism=Realism()) as real:
        assert ideal.world.realism == Realism.ideal()
        assert real.world.realism == Realism()


@pytest.mark.realtime
async def test_every_cable_has_the_same_faults_and_chances_of_its_own(two: Path) -> None:
    faults = LinkFaults(drop=0.5, delay=0.1, seed=3)
    async with simulator(map_name=two, port=0, faults=faults) as running:
        added = await running.add_robot(RobotSpec(model="p3dx", start=Pose2(4.0, 7.0), port=0))
        cables = [robot.port.faults for robot in (*running.robots[:2], added)]
        assert [cable.drop for cable in cables] == [0.5] * 3
        assert [cable.delay for cable in cables] == [0.1] * 3
        assert [cable.seed for cable in cables] == [3, 4, 5]


@pytest.mark.realtime
async def test_time_passes_at_the_pace_that_is_given() -> None:
    async with simulator(port=0, pace=Pacer(paused=True)) as running:
        running.pace.step(5.0)
        await until(lambda: running.world.time >= 5.0 - 1e-6)
        assert running.world.time == pytest.approx(5.0)


@pytest.mark.realtime
async def test_robots_come_and_go_while_it_runs(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        eve = await running.add_robot(RobotSpec(name="eve", model="p3dx", start=Pose2(2.0, 2.0)))
        assert running.robot("eve") is eve
        assert len(running.world.robots) == 3
        away = eve.body.robot_in_world
        assert hypot(away.x - 2.0, away.y - 2.0) > 0.5  # alice stands there
        async with connect_async(eve.url) as robot:
            assert robot.info.identity.model == "p3dx"
        await running.remove_robot(eve)
        assert len(running.robots) == len(running.world.robots) == 2
        with pytest.raises(PortNotFoundError):
            async with connect_async(eve.url):
                pass


@pytest.mark.realtime
async def test_a_robot_that_is_added_gets_a_name_of_its_own(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        added = await running.add_robot(RobotSpec(name="bob", start="random"))
        assert added.name == "bob-2"


@pytest.mark.realtime
async def test_a_robot_whose_port_is_taken_leaves_no_trace(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        taken = int(running.url.rpartition(":")[2])
        with pytest.raises(PortBusyError):
            await running.add_robot(RobotSpec(start="random", port=taken))
        assert len(running.robots) == len(running.world.robots) == 2


@pytest.mark.realtime
async def test_boxes_and_people_come_move_and_go(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        alice = running.robots[0].body
        crate = next(thing for thing in running.world.obstacles if thing.name == "crate")
        running.remove(crate)
        assert running.world.sonar(alice).min() > 1.5
        box = running.add_box(Box(pose=Pose2(8.0, 8.0), size=(1.0, 1.0)))
        assert running.world.sonar(alice).min() > 1.5
        running.move(box, Pose2(2.0, 4.0))
        assert running.world.sonar(alice).min() < 1.5
        person = running.add_person(Person(path=((3.0, 7.0),), name="Ben"))
        assert running.world.obstacles[-1] is person
        running.move(person, Pose2(4.0, 7.0))
        assert (person.pose.x, person.pose.y) == (4.0, 7.0)


@pytest.mark.realtime
async def test_robots_are_moved_to_free_places_only(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        alice, bob = running.robots
        running.move(alice, Pose2(4.0, 6.0, 1.0))
        assert is_at(alice.body.robot_in_world, Pose2(4.0, 6.0, 1.0))
        assert is_at(alice.body.robot_in_odom, ORIGIN)
        for taken in (Pose2(0.0, 5.0), bob.body.robot_in_world, Pose2(2.0, 4.0)):
            with pytest.raises(CommandError, match="alice: something stands at"):
                running.move(alice, taken)
        assert alice.body.robot_in_world == Pose2(4.0, 6.0, 1.0)


@pytest.mark.realtime
async def test_a_factory_gives_every_host_a_robot_while_it_stays() -> None:
    overrides = WorldOverrides(factory="p3dx", equipment=EquipmentOptions(compass=True))
    async with simulator(port=0, overrides=overrides) as running:
        assert running.robots == []
        assert running.url == running.factory_url
        async with connect_async(running.url) as one, connect_async(running.url) as two:
            assert one.info.identity.model == two.info.identity.model == "p3dx"
            first, second = running.robots
            assert first.firmware.accessories.compass is not None
            assert running.world.is_free(first.body, first.body.robot_in_world)
            two.drive(0.2, 0.0)
            await until(lambda: second.body.drive.linear.velocity > 0.1)
            assert first.body.drive.linear.velocity == 0.0
        await until(lambda: not running.robots)
        assert running.world.robots == ()


@pytest.mark.realtime
async def test_a_factory_that_closes_parts_from_its_hosts() -> None:
    async with simulator(port=0, overrides=WorldOverrides(factory="p3dx")) as running:
        host, port = running.url.removeprefix("tcp://").split(":")
        reader, writer = await asyncio.open_connection(host, port)
        await until(lambda: running.robots)
    async with asyncio.timeout(10):
        assert await reader.read() == b""
    writer.close()
    await writer.wait_closed()
    assert asyncio.all_tasks() == {asyncio.current_task()}


@pytest.mark.realtime
async def test_a_factory_without_room_turns_the_host_away(tmp_path: Path) -> None:
    text = "[world]\n[[wall]]\npoints = [[0, 0], [1.5, 0], [1.5, 1.5], [0, 1.5]]\nclosed = true\n"
    (tmp_path / "cell.toml").write_text(text + "[[home]]\nx = 0.75\ny = 0.75\n")
    overrides = WorldOverrides(factory="p3dx")
    async with simulator(map_name=tmp_path / "cell.toml", port=0, overrides=overrides) as running:
        host, port = running.url.removeprefix("tcp://").split(":")
        _, first = await asyncio.open_connection(host, port)
        await until(lambda: running.robots)
        reader, second = await asyncio.open_connection(host, port)
        async with asyncio.timeout(10):
            assert await reader.read() == b""
        for writer in (first, second):
            writer.close()
            await writer.wait_closed()


@pytest.mark.realtime
async def test_all_hosts_hear_of_another_map(two: Path) -> None:
    async with simulator(map_name=two, port=0) as running:
        links = [await open_link(robot.url) for robot in running.robots]
        for link in links:
            for sync in SYNCS:
                await link.write(encode(bytes([sync])))
            await link.write(frame(Open()))
        await until(lambda: all(robot.port.is_open for robot in running.robots))
        await links[0].write(frame(SimCtrl(SimOperation.LOAD_MAP, "office")))
        async with asyncio.timeout(10):
            for link in links:
                heard = b""
                while b"office" not in heard:
                    heard += await link.read()
                await link.close()
        assert RobotScene.of(running, running.robots[0]).map is running.world.map
        assert running.world.map.name == "office"


def test_nothing_compiles_before_it_listens() -> None:
    code = "import sys, pioneer3.sim.server.start; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@pytest.mark.parametrize(
    ("host", "url"),
    [("127.0.0.1", "tcp://127.0.0.1:8101"), ("::1", "tcp://[::1]:8101"), ("lab", "tcp://lab:8101")],
)
def test_addresses_become_urls(host: str, url: str) -> None:
    assert url_of(host, 8101) == url
    assert split_host(url) == (host, 8101)


def test_who_listens_everywhere_is_reached_at_the_machines_address() -> None:
    assert url_of("0.0.0.0", 8101) == f"tcp://{machine_address()}:8101"
    assert machine_address() not in {"", "0.0.0.0"}


@pytest.mark.realtime
async def test_fitted_bumpers_are_told_to_the_host_and_feel() -> None:
    overrides = WorldOverrides(robots=(RobotSpec(model="p3dx-sh"),), equipment=BUMPERS)
    async with simulator(map_name="empty", port=0, overrides=overrides) as running:
        added = await running.add_robot(RobotSpec(model="p3dx-sh", port=0, equipment=BUMPERS))
        for robot in (running.robots[0], added):
            async with connect_async(robot.url) as driver:
                assert driver.info.config is not None
                assert driver.info.config.front_bumpers == driver.info.config.rear_bumpers == 5
                assert driver.snapshot is not None
                assert driver.snapshot.bumpers.front == (False,) * 5


@pytest.mark.realtime
async def test_a_start_that_is_cut_short_leaves_nothing_behind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("numba")
    loading = asyncio.Event()

    async def load(_: object) -> None:
        loading.set()
        await asyncio.sleep(10)

    monkeypatch.setattr(start, "_load_kernels", load)
    monkeypatch.setattr(KernelCache, "is_complete", property(lambda _: True))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        robots = WorldOverrides(robots=(RobotSpec(model="p3dx-sh"),) * WORTH_COMPILING)
        starting = asyncio.ensure_future(simulator(port=None, overrides=robots).__aenter__())
        await loading.wait()
        starting.cancel()
        await asyncio.gather(starting, return_exceptions=True)
        gc.collect()
    assert not told
