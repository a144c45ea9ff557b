"""A bridge at real sockets: hosts that are slow, rude, or all there at once."""

import asyncio
import signal
import socket
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.arcos.reports import Sip
from pioneer3.bridge import Bridge
from pioneer3.errors import PortBusyError
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.stop import stop_all
from pioneer3.sim.server.start import simulator
from pioneer3.tasks import running
from tests.e2e.plain_client import PlainClient, TurnedAwayError
from tests.e2e.processes import free_port, until
from tests.e2e.processes import running as command
from tests.support import SimulatedRobot, hold

pytestmark = pytest.mark.realtime
GO = (commands.Enable(on=True), commands.Vel(speed=0.3))

STANDS = 0.02
"""Wheels with mass end slowly [m/s]."""


async def hear_out(client: PlainClient) -> None:
    while True:
        await client.next(Sip)


@asynccontextmanager
async def listening(robot: SimulatedRobot) -> AsyncIterator[tuple[Bridge, int]]:
    bridge = Bridge(robot.open)
    async with running(bridge.run()), bridge.listening() as port:
        yield bridge, port


async def test_a_holder_that_is_reset_leaves_a_robot_that_stands() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (bridge, port):
        host = await PlainClient.connect(port)
        await host.open()
        host.say(*GO)
        await until(lambda: robot.speed > 0.1)
        linger = struct.pack("ii", 1, 0)  # closing sends a reset
        connection = host._writer.get_extra_info("socket")
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
        host.abort()
        await until(lambda: robot.speed == 0 and not robot.powered and bridge.holder is None)


async def test_a_watcher_that_reads_nothing_delays_nobody() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (bridge, port):
        host = await PlainClient.connect(port)
        await host.open()
        slow = socket.socket()
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        slow.connect(("127.0.0.1", port))
        slow.sendall(bytes.fromhex("fafb03000000fafb03010001fafb03020002fafb03010001"))
        await until(lambda: len(bridge.watchers) == 1)
        (watcher,) = bridge._relay.watchers
        for _ in range(200):  # a laser's sweeps, much faster than any
            watcher.port.send(bytes(65536))
            await asyncio.sleep(0)
        await until(lambda: not bridge.watchers)
        assert bridge.holder is not None
        await host.next(Sip)
        slow.close()
        await host.leave()


async def test_garbage_does_not_take_the_robot_and_leaves_room_for_others() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (bridge, port):
        rude = await PlainClient.connect(port)
        rude.send(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n" * 100)
        async with connect_async(f"tcp://127.0.0.1:{port}") as student:
            assert bridge.watchers == ()
            rude.send(bytes(range(256)) * 200)
            assert await hold(student, 0.2) == 0
            assert robot.speed > 0.1
        await rude.drop()


async def test_of_two_hosts_at_once_one_has_the_robot_and_the_other_follows_it() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (bridge, port):
        first, second = await asyncio.gather(PlainClient.connect(port), PlainClient.connect(port))
        await asyncio.gather(first.open(), second.open())
        await asyncio.gather(first.next(Sip), second.next(Sip))
        assert bridge.holder is not None
        assert len(bridge.watchers) == 1
        has, watches = (
            (first, second) if bridge.holder.endswith(f":{_number(first)}") else (second, first)
        )
        await has.leave()
        with pytest.raises(TurnedAwayError):
            await hear_out(watches)
        again = await PlainClient.connect(port)
        await again.open()
        assert bridge.holder is not None
        await again.leave()


async def test_a_fleet_stop_gets_in_while_another_program_drives() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (_, port):
        one = FleetRobot(
            name="p3at-1", host="p3at-1", address="127.0.0.1", node="p3at_1", bridge=port
        )
        async with connect_async(f"tcp://127.0.0.1:{port}") as student:
            driving = asyncio.ensure_future(hold(student, 0.3, seconds=6.0))
            await until(lambda: robot.speed > 0.2 and robot.powered)
            await asyncio.sleep(1.0)
            (answer,) = await stop_all(
                [one], lambda each: connect_async(f"tcp://127.0.0.1:{each.bridge}")
            )
            assert (answer.ok, answer.taken) == (True, True)
            assert abs(robot.speed) < STANDS
            await until(lambda: not robot.powered)
            await driving


async def test_a_port_in_use_is_told() -> None:
    async with SimulatedRobot() as robot, listening(robot) as (_, port):
        other = Bridge(robot.open)
        with pytest.raises(PortBusyError, match="choose another port"):
            async with other.listening(port=port):
                pass


@pytest.mark.parametrize(
    "number",
    [signal.SIGTERM, signal.SIGINT, pytest.param(signal.SIGHUP, marks=pytest.mark.thorough)],
)
async def test_each_signal_to_leave_stops_the_robot(number: signal.Signals) -> None:
    listen = free_port()
    async with (
        simulator(map_name="empty", port=0) as sim,
        command("bridge", "--port", sim.url, "--listen", str(listen)) as bridge,
    ):
        assert await bridge.line() == f"BRIDGE: {sim.url} on tcp://127.0.0.1:{listen}"
        host = await PlainClient.connect(listen)
        await host.open()
        host.say(*GO)
        while (await host.next(Sip)).left_speed_raw < 100:
            host.say(commands.Pulse())
        assert (await bridge.end(number))[0] == 128 + number
        await host.drop()
        await until(lambda: abs(sim.body.speeds[0]) < STANDS and not sim.body.drive.powered)


def _number(client: PlainClient) -> int:
    return int(client._writer.get_extra_info("sockname")[1])
