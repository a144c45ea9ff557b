"""What breaks the old emulator (facts.md 9) does not break `pioneer3 sim`, started as people do."""

import asyncio
import signal
import subprocess
from collections.abc import Iterator
from math import radians
from pathlib import Path
from random import Random

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import SimLaserExtended, Sip, SipFlag
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World
from pioneer3.tasks import running
from tests.e2e.plain_client import PATIENCE, PlainClient, TurnedAwayError, session
from tests.e2e.processes import environment, words_of

ON = commands.Enable(on=True)
CYCLE, TICK = 0.1, 0.02
LASER_ON = [
    encode(bytes([36, 0x1B, 90, 0])),
    encode(bytes([37, 0x3B, 90, 0])),
    encode(bytes([38, 0x3B, 100, 0])),
    encode(bytes([35, 0x3B, 2, 0])),
]
"""As ARIA says it: from -90 to 90 degrees in steps of 1, extended packets (2.3)."""


class Process:
    """`pioneer3 sim` on a free port, on a machine without a screen."""

    def __init__(self, *options: str) -> None:
        screenless = {k: v for k, v in environment().items() if "DISPLAY" not in k}
        self.process = subprocess.Popen(
            words_of("sim", "-p", "0", *options),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=screenless,
            text=True,
        )
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline().rstrip("\n")
        self.port = int(self.said.rpartition(":")[2])

    def end(self) -> tuple[int, str]:
        """Send SIGTERM; return the exit code and what went wrong."""
        self.process.send_signal(signal.SIGTERM)
        _, stderr = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, stderr


ENDED = (128 + signal.SIGTERM, "")
"""Told to, and without a word."""


@pytest.fixture(scope="module")
def p3at() -> Iterator[Process]:
    process = Process("-r", "p3at")
    yield process
    assert process.end() == ENDED


@pytest.mark.realtime
async def test_a_robot_needs_no_name(p3at: Process) -> None:
    assert "(p3at)" in p3at.said
    client = await PlainClient.connect(p3at.port)
    identity = await client.open()
    assert (identity.name, identity.family, identity.model) == ("MobileSim", "Pioneer", "p3at")
    await client.leave()


@pytest.mark.realtime
async def test_the_second_and_the_hundredth_session_are_like_the_first(p3at: Process) -> None:
    for _ in range(100):
        async with session(p3at.port) as client:
            sip = await client.next(Sip)
            assert (sip.x_raw, sip.y_raw, sip.heading_raw) == (0, 0, 0)
            assert SipFlag.MOTORS_ENABLED not in sip.flags
            assert len(sip.sonar) < 16  # they fire in turn
    async with session(p3at.port) as client:
        told = set[int]()
        while len(told) < 16:
            told |= {reading.number for reading in (await client.next(Sip)).sonar}


@pytest.mark.realtime
async def test_motors_of_a_second_session_can_be_switched_on(p3at: Process) -> None:
    # 9.1: every disconnect disables them there, and only there is a first session different
    for _ in range(2):
        async with session(p3at.port) as client:
            client.say(ON, commands.RVel(radians(30)))
            while SipFlag.MOTORS_ENABLED not in (await client.next(Sip)).flags:
                pass
            while (await client.next(Sip)).turn_rate_decidegrees != 300:
                pass


@pytest.mark.realtime
async def test_a_second_client_gets_the_laser_after_the_first_one_had_it(p3at: Process) -> None:
    for _ in range(2):
        async with session(p3at.port) as client:
            await client.next(Sip)
            client.send(b"".join(LASER_ON))
            readings = 0
            while readings < 2 * 181:
                packet = await client.next(SimLaserExtended)
                assert (packet.total, packet.first) == (181, readings % 181)
                readings += len(packet.readings)


@pytest.mark.realtime
async def test_an_empty_packet_does_no_harm(p3at: Process) -> None:
    random = Random(0)
    async with session(p3at.port) as client:
        for _ in range(20):
            client.send(b"\xfa\xfb\x00" + random.randbytes(random.randrange(20)))
            client.say(*[commands.Pulse()] * 50)  # what looked like a long packet has ended now
            client.say(commands.RequestConfig())
            await client.next(reports.Config)
    async with session(p3at.port) as client:
        await client.next(Sip)


