"""The name that a simulated robot tells programs: with a laser of its own it is no MobileSim."""

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.arcos.reports import Config, SyncIdentity
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.robot.supervisor import is_simulator
from pioneer3.sim.body import Body
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.simulation import Simulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.tasks import running
from tests.unit.sim.bench import SYNCS, Bench


def bench_of(own_name: str = "") -> Bench:
    """Return a bench with a robot that has this name among people."""
    bench = Bench()
    bench.firmware = Firmware(bench.world, bench.body, own_name=own_name)
    return bench


def told(bench: Bench) -> tuple[str | None, ...]:
    """Open a session; return the names in the answers to SYNC2 and CONFIG, and the serial number.

    The session is left open.
    """
    bench.firmware.receive(SYNCS, bench.now)
    (sync,) = [report for report in bench.hear() if isinstance(report, SyncIdentity)]
    bench.say(commands.Open())
    config = config_of(bench)
    return sync.name, config.name, config.serial_number


def config_of(bench: Bench) -> Config:
    bench.say(commands.RequestConfig())
    (config,) = [report for report in bench.hear() if isinstance(report, Config)]
    return config


def test_without_a_laser_it_is_known_as_a_simulator() -> None:
    assert told(bench_of("bob")) == ("MobileSim", "MobileSim", "SIM")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("bob", "bob"),
        ("", load_model("p3at-sh").name),
        ("Jürgen", "Jürgen"),
        ("机器人 1", "??? 1"),
        ("a\0b", "a?b"),
        (100 * "x", 40 * "x"),
    ],
)
def test_with_a_laser_it_tells_its_own_name(name: str, expected: str) -> None:
    bench = bench_of(name)
    bench.firmware.use_own_name()
    assert told(bench) == (expected, expected, "SIMULATED")


def test_a_robot_that_is_named_as_the_simulator_stays_one() -> None:
    bench = bench_of("mobilesim")
    bench.firmware.use_own_name()
    assert told(bench) == ("mobilesim", "mobilesim", "SIM")


def test_a_laser_that_comes_later_changes_the_name_in_the_next_session() -> None:
    bench = bench_of("bob")
    told(bench)
    bench.firmware.use_own_name()
    config = config_of(bench)
    assert (config.name, config.serial_number) == ("MobileSim", "SIM")
    bench.say(commands.Close())
    bench.hear()
    assert told(bench) == ("bob", "bob", "SIMULATED")


@pytest.mark.realtime
async def test_robots_of_a_simulation_with_and_without_a_laser() -> None:
    robots = tuple(
        RobotSpec(
            model="p3dx-sh", name=name, start=Pose2(x, 0.0), equipment=EquipmentOptions(laser=laser)
        )
        for x, (name, laser) in enumerate([("anna", "utm-30lx"), ("ben", None)])
    )
    overrides = WorldOverrides(robots=robots)
    async with simulator(map_name="empty", port=0, overrides=overrides) as here:
        spec = RobotSpec(model="p3dx-sh", equipment=EquipmentOptions(laser="lms-111"))
        added = await here.add_robot(spec)
        names = []
        for url in (*(robot.url for robot in here.robots[:2]), added.url):
            async with connect_async(url) as driver:
                names.append(driver.info.identity.name)
                assert is_simulator(driver.info)
        assert names == ["anna", "MobileSim", "p3dx-sh"]


@pytest.mark.realtime
async def test_a_laser_fitted_during_a_session_changes_nothing_for_its_host() -> None:
    bench = bench_of("bob")
    simulation = Simulation(bench.world, [bench.firmware])
    await simulation.listen(0)
    async with running(simulation.run()):
        ((host, port),) = simulation.addresses
        async with connect_async(f"tcp://{host}:{port}") as driver:
            await simulation.add_laser(bench.firmware, "utm-30lx")
            assert bench.firmware.identity.name == driver.info.identity.name == "MobileSim"
        async with connect_async(f"tcp://{host}:{port}") as driver:
            assert driver.info.identity.name == "bob"


def test_the_own_name_is_that_of_the_model_where_people_give_none() -> None:
    body = Body(load_model("p3dx-sh"), Pose2())
    firmware = Firmware(Bench().world, body)
    firmware.use_own_name()
    assert firmware.identity.name == "p3dx-sh"
