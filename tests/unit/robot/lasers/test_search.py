"""The search for a laser's protocol: simulated lasers on cables, and everything that is none."""

import asyncio
from random import Random

import pytest

from pioneer3.arcos.packet import encode
from pioneer3.doctor.lasers import laser_on
from pioneer3.errors import ConfigError
from pioneer3.lasers.client import Event, LineSpeedWanted, Patience, ScanSettings, ScansLost
from pioneer3.lasers.lms2xx.measuring import Units
from pioneer3.lasers.lms2xx.scans import VALUES, Measurement
from pioneer3.lasers.lms2xx.telegram import encode as telegram_of
from pioneer3.lasers.recognition import QUESTION, recognise
from pioneer3.lasers.scip.wire import seal
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.lasers.search import (
    NOTHING,
    SPEEDS,
    SPEEDS_OF_SCANS,
    ProtocolSearch,
    client_of,
)
from pioneer3.tasks import running
from tests.lasers import LEFT, LaserUnit
from tests.support import SimulatedRobot, until

PATIENCE = Patience(give_up=4.0)
UNITS = [
    ("utm-30lx", True, LaserProtocol.SCIP),
    ("utm-30lx", False, LaserProtocol.SCIP),
    ("urg-04lx", True, LaserProtocol.SCIP),
    ("lms-200", True, LaserProtocol.LMS2XX),
    ("lms-111", False, LaserProtocol.COLA),
    ("tim551", False, LaserProtocol.COLA),
]


def search(speeds: tuple[int, ...] = (), patience: Patience = PATIENCE) -> ProtocolSearch:
    return ProtocolSearch(0.0, speeds, ScanSettings(), patience)


def run(
    found: ProtocolSearch, seconds: float, hears: bytes = b"", *, echo: bool = False
) -> list[Event]:
    """Let time pass; `hears` comes once, 1 ms after the search has set a speed, or with `echo`
    all that it sends; return all events, and after the first loss nothing more.
    """
    events: list[Event] = []
    now = 0.0
    while now < seconds:
        events += found.tick(now)
        sent = found.outgoing()
        heard, hears = (sent if echo else hears), (hears if echo else b"")
        if heard:
            events += found.receive(heard, now + 0.001)
        if any(isinstance(event, ScansLost) for event in events):
            break
        now = max(now + 1e-6, min(found.deadline, now + 0.05))
    return events


@pytest.mark.parametrize(("name", "serial", "protocol"), UNITS)
async def test_every_laser_answers_the_question(
    name: str, serial: bool, protocol: LaserProtocol
) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, name, serial=serial) as unit:
        link = await unit.open()
        found = await laser_on(link, PATIENCE)
        assert found is not None
        assert found.protocol is protocol
        await link.close()


@pytest.mark.parametrize("name", LEFT)
async def test_a_laser_left_scanning_at_another_speed_is_recognised(name: str) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, name, serial=True) as unit:
        link = await unit.open()
        for baud, data in LEFT[name]:
            await link.set_speed(baud)
            await link.write(data)
            await asyncio.sleep(0.5)
        await link.close()
        speed = unit.laser.device.speed
        assert speed == LEFT[name][-1][0]
        again = await unit.open()
        found = await laser_on(again, PATIENCE)
        assert found is not None
        assert found.protocol is {"urg-04lx": LaserProtocol.SCIP}.get(name, LaserProtocol.LMS2XX)
        assert unit.laser.device.speed == speed  # no question changes a setting
        await again.close()


@pytest.mark.parametrize(
    ("heard", "protocol"),
    [
        (b"MD0000108001000\r\n99b\r\n0Ej9\r\n", LaserProtocol.SCIP),
        (b"\x02sSN LMDscandata 1 1 89A27F\x03", LaserProtocol.COLA),
        (bytes.fromhex("02800A00B00340E803E903FF1F10A3EA"), LaserProtocol.LMS2XX),
    ],
)
def test_a_laser_that_scans_is_recognised_before_it_is_asked(
    heard: bytes, protocol: LaserProtocol
) -> None:
    found: list[LaserProtocol] = []
    searching = ProtocolSearch(0.0, (), ScanSettings(), PATIENCE, found=found.append)
    searching.tick(0.0)
    assert searching.outgoing() == b""
    searching.receive(heard, 0.01)
    assert found == [protocol]


@pytest.mark.parametrize("later", [0.0, 0.17, 0.34, 0.51, 0.68])
@pytest.mark.parametrize("name", LEFT)
async def test_a_laser_left_scanning_at_another_speed_scans_within_3_s(
    name: str, later: float
) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, name, serial=True) as unit:
        link = await unit.open()
        for baud, data in LEFT[name]:
            await link.set_speed(baud)
            await link.write(data)
            await asyncio.sleep(0.5)
        await asyncio.sleep(later)
        await link.close()
        driver = unit.driver()
        async with running(driver.run()):
            await driver.reading(3.0)


def scip_line(letters: bytes) -> bytes:
    """Return a full line of a scan."""
    return seal(letters[:64])


SCIP_PART = b"0a0b\n" + scip_line(b"0h0h0i0j" * 8) + b"\n" + b"0k0k"
LMS_SCAN = telegram_of(
    VALUES,
    Measurement(code=VALUES, values=(300,) * 181, units=Units.CENTIMETRES).to_body() + b"\x10",
    0x80,
)


