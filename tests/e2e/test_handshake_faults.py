"""The driver against the firmware, over a cable that spoils the handshake. Virtual time."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.host_events import Event
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import from_payload
from pioneer3.errors import LinkError, NoRobotError
from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.links.memory import MemoryLink, clean
from pioneer3.links.serial import SPEEDS, remembered_speed
from pioneer3.models import load_model
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.session import Session
from tests.faults import Noise, bytewise
from tests.support import (
    TICK,
    First,
    SimulatedRobot,
    corrupted,
    doubled,
    frame,
    hold,
    is_at,
    lost,
    until,
)

SYNCS = [bytes.fromhex(sync) for sync in ("fafb03000000", "fafb03010001", "fafb03020002")]
SYNC_NAMES = ["SYNC0", "SYNC1", "SYNC2"]
STOP = bytes.fromhex("fafb031d001d")
OPEN = frame(commands.Open())
CONFIG = frame(commands.RequestConfig())
CLOSE = frame(commands.Close())
LISTEN = 0.2
ONE_CYCLE = 0.1  # from OPEN to the first report that the driver hands on
AT_ONCE = LISTEN + ONE_CYCLE
RETRY = 0.4


def now() -> float:
    return asyncio.get_running_loop().time()


async def test_an_undisturbed_handshake_takes_one_cycle_after_listening() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        assert now() == pytest.approx(AT_ONCE)
        assert driver.info.identity.model == "p3at-sh"
        assert driver.info.config is not None
    assert robot.wires[0].data.startswith(SYNCS[0] + SYNCS[1] + SYNCS[2] + OPEN + STOP)


@pytest.mark.parametrize("sync", SYNCS, ids=SYNC_NAMES)
@pytest.mark.parametrize("becomes", [lost, corrupted])
async def test_a_spoilt_sync_costs_one_retry(
    sync: bytes, becomes: Callable[[bytes], bytes]
) -> None:
    fault = First(sync, becomes)
    async with SimulatedRobot(to_robot=fault) as robot, connect_async(robot.open) as driver:
        assert fault.times == 0
        assert now() == pytest.approx(RETRY + AT_ONCE)
        await hold(driver, 0.2)
        assert robot.speed > 0.1


@pytest.mark.parametrize("sync", SYNCS, ids=SYNC_NAMES)
async def test_a_doubled_sync_costs_nothing(sync: bytes) -> None:
    fault = First(sync, doubled)
    async with SimulatedRobot(to_robot=fault) as robot, connect_async(robot.open) as driver:
        assert fault.times == 0
        assert now() == pytest.approx(AT_ONCE)
        await hold(driver, 0.2)
        assert robot.speed > 0.1


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("becomes", [lost, corrupted])
async def test_a_spoilt_echo_costs_one_retry(
    number: int, becomes: Callable[[bytes], bytes]
) -> None:
    fault = First(SYNCS[number], becomes)
    async with SimulatedRobot(to_host=fault) as robot, connect_async(robot.open):
        assert fault.times == 0
        assert now() == pytest.approx(RETRY + AT_ONCE)


async def test_a_lost_open_is_repeated_with_the_request_for_config() -> None:
    fault = First(OPEN, lost)
    async with SimulatedRobot(to_robot=fault) as robot, connect_async(robot.open) as driver:
        assert fault.times == 0
        assert now() == pytest.approx(0.25 + AT_ONCE, abs=TICK)
        assert driver.info.config is not None
        assert robot.wires[0].data.count(OPEN) == 1


async def test_a_robot_that_moves_in_an_earlier_session_is_stopped_with_the_first_bytes() -> None:
    async with SimulatedRobot() as robot:
        for payload in (b"\0", b"\1", b"\2"):
            robot.firmware.receive(encode(payload), now())
        for command in (commands.Open(), commands.Enable(on=True), commands.Vel(0.4)):
            robot.firmware.receive(frame(command), now())
        await asyncio.sleep(1.5)
        assert robot.speed > 0.3
        async with connect_async(robot.open) as driver:
            assert robot.wires[0].data.startswith(STOP + CLOSE)
            assert now() < 1.5 + 1.0
            assert robot.speed < 0.4 - 0.3 * 0.2
            await asyncio.sleep(1.5)
            assert robot.speed == 0
            assert not robot.powered
            await hold(driver, 0.2)
            assert robot.speed > 0.1


@pytest.mark.parametrize(
    ("latency", "speeds"), [(0.0, ()), (0.1, ()), (0.3, ()), (0.0, (38400,)), (0.0, SPEEDS)]
)
@pytest.mark.parametrize("noise", [0.0, 0.01])
async def test_a_robot_that_the_watchdog_holds_is_stopped_before_it_hears_anything_else(
    latency: float, speeds: tuple[int, ...], noise: float
) -> None:
    to_host = Noise(Random(1), corrupt=noise)
    async with SimulatedRobot(speeds=speeds, to_host=to_host) as robot:
        robot.latency = latency
        for payload in (b"\0", b"\1", b"\2"):
            robot.firmware.receive(encode(payload), now())
        for command in (commands.Open(), commands.Enable(on=True), commands.Vel(0.4)):
            robot.firmware.receive(frame(command), now())
        await asyncio.sleep(6.0)
        assert robot.body.drive.held
        assert robot.speed == 0
        before = robot.body.robot_in_world
        async with connect_async(robot.open):
            await asyncio.sleep(1.0)
            assert is_at(robot.body.robot_in_world, before)


async def test_at_the_speeds_that_give_noise_nothing_is_sent() -> None:
    async with SimulatedRobot(speeds=SPEEDS) as robot:
        for payload in (b"\0", b"\1", b"\2", b"\1"):
            robot.firmware.receive(encode(payload), now())
        async with connect_async(robot.open) as driver:
            assert driver.info.speed == SPEEDS[-1]
            assert robot.wires[0].data.startswith(STOP + CLOSE)
            assert now() < len(SPEEDS) * 0.4


async def test_a_held_robot_whose_reports_are_lost_drives_for_one_retry_at_most() -> None:
    async with SimulatedRobot(to_host=lambda data: ()) as robot:
        for payload in (b"\0", b"\1", b"\2"):
            robot.firmware.receive(encode(payload), now())
        for command in (commands.Open(), commands.Enable(on=True), commands.Vel(0.4)):
            robot.firmware.receive(frame(command), now())
        await asyncio.sleep(6.0)
        before = robot.body.robot_in_world
        with pytest.raises(NoRobotError):
            async with connect_async(robot.open):
                pass
        assert robot.body.robot_in_world.x - before.x < 0.4 * (3 * RETRY + 0.5)
        assert robot.speed == 0


async def test_a_robot_that_talks_but_does_not_hear_is_given_up() -> None:
    async with SimulatedRobot(to_robot=lambda data: ()) as robot:
        for payload in (b"\0", b"\1", b"\2", b"\1"):
            robot.firmware.receive(encode(payload), now())
        with pytest.raises(NoRobotError, match="sends, but does not receive"):
            async with connect_async(robot.open):
                pass
        assert now() == pytest.approx(12.0, abs=0.5)


async def test_bytes_one_at_a_time_make_no_difference() -> None:
    async with (
        SimulatedRobot(to_robot=bytewise, to_host=bytewise) as robot,
        connect_async(robot.open) as driver,
    ):
        assert now() == pytest.approx(AT_ONCE)
        await hold(driver, 0.2)
        assert robot.speed > 0.1


async def test_a_dead_line_is_given_up_with_the_reason() -> None:
    async with SimulatedRobot(to_robot=lambda data: ()) as robot:
        with pytest.raises(NoRobotError, match="nothing answers"):
            async with connect_async(robot.open):
                pass
        assert now() == pytest.approx(12.0, abs=RETRY)


async def test_an_echo_of_our_own_bytes_is_no_robot() -> None:
    async def open_loopback() -> Link:
        link = MemoryLink("memory:loopback")
        link.peer = link
        return link

    with pytest.raises(NoRobotError):
        async with connect_async(open_loopback):
            pass


async def test_something_that_is_no_robot_is_called_so() -> None:
    async def open_modem() -> Link:
        link = MemoryLink("memory:modem", lambda data: (b"ERROR\r\n",))
        link.peer = link
        return link

    with pytest.raises(NoRobotError, match="something answers, but not as a Pioneer"):
        async with connect_async(open_modem):
            pass


async def test_a_robot_at_another_speed_is_found_and_the_speed_remembered() -> None:
    def speeds() -> tuple[int, ...]:
        first = remembered_speed("/dev/robot") or SPEEDS[0]
        return (first, *(s for s in SPEEDS if s != first))

    async with SimulatedRobot(speeds=speeds(), url="serial:/dev/robot") as robot:
        robot.robot_speed = 38400
        async with connect_async(robot.open) as driver:
            assert driver.info.speed == 38400
            assert now() == pytest.approx(2 * (LISTEN + 2 * RETRY) + AT_ONCE)  # two tries each
            await hold(driver, 0.2)
            assert robot.speed > 0.1
        robot.speeds = speeds()
        assert robot.speeds[0] == 38400
        began = now()
        async with connect_async(robot.open):
            assert now() - began < 0.6


async def test_a_line_that_answers_at_no_speed_names_the_speeds() -> None:
    async with SimulatedRobot(speeds=(9600, 38400)) as robot:
        robot.robot_speed = 115200
        robot.to_robot = robot.to_host = lambda data: ()
        with pytest.raises(NoRobotError, match="nothing answers at 9600, 38400 baud"):
            async with connect_async(robot.open):
                pass


WHAT_IT_IS = b"\x20Pioneer\0p3at-sh\0S"


def config_with_wrong_checksum(data: bytes) -> bytes:
    """Spoil the checksum of CONFIG, the same way each time."""
    at = data.find(b"\x20Pioneer\0")
    if at < 0:
        return data
    end = at - 1 + data[at - 1]
    return data[:end] + bytes([data[end] ^ 0x40]) + data[end + 1 :]


async def test_a_config_with_a_wrong_checksum_is_believed_when_it_comes_twice_alike() -> None:
    async with SimulatedRobot() as robot:
        robot.edit = config_with_wrong_checksum
        async with connect_async(robot.open) as driver:
            assert driver.info.config is not None
            assert driver.info.config.serial_number == "SIM"
            assert robot.wires[0].commands.count(commands.RequestConfig()) == 2


class SpoiltDifferently:
    """Put a number into each CONFIG, which its checksum does not know of."""

    def __init__(self) -> None:
        self.times = 0

    def __call__(self, data: bytes) -> bytes:
        self.times += data.count(WHAT_IT_IS)
        return data.replace(WHAT_IT_IS, WHAT_IT_IS[:-1] + bytes([self.times]))


async def test_configs_that_are_spoilt_differently_are_not_believed() -> None:
    async with SimulatedRobot() as robot:
        robot.edit = spoil = SpoiltDifferently()
        async with connect_async(robot.open) as driver:
            assert driver.info.config is None
            assert spoil.times >= 6


async def test_without_config_the_values_of_the_model_hold() -> None:
    async with (
        SimulatedRobot(to_robot=lambda data: (data.replace(CONFIG, b""),)) as robot,
        connect_async(robot.open) as driver,
    ):
        assert driver.info.config is None
        assert driver.info.limits.max_speed == load_model("p3at-sh").max_speed
        assert now() == pytest.approx(LISTEN + 1.5, abs=ONE_CYCLE)
        await hold(driver, 0.2)
        assert robot.speed > 0.1


def without_reports(data: bytes) -> bytes:
    """Keep all but the SIPs."""
    payloads = PacketReader().feed(data)
    return b"".join(encode(p) for p in payloads if not isinstance(from_payload(p), reports.Sip))


async def test_a_robot_that_never_sends_reports_is_lost_after_the_silence() -> None:
    async with SimulatedRobot() as robot:
        robot.edit = without_reports
        with pytest.raises(LinkError, match="has said nothing for 2 s"):
            async with connect_async(robot.open):
                pass


async def test_an_unknown_robot_is_driven_by_what_its_config_says() -> None:
    async with SimulatedRobot() as robot:
        robot.edit = renamed
        async with connect_async(robot.open) as driver:
            assert driver.info.identity.model == "p3zz-sh"
            assert driver.info.limits.max_speed <= 1.2


def renamed(data: bytes) -> bytes:
    """Replace the robot's type by one that nobody knows."""
    start = data.find(b"\xfa\xfb")
    if b"p3at-sh" not in data or start < 0:
        return data
    pieces, rest = [], data
    while rest:
        size = rest[2] + 3
        payload, rest = rest[3 : size - 2], rest[size:]
        pieces.append(encode(payload.replace(b"p3at-sh", b"p3zz-sh")))
    return b"".join(pieces)


