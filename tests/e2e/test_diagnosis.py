"""The diagnosis over a faulty cable, in virtual time."""

import asyncio
from dataclasses import dataclass, field
from random import Random

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.doctor.diagnose import diagnose, examine
from pioneer3.doctor.facts import Finding, Level, LinkFacts
from pioneer3.doctor.probe_session import QUICK, ProbeSession
from pioneer3.doctor.recognition import DeviceKind
from pioneer3.lasers.client import Patience, ScanSettings
from pioneer3.lasers.lms2xx.telegram import encode as telegram_of
from pioneer3.lasers.recognition import LMS_QUESTION, QUESTION
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.lasers.search import ProtocolSearch
from tests.faults import Noise, bytewise
from tests.support import SimulatedRobot, corrupted, decoded

URL = "memory:robot"
SPEEDS = (9600, 19200, 38400, 57600, 115200)
LASER_SPEEDS = (*SPEEDS, 500000)
HARMLESS = (
    commands.Stop,
    commands.Pulse,
    commands.Open,
    commands.Close,
    commands.Sonar,
    commands.RequestConfig,
)


async def examined(robot: SimulatedRobot, seconds: float = 3.0) -> dict[str, Finding]:
    """Return the findings about `robot` by their check."""
    facts = await examine(await robot.open(), seconds, LinkFacts(url=URL))
    return {finding.check: finding for finding in diagnose(facts)}


async def test_a_healthy_robot_is_found_healthy_and_a_simulator() -> None:
    async with SimulatedRobot() as robot:
        findings = await examined(robot)
    assert {finding.level for finding in findings.values()} == {Level.OK}
    assert findings["answer"].found.startswith("SIMULATOR MobileSim, Pioneer 3-AT")
    assert findings["sonar"].found == "16 transducers"


async def test_nothing_but_harmless_commands_is_sent_and_the_motors_stay_off() -> None:
    async with SimulatedRobot() as robot:
        await examined(robot)
        await asyncio.sleep(0.1)  # the farewell travels
        sent = decoded(robot.wires[0].data)
        assert not robot.powered
        assert not robot.firmware.device.is_open
    others = [command for command in sent if not isinstance(command, HARMLESS)]
    assert set(others) == {commands.Enable(on=False)}


async def test_a_robot_left_streaming_is_found_and_freed() -> None:
    async with SimulatedRobot() as robot:
        before = ProbeSession(await robot.open(), QUICK)
        assert await before.handshake()
        findings = await examined(robot)  # the first host is gone without a word
    assert findings["session"].level is Level.WARN
    assert findings["reports"].level is Level.OK


async def test_a_robot_left_at_another_speed_is_found_there() -> None:
    async with SimulatedRobot(speeds=SPEEDS) as robot:
        robot.robot_speed = 38400
        findings = await examined(robot)
    assert findings["speed"].level is Level.WARN
    assert "38400" in findings["speed"].found


async def test_noise_is_counted_and_the_session_survives_it() -> None:
    async with SimulatedRobot() as robot:
        link = await robot.open()
        noisy = Noise(Random(1), corrupt=0.003)
        session = ProbeSession(link)
        assert await session.handshake()
        robot.to_host = noisy
        await session.listen(5.0)
        assert session.reader.bad_checksums > 3
        assert 30 < len(session.sips) < 50
        await session.close()


async def test_a_noisy_cable_fails_the_checksums() -> None:
    async with SimulatedRobot(to_host=Noise(Random(2), corrupt=0.004)) as robot:
        findings = await examined(robot)
    assert findings["checksums"].level is Level.FAIL


def with_spoilt_config(data: bytes) -> bytes:
    """Return the frames in `data`, the checksum of CONFIG always wrong."""
    frames = [encode(payload) for payload in PacketReader().feed(data)]
    return b"".join(
        corrupted(frame) if frame[3] == reports.Config.ID else frame for frame in frames
    )


async def test_a_config_that_is_always_spoilt_is_not_held_against_the_cable() -> None:
    async with SimulatedRobot() as robot:
        robot.edit = with_spoilt_config
        findings = await examined(robot)
    assert findings["config"].level is Level.WARN
    assert "wrong checksum" in findings["config"].found
    assert findings["checksums"].level is Level.OK


async def test_single_bytes_are_no_worse_than_whole_packets() -> None:
    async with SimulatedRobot(to_host=bytewise) as robot:
        findings = await examined(robot)
    assert {finding.level for finding in findings.values()} == {Level.OK}


async def test_stop_button_and_empty_battery_are_found() -> None:
    async with SimulatedRobot() as robot:
        robot.body.stop_button = True
        robot.body.battery.fixed = 11.2
        findings = await examined(robot)
    assert findings["stop button"].level is Level.FAIL
    assert findings["battery"].level is Level.WARN


async def test_a_robot_unplugged_while_it_talks_is_a_session_that_broke_off() -> None:
    async with SimulatedRobot() as robot:
        session = ProbeSession(await robot.open())
        assert await session.handshake()
        await robot.unplug()
        await session.listen(1.0)
        assert session.closed
        await session.close()


