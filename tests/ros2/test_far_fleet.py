"""A fleet far away: two Zenoh routers with TLS, and a bad link between them."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest

from pioneer3.fleet.members import Reached
from pioneer3.fleet.network import FleetNetwork
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.network import Network as Ros2Network
from tests.e2e.processes import free_port, running, until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.fleets import UP, answers_of, driving, row, write_fleet
from tests.ros2.networks import DOMAINS, Ros2
from tests.ros2.zenoh_network import Authority, Cable

pytestmark = [pytest.mark.realtime]
EXPIRY = 0.7
"""A robot whose operator is gone stands within this time [s]: a velocity lasts for 0.5 s."""
BUSY = 1.0
"""Allowance for a machine that is busy with other work [s]."""


@dataclass
class Far:
    """A robot on the other side of a bad link.

    Attributes:
        robot: Its node is at the server's router.
        link: Between the routers.
        fleet: The fleet file of a laptop, which is at a router of its own.
    """

    robot: Robot
    link: Cable
    fleet: Path


@asynccontextmanager
async def router(*words: str) -> AsyncIterator[None]:
    async with running("ros2", "router", *words) as command:
        assert "router" in await command.line()
        yield


@pytest.fixture
def link(port: int) -> Iterator[Cable]:
    cable = Cable(port)
    yield cable
    cable.close()


@pytest.fixture
def port() -> int:
    """Return the port of the server's router."""
    return free_port()


@asynccontextmanager
async def far(port: int, link: Cable, folder: Path) -> AsyncIterator[Far]:
    """Run two routers with TLS, and a robot at one of them."""
    authority = Authority(folder, "authority")
    domain, laptop = next(DOMAINS), f"tls/localhost:{free_port()}"

    def tls(name: str) -> tuple[str, ...]:
        certificate, key = authority.certificate(name)
        return ("--ca", str(authority.file), "--certificate", str(certificate), "--key", str(key))

    server = f"tls/localhost:{port}"
    network = Ros2(Ros2Network(backend=BackendName.ZENOH, domain=domain, connect=(server,)))
    to_server = f"tls/localhost:{link.port}"
    async with (
        router("--listen", server, *tls("server")),
        router("--listen", laptop, "--connect", to_server, *tls("router")),
        robot_on(network, "--namespace", "r1", *tls("robot")) as robot,
    ):
        authority.certificate("operator")
        table = FleetNetwork(
            name="far",
            backend="zenoh",
            domain=domain,
            connect=(laptop,),
            ca=authority.file.name,
            certificate="operator.crt",
            key="operator.key",
        )
        yield Far(robot, link, write_fleet(folder / "fleet.toml", (table,), row(1)))


async def test_the_fleet_is_listed_and_stopped_over_a_slow_link(
    port: int, link: Cable, tmp_path: Path
) -> None:
    async with far(port, link, tmp_path) as there:
        there.link.delay = 0.25
        words = ("--fleet", str(there.fleet), "--timeout", "10")
        _, answers = await answers_of("fleet", "list", *words)
        live = answers["r1"]["live"]
        assert live["driver"] == {"ok": True, "said": "r1/pioneer3"}, live
        assert live["age"] > there.link.delay / 2
        code, answers = await answers_of("fleet", "stop", "--emergency", *words)
        assert (code, answers["r1"]["ok"]) == (0, True), answers
        _, answers = await answers_of("fleet", "list", *words)
        assert answers["r1"]["live"]["stopped"]
        there.link.cut()
        code, answers = await answers_of("fleet", "stop", *words[:3], "4")
        assert (code, answers["r1"]["reached"]) == (3, False)


@pytest.mark.parametrize("fault", ["stalls", "is cut"])
async def test_a_robot_beyond_a_lost_link_stands_is_told_lost_and_comes_back(
    port: int, link: Cable, tmp_path: Path, fault: str
) -> None:
    async with far(port, link, tmp_path) as there, driving(there.fleet) as person:
        await person.connected(1)
        person.press(UP)
        await until(lambda: not there.robot.tap.now.is_zero)
        await asyncio.sleep(1)
        if fault == "stalls":
            there.link.flows = False
        else:
            there.link.cut()
        assert await until(lambda: there.robot.tap.now.is_zero) < EXPIRY + BUSY
        await until(lambda: person.member(1).reached is Reached.LOST)
        assert "silent" in person.member(1).why
        person.press(UP)  # nothing of it may arrive later
        await asyncio.sleep(3)
        assert there.robot.tap.now.is_zero
        stood = len(there.robot.tap.velocities)
        there.link.flows = there.link.whole = True
        await person.connected(1)
        await asyncio.sleep(1)
        assert there.robot.tap.now.is_zero
        assert moved(there.robot, stood) < 0.05
        await person.drives(there.robot)


async def test_a_link_that_comes_and_goes_lets_nothing_old_through(
    port: int, link: Cable, tmp_path: Path
) -> None:
    async with far(port, link, tmp_path) as there, driving(there.fleet) as person:
        await person.connected(1)
        for _ in range(3):
            await person.drives(there.robot)
            there.link.flows = False
            assert await until(lambda: there.robot.tap.now.is_zero) < EXPIRY + BUSY
            await asyncio.sleep(1.5)
            person.press(" ")
            stood = len(there.robot.tap.velocities)
            there.link.flows = True
            await person.connected(1)
            await until(lambda: there.robot.tap.now.is_zero)
            assert moved(there.robot, stood) < 0.05


def moved(robot: Robot, since: int) -> float:
    """Return how far commands would have moved a robot since its change of that number [m]."""
    changes = robot.tap.velocities[max(0, since - 1) :]
    return sum(abs(twist.v) * (after - at) for (at, twist), (after, _) in pairwise(changes))