async def test_a_home_that_is_not_writable_is_no_obstacle(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    async with (
        SimulatedRobot(
            speeds=(9600,), url="serial:/dev/robot", home=Pose2(), to_robot=clean
        ) as robot,
        connect_async(robot.open) as driver,
    ):
        assert driver.info.speed == 9600
    assert remembered_speed("/dev/robot") is None


def hold_up(seconds: float) -> None:
    """Be busy for so long, as a program that imports or computes: nobody reads the link."""
    asyncio.get_running_loop()._autojump.now += seconds  # type: ignore[attr-defined]


@pytest.mark.parametrize("event", ["Opened", "Configured", "ReportReceived"])
async def test_a_computer_that_is_busy_while_it_connects_loses_no_healthy_robot(
    event: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    handle, busy = Session._handle, [3.0]

    def slowly(self: Session, happened: Event, stamp: float) -> None:
        handle(self, happened, stamp)
        if type(happened).__name__ == event and busy:
            hold_up(busy.pop())

    monkeypatch.setattr(Session, "_handle", slowly)
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        assert 3.0 <= now() < 3.5
        assert driver.info.config is not None
        await hold(driver, 0.2)
        assert robot.speed > 0.1
        assert len(robot.wires) == 1


async def test_time_in_which_nobody_listens_is_not_taken_off_the_patience_of_a_handshake() -> None:
    busy = [13.0]

    def answers_wait(data: bytes) -> tuple[bytes, ...]:
        if busy:
            hold_up(busy.pop())
        return (data,)

    async with SimulatedRobot(to_host=answers_wait) as robot, connect_async(robot.open) as driver:
        assert 13.0 < now() < 13.5
        assert driver.info.config is not None


async def test_a_robot_that_falls_silent_while_the_computer_is_busy_is_lost_all_the_same() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.silent = True
        await asyncio.sleep(0.5)
        hold_up(3.0)
        woken = now()
        await until(lambda: driver.snapshot is None)
        assert now() - woken == pytest.approx(1.5, abs=0.15)