async def test_a_robot_that_falls_silent_is_a_failure_of_the_reports() -> None:
    async with SimulatedRobot() as robot:
        link = await robot.open()
        session = ProbeSession(link)
        assert await session.handshake()
        robot.silent = True
        await session.listen(5.0)
        assert session.failure == "the robot has said nothing for 2 s"
        await session.close()


@dataclass
class Device:
    """Something that is no robot: answers each write, and remembers it with the speed.

    Attributes:
        speeds: Of the link.
        answers: What comes back to a write that contains the key, at which speed.
        greeting: Said at once.
        echo: Whether everything comes back.
    """

    speeds: tuple[int, ...] = ()
    answers: dict[tuple[int | None, bytes], bytes] = field(default_factory=dict)
    greeting: bytes = b""
    echo: bool = False
    written: list[tuple[int | None, bytes]] = field(default_factory=list)

    def link(self) -> MemoryLink:
        """Return the host's end of a cable to it."""
        ours, theirs = null_modem(speeds=self.speeds)

        def answer(data: bytes) -> tuple[bytes, ...]:
            theirs.speed = ours.speed
            self.written.append((ours.speed, data))
            back = data if self.echo else b""
            for (speed, question), words in self.answers.items():
                back += words if speed == ours.speed and question in data else b""
            if back:
                theirs.peer = ours
                theirs._deliver(back)
            return ()

        ours.fault = answer
        if self.greeting:
            theirs._deliver(self.greeting)
        return ours


async def facts_about(device: Device) -> LinkFacts:
    """Return the facts that are found."""
    return await examine(device.link(), 1.0, LinkFacts(url=URL))


@pytest.mark.parametrize("speed", [19200, 38400, 57600, 115200])
async def test_a_hokuyo_answers_the_question_at_its_speed(speed: int) -> None:
    version = b"VV\n00P\nVEND:Hokuyo;x\nPROD:URG-04LX;x\n\n"
    laser = Device(speeds=SPEEDS, answers={(speed, b"VV\n"): version})
    facts = await facts_about(laser)
    assert facts.other_device is not None
    assert (facts.other_device.kind, facts.other_device.name) == (
        DeviceKind.LASER,
        "Hokuyo, URG-04LX",
    )


@pytest.mark.parametrize("speed", [9600, 19200, 38400, 500000])
async def test_a_sick_answers_the_question_at_its_speed(speed: int) -> None:
    answer = b"\x06" + telegram_of(0xBA, b"LMS200;301061;V02.30 \x10", address=0x80)
    laser = Device(speeds=LASER_SPEEDS, answers={(speed, LMS_QUESTION): answer})
    facts = await facts_about(laser)
    assert facts.other_device is not None
    assert (facts.other_device.kind, facts.other_device.name) == (
        DeviceKind.LASER,
        "SICK LMS200-301061",
    )


def test_a_laser_that_repeats_what_was_meant_for_a_robot_is_not_taken_for_one() -> None:
    found: list[LaserProtocol] = []
    search = ProtocolSearch(0.0, (), ScanSettings(), Patience(), found=found.append)
    assert search.receive(encode(b"\x00") + encode(b"\x1d"), 0.1) == []
    search.receive(b"\n0E\n\nVV\n00P\n", 0.2)
    assert found == [LaserProtocol.SCIP]


async def test_a_laser_in_the_network_answers_the_question() -> None:
    answer = b"\x02sRA DeviceIdent 6 LMS111 10 V1.36-21.10.2010\x03"
    facts = await facts_about(Device(answers={(None, b"sRN DeviceIdent"): answer}))
    assert facts.other_device is not None
    assert (facts.other_device.kind, facts.other_device.name) == (DeviceKind.LASER, "SICK LMS111")


async def test_a_silent_device_hears_the_handshake_and_one_question() -> None:
    device = Device(speeds=LASER_SPEEDS)
    facts = await facts_about(device)
    assert facts.other_device is None
    questions = [(s, data) for s, data in device.written if not data.startswith(b"\xfa\xfb")]
    assert {speed for speed, _ in questions} == set(LASER_SPEEDS)
    assert {data for _, data in questions} == {QUESTION}


async def test_a_streaming_sick_is_recognised_without_a_question() -> None:
    scan = telegram_of(0xB0, bytes.fromhex("0240 6400 6500 10"), address=0x80)
    facts = await facts_about(Device(greeting=scan))
    assert facts.other_device is not None
    assert facts.other_device.name == "SICK LMS 2xx"


async def test_a_loopback_plug_is_recognised() -> None:
    facts = await facts_about(Device(echo=True))
    assert facts.other_device is not None
    assert facts.other_device.kind is DeviceKind.ECHO


async def test_a_banner_is_quoted() -> None:
    facts = await facts_about(Device(greeting=b"login: "))
    assert facts.other_device is not None
    assert facts.other_device.kind is DeviceKind.TEXT


async def test_the_last_words_to_a_stranger_are_a_stop_and_a_good_bye() -> None:
    device = Device()
    await facts_about(device)
    farewell = (
        commands.Stop(),
        commands.Enable(on=False),
        commands.Sonar(on=False),
        commands.Close(),
    )
    assert device.written[-1][1] == b"".join(
        encode(commands.to_payload(command)) for command in farewell
    )