@pytest.mark.realtime
async def test_of_a_hundred_clients_at_once_one_is_served_and_the_rest_are_told(
    p3at: Process,
) -> None:
    clients = await asyncio.gather(*(PlainClient.connect(p3at.port) for _ in range(100)))
    answers = await asyncio.gather(*(client.open() for client in clients), return_exceptions=True)
    served = [
        client
        for client, answer in zip(clients, answers, strict=True)
        if isinstance(answer, reports.SyncIdentity)
    ]
    assert len(served) == 1
    assert sum(isinstance(answer, TurnedAwayError) for answer in answers) == 99
    for _ in range(5):
        await served[0].next(Sip)
    await served[0].leave()
    await asyncio.gather(*(client.drop() for client in clients if client is not served[0]))
    async with session(p3at.port) as client:
        await client.next(Sip)


@pytest.mark.realtime
async def test_a_hundred_robots_serve_a_hundred_clients_at_once() -> None:
    bodies = [Body(load_model("p3dx"), Pose2(2.0 * n, 0.0, 0.0)) for n in range(100)]
    world = World(None, bodies)
    simulation = Simulation(world, [Firmware(world, body) for body in bodies])
    await simulation.listen(0)
    async with running(simulation.run()):
        ports = [port for _, port in simulation.addresses]
        clients = await asyncio.gather(*(PlainClient.connect(port) for port in ports))
        await asyncio.gather(*(client.open() for client in clients))
        for client in clients:
            client.say(ON, commands.Vel(0.2))
        await asyncio.gather(*(driven(client, 0.1) for client in clients))
        await asyncio.gather(*(client.leave() for client in clients))


async def driven(client: PlainClient, distance: float) -> None:
    """Wait until a p3dx has gone `distance` [m]."""
    while (await client.next(Sip)).x_raw * 0.485e-3 < distance:
        client.say(commands.Pulse())


PARAMETERS = """\
;SKIP leading comments, as ARIA's own files have
Section General settings
Class Pioneer                 ; general type of robot
Subclass labbot
RobotRadius 250.00000         ; radius in mm
RobotWidth 425.00000
RobotLength 511.00000
MaxVelocity 2200
MaxRVelocity 500
Section Conversion factors
AngleConvFactor 0.00153
DistConvFactor 0.50000
VelConvFactor 1.00000
RangeConvFactor 1.00000
DiffConvFactor 0.00560
Vel2Divisor 20.00000
Section Sonar parameters
SonarNum 2
SonarUnit 0 166 27 10
SonarUnit 1 166 -27 -10
"""


@pytest.mark.realtime
async def test_an_aria_parameter_file_is_a_model(tmp_path: Path) -> None:
    path = tmp_path / "labbot.p"
    path.write_text(PARAMETERS)
    process = Process("-r", str(path))
    try:
        client = await PlainClient.connect(process.port)
        assert (await client.open()).model == "labbot"
        client.say(ON, commands.Move(0.2))
        while len((sip := await client.next(Sip)).sonar) != 2 or sip.x_raw < 390:
            client.say(commands.Pulse())
        await client.leave()
    finally:
        process.end()


@pytest.mark.realtime
async def test_sigterm_ends_it_while_a_robot_drives() -> None:
    process = Process()
    client = await PlainClient.connect(process.port)
    await client.open()
    client.say(ON, commands.RVel(radians(50)))
    while not (await client.next(Sip)).turn_rate_decidegrees:
        pass
    process.process.send_signal(signal.SIGTERM)
    with pytest.raises(TurnedAwayError):
        await client.next(reports.SyncEcho)  # never comes
    stderr = (await asyncio.to_thread(process.process.communicate, timeout=PATIENCE))[1]
    assert (process.process.returncode, stderr) == ENDED
    with pytest.raises(OSError, match=r"refused|failed"):
        await PlainClient.connect(process.port)
    await client.drop()