@pytest.mark.parametrize(
    ("heard", "protocol"),
    [
        (SCIP_PART, LaserProtocol.SCIP),
        (SCIP_PART.replace(b"0h", b"0g", 1), None),
        (SCIP_PART.replace(b"\n", b""), None),
        (b"\x01\x17\x01" + LMS_SCAN[:60], LaserProtocol.LMS2XX),
        (b"\x01\x17\x01" + LMS_SCAN[:6], None),
        (b"\x17" + LMS_SCAN[:2] + b"\x71" + LMS_SCAN[3:60], None),
        (b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n" * 20, None),
    ],
)
def test_part_of_a_scan_tells_the_protocol(heard: bytes, protocol: LaserProtocol | None) -> None:
    assert recognise(heard) is protocol


@pytest.mark.parametrize("seed", range(20))
def test_random_bytes_are_no_scan(seed: int) -> None:
    assert recognise(Random(seed).randbytes(20_000)) is None


def speeds_tried(hears: bytes) -> list[int]:
    """Return the speeds that are tried within a round in which these bytes come at the first."""
    events = run(search(SPEEDS, Patience(give_up=60.0)), 8.0, hears)
    return [event.baud for event in events if isinstance(event, LineSpeedWanted)][: len(SPEEDS)]


def test_after_bytes_of_a_scan_at_another_speed_the_quick_speeds_are_next() -> None:
    noise = Random(1).randbytes(300)
    assert speeds_tried(b"") == [*SPEEDS]
    assert speeds_tried(noise) == [*SPEEDS_OF_SCANS]
    assert sorted(SPEEDS_OF_SCANS) == sorted(SPEEDS)


def test_bytes_from_before_the_change_of_speed_do_not_count() -> None:
    found: list[LaserProtocol] = []
    late = ProtocolSearch(0.0, SPEEDS, ScanSettings(), PATIENCE, found=found.append)
    assert late.tick(0.0) == [LineSpeedWanted(115200)]
    late.receive(Random(1).randbytes(200), 0.01)
    late.receive(b"0j0k" * 30 + b"\n", 0.09)
    assert late.tick(0.1) == []
    late.receive(scip_line(b"0h0h0i0j" * 8) + b"\n", 0.12)
    assert found == [LaserProtocol.SCIP]


def test_a_robot_that_sends_its_reports_is_left_alone() -> None:
    report = encode(bytes([0x32]) + bytes(30))
    events = run(search(), 2.0, b"\x00" + report)
    assert events == [
        ScansLost("this port leads to the robot, not to a laser: give it with --port")
    ]


def test_an_echo_is_no_laser() -> None:
    assert run(search(), 2.0, echo=True) == [
        ScansLost("what was sent comes back: the line's two ends are joined")
    ]


def test_where_nothing_answers_it_gives_up_after_all_speeds() -> None:
    searching = search(SPEEDS)
    events = run(searching, 100.0)
    assert [event.baud for event in events if isinstance(event, LineSpeedWanted)][:6] == list(
        SPEEDS
    )
    assert events[-1] == ScansLost(NOTHING)


def test_in_the_network_it_sets_no_speed() -> None:
    events = run(search(), 100.0)
    assert events == [ScansLost(NOTHING)]


def test_only_speeds_of_the_port_are_tried() -> None:
    events = run(search((9600, 38400)), 3.0)
    assert {event.baud for event in events if isinstance(event, LineSpeedWanted)} == {9600, 38400}


def test_giving_up_takes_as_long_as_the_patience_and_no_longer() -> None:
    searching = search(SPEEDS, Patience(give_up=1.0))
    now = 0.0
    while not any(isinstance(event, ScansLost) for event in searching.tick(now)):
        searching.outgoing()
        now = searching.deadline
        assert now < 2.0
    assert now >= 1.0


@pytest.mark.parametrize("seed", range(5))
def test_noise_at_a_wrong_speed_is_neither_a_laser_nor_asked(seed: int) -> None:
    noise, sent = Random(seed), b""
    searching = search((115200, 38400))
    now = 0.0
    for _ in range(15):
        for event in searching.tick(now):
            assert isinstance(event, LineSpeedWanted)
        assert searching.receive(noise.randbytes(100), now + 0.005) == []
        sent += searching.outgoing()
        now += 0.01
    assert QUESTION not in sent


async def test_the_speed_is_left_as_it_was_found() -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "lms-200", serial=True) as unit:
        link = await unit.open()
        found = await laser_on(link, PATIENCE)
        assert found is not None
        assert found.protocol is LaserProtocol.LMS2XX
        assert unit.laser.device.speed == 9600
        await link.close()


async def test_a_driver_says_at_which_protocol_it_arrived() -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "urg-04lx", serial=True) as unit:
        driver = unit.driver()
        assert driver.protocol is None
        running = asyncio.ensure_future(driver.run())
        await until(lambda: driver.latest)
        assert driver.protocol is LaserProtocol.SCIP
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)


def test_there_are_clients_of_all_protocols() -> None:
    for protocol in LaserProtocol:
        client = client_of(protocol, 0.0, SPEEDS, ScanSettings(), PATIENCE)
        client.tick(0.0)
        assert client.deadline > 0.0
    with pytest.raises(ConfigError, match="no such protocol"):
        client_of("morse", 0.0, (), ScanSettings(), PATIENCE)  # type: ignore[arg-type]
