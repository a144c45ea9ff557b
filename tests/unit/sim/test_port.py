"""One robot's place for hosts: who gets it, how much a tick takes, when it sends. Virtual time."""

import asyncio
from math import inf

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.clients import GRACE, STALE
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.pacer import TICK
from pioneer3.sim.server.port import BURST, BYTES_PER_TICK, MOST_WAITING, RobotPort
from pioneer3.sim.world import World
from tests.support import frame

SYNC = encode(b"\0")
HELLO = b"".join(encode(bytes([number])) for number in (0, 1, 2)) + frame(commands.Open())


class Host:
    """A host that keeps what it gets."""

    full = False

    def __init__(self, peer: str = "host", *, permanent: bool = False) -> None:
        self.peer, self.permanent = peer, permanent
        self.got = b""
        self.listened_to = self.closed = False

    def resume(self) -> None:
        self.listened_to = True

    def pause(self) -> None:
        self.listened_to = False

    def send(self, data: bytes) -> None:
        self.got += data

    def close(self) -> None:
        self.closed = True

    @property
    def kinds(self) -> list[int]:
        return [payload[0] for payload in PacketReader().feed(self.got)]


class Site:
    """A robot and its port."""

    def __init__(self, *, keep_session: bool = False) -> None:
        self.body = Body(load_model("p3dx-sh"))
        self.world = World(None, [self.body])
        self.firmware = Firmware(self.world, self.body)
        self.woken = 0
        self.port = RobotPort(self.firmware, self._wake, keep_session=keep_session)
        self.turn = 0

    def welcome(self, *names: str) -> list[Host]:
        hosts = [Host(name) for name in names]
        for host in hosts:
            self.port.admit(host)
        return hosts

    def tick(self, count: int = 1) -> None:
        for _ in range(count):
            if self.port.pending:
                self.port.take(self.world.time, self.turn)
                self.port.flush(self.world.time)
            self.world.step(TICK)
            self.turn += 1
            if self.port.due <= self.world.time + 1e-6:
                self.port.tick(self.world.time)

    def _wake(self) -> None:
        self.woken += 1


async def test_the_first_host_gets_the_place_and_the_second_is_told_no() -> None:
    site = Site()
    first, second = site.welcome("first", "second")
    assert first.listened_to
    await asyncio.sleep(GRACE / 2)
    assert not second.closed
    await asyncio.sleep(GRACE)
    assert second.closed
    assert not second.listened_to
    assert not first.closed
    assert site.port.connected
    assert site.port.peer == "first"


async def test_of_a_crowd_one_waits_and_the_others_are_told_no_at_once() -> None:
    site = Site()
    _, *others = site.welcome(*"abcde")
    assert [host.closed for host in others] == [False, True, True, True]
    assert site.port.full


async def test_the_waiting_host_gets_the_place_when_the_first_leaves() -> None:
    site = Site()
    first, second, _ = site.welcome("first", "second", "third")
    await asyncio.sleep(GRACE / 2)
    site.port.disconnected(first)
    assert site.port.peer == "second"
    await asyncio.sleep(GRACE)
    assert not second.closed


async def test_a_waiting_host_that_leaves_makes_room_for_another() -> None:
    site = Site()
    _, second = site.welcome("first", "second")
    site.port.disconnected(second)
    (third,) = site.welcome("third")
    assert not third.closed
    await asyncio.sleep(GRACE * 2)
    assert third.closed
    assert not site.port.full


async def test_a_silent_host_loses_its_place_to_the_next_only() -> None:
    site = Site()
    (first,) = site.welcome("first")
    await asyncio.sleep(STALE - 0.3)
    site.port.received(first, SYNC)
    site.tick()
    await asyncio.sleep(STALE - 0.3)
    (second,) = site.welcome("second")
    await asyncio.sleep(0.2)
    assert second.closed
    await asyncio.sleep(10)
    assert not first.closed
    (third,) = site.welcome("third")
    assert first.closed
    assert site.port.peer == "third"
    site.port.received(first, SYNC)  # its last words come too late
    site.port.disconnected(first)
    assert site.port.peer == "third"
    assert not site.port.pending
    assert not third.closed


async def test_a_flood_is_taken_at_the_rate_of_a_serial_line_and_then_waits() -> None:
    site = Site()
    (host,) = site.welcome("flood")
    site.port.received(host, HELLO)
    site.tick(3)
    greeted = site.firmware.device.reader.packets
    flood = frame(commands.Pulse()) * 1000
    sent = 0
    while host.listened_to:
        site.port.received(host, flood[sent : sent + 500])
        sent += 500
    assert MOST_WAITING <= sent <= MOST_WAITING + 500
    assert site.woken == sent / 500 + 1
    site.tick()
    taken = (site.firmware.device.reader.packets - greeted) * 6
    assert BURST - 6 < taken <= BURST
    site.tick(6)
    rate = ((site.firmware.device.reader.packets - greeted) * 6 - taken) / 6
    assert rate == pytest.approx(BYTES_PER_TICK, abs=1)
    assert host.listened_to
    site.tick(20)
    assert not site.port.pending


async def test_answers_count_as_well_as_questions() -> None:
    site = Site()
    (host,) = site.welcome("flood")
    site.port.received(host, HELLO)
    site.tick()
    host.got = b""
    for _ in range(200):
        if host.listened_to:
            site.port.received(host, frame(commands.RequestConfig()) * 100)
        site.tick()
    answered = host.kinds.count(0x20)
    reports = host.got.count(b"\xfa\xfb") - answered
    assert answered > 100
    assert reports == 40
    assert len(host.got) < 200 * BYTES_PER_TICK + 40 * 100 + BURST * 20


async def test_a_host_that_floods_and_leaves_does_not_burden_the_next() -> None:
    site = Site()
    (first,) = site.welcome("first")
    site.port.received(first, b"\xfa\xfb\xff" * 1000)
    site.port.disconnected(first)
    site.welcome("second")
    site.tick()
    assert not site.port.pending


async def test_a_host_that_floods_for_long_loses_its_place_to_the_next() -> None:
    site = Site()
    (first,) = site.welcome("first")
    end = asyncio.get_running_loop().time() + STALE + 0.1
    while asyncio.get_running_loop().time() < end:
        while first.listened_to:
            site.port.received(first, SYNC * 100)
        site.tick()
        await asyncio.sleep(TICK)
    site.welcome("second")
    assert first.closed
    assert site.port.peer == "second"
    assert not site.port.pending


async def test_last_words_are_heard() -> None:
    site = Site()
    (host,) = site.welcome("first")
    site.port.received(host, HELLO)
    site.tick(3)
    assert site.port.is_open
    site.port.received(host, frame(commands.Close()))
    site.port.disconnected(host)
    site.tick()
    assert not site.port.is_open


async def test_a_host_that_vanishes_has_ended_its_session_before_the_next_is_heard() -> None:
    site = Site()
    first, second = site.welcome("first", "second")
    site.port.received(first, HELLO + frame(commands.Enable(on=True)) + frame(commands.Vel(0.3)))
    site.tick(50)
    assert site.body.drive.powered
    site.port.disconnected(first)
    site.port.received(second, SYNC)
    site.tick()
    assert second.kinds == [0]
    assert not site.port.is_open
    assert not site.body.drive.powered


async def test_the_last_words_of_a_host_that_vanishes_are_heard() -> None:
    site = Site()
    (host,) = site.welcome("first")
    site.port.received(host, HELLO)
    site.tick(3)
    site.port.received(host, encode(b"\xee\x2b\x02hi\0"))  # SIM_MESSAGE
    site.port.disconnected(host)
    site.tick()
    assert list(site.firmware.console.messages) == ["hi"]
    assert not site.port.is_open


async def test_a_host_that_has_said_goodbye_is_not_hung_up_on() -> None:
    site = Site()
    (host,) = site.welcome("first")
    site.port.received(host, HELLO)
    site.tick(3)
    site.port.received(host, frame(commands.Close()))
    site.port.disconnected(host)
    site.tick()
    assert not site.port.is_open
    assert site.firmware.device.reader.packets == 5  # it goes on counting


async def test_a_host_that_gives_way_leaves_no_session_to_the_next() -> None:
    site = Site()
    (first,) = site.welcome("first")
    site.port.received(first, HELLO)
    site.tick(3)
    await asyncio.sleep(STALE)
    (second,) = site.welcome("second")
    assert first.closed
    site.port.received(second, SYNC)
    site.tick()
    assert second.kinds == [0]


async def test_a_session_that_is_kept_is_there_for_the_next_host() -> None:
    site = Site(keep_session=True)
    first, second = site.welcome("first", "second")
    site.port.received(first, HELLO + frame(commands.Enable(on=True)) + frame(commands.Vel(0.3)))
    site.tick(50)
    site.port.disconnected(first)
    site.port.received(second, SYNC)
    site.tick(10)
    assert set(second.kinds) == {0x33}  # it streams reports, and SYNC0 was a PULSE
    assert site.body.drive.linear.velocity > 0.2


async def test_a_session_left_over_ends_after_the_watchdogs_time() -> None:
    site = Site(keep_session=True)
    (host,) = site.welcome("first")
    site.port.received(host, HELLO)
    site.tick(3)
    site.port.disconnected(host)
    site.tick(round((STALE - 0.1) / TICK))
    assert site.port.is_open
    site.tick(round(0.2 / TICK))
    assert not site.port.is_open
    assert site.port.due == inf


async def test_reports_go_out_when_they_are_due_and_at_no_other_time() -> None:
    site = Site()
    (host,) = site.welcome("host")
    site.port.received(host, HELLO)
    site.tick()
    assert host.kinds == [0, 1, 2, 0x32]
    site.tick(4)
    for _ in range(10):
        before = len(host.got)
        site.port.received(host, frame(commands.Pulse()))
        site.tick(4)
        assert len(host.got) == before
        site.tick()
        assert len(host.got) > before


async def test_a_standing_line_takes_the_place_by_its_first_word() -> None:
    site = Site()
    line = Host("/dev/pts/7", permanent=True)
    (host,) = site.welcome("tcp")
    site.port.received(line, SYNC)
    assert site.port.peer == "tcp"
    assert not site.port.pending
    site.port.disconnected(host)
    assert not site.port.connected
    site.port.received(line, HELLO)
    assert site.port.peer == "/dev/pts/7"
    site.tick()
    assert line.kinds == [0, 1, 2, 0x32]


async def test_a_standing_line_gives_the_place_back_with_close() -> None:
    site = Site()
    line = Host("/dev/pts/7", permanent=True)
    site.port.received(line, HELLO)
    site.tick(2)
    site.port.received(line, frame(commands.Close()))
    site.tick(2)
    assert not site.port.connected
    (host,) = site.welcome("tcp")
    assert site.port.peer == "tcp"
    site.port.received(line, SYNC)
    assert not site.port.pending
    assert not host.closed


async def test_noise_on_a_standing_line_keeps_nobody_away() -> None:
    site = Site()
    site.port.received(Host("/dev/pts/7", permanent=True), b"AT+RESET\r")
    site.tick()
    site.welcome("tcp")
    assert site.port.peer == "tcp"


async def test_a_cable_that_is_pulled_out_parts_and_full_until_it_is_in_again() -> None:
    site = Site()
    (host,) = site.welcome("host")
    site.port.received(host, SYNC)
    site.port.faults.unplug()
    site.port.check_cable()
    assert host.closed
    assert not site.port.pending
    (second,) = site.welcome("second")
    assert second.closed
    assert site.port.full
    site.port.faults.plug_in()
    site.port.check_cable()
    (third,) = site.welcome("third")
    assert not third.closed


async def test_a_slow_cable_delays_both_ways_and_keeps_its_robot_awake() -> None:
    site = Site()
    site.port.faults = LinkFaults(delay=0.2)
    (host,) = site.welcome("host")
    site.port.received(host, SYNC)
    site.tick(19)
    assert host.got == b""
    site.tick(3)
    assert host.got == SYNC
    assert not site.port.pending
    assert site.port.due == inf


async def test_a_frozen_cable_keeps_its_host_and_passes_nothing() -> None:
    site = Site()
    (host,) = site.welcome("host")
    site.port.received(host, HELLO)
    site.tick()
    site.port.faults.frozen = True
    host.got = b""
    site.port.received(host, frame(commands.Enable(on=True)))
    site.tick(50)
    assert host.got == b""
    assert not host.closed
    assert not site.body.drive.powered
    site.port.faults.frozen = False
    site.tick(10)
    assert host.kinds == [0x32, 0x32]


async def test_a_host_in_session_is_awaited_until_it_has_said_something_valid() -> None:
    site = Site()
    (host,) = site.welcome("host")
    assert not site.port.awaited
    site.port.received(host, HELLO)
    site.tick()
    assert site.port.awaited
    site.port.received(host, b"noise")
    site.tick()
    assert site.port.awaited
    site.port.received(host, frame(commands.Pulse()))
    site.tick()
    assert not site.port.awaited
    site.port.expect_packet()
    assert site.port.awaited
    site.port.disconnected(host)
    assert not site.port.awaited


async def test_a_host_whose_watchdog_has_bitten_is_not_awaited() -> None:
    site = Site()
    (host,) = site.welcome("host")
    site.port.received(host, HELLO)
    site.tick(round(2.2 / TICK))
    assert site.port.connected
    assert not site.port.awaited


async def test_the_watchdog_is_stretched_and_a_resting_one_rests() -> None:
    site = Site()
    site.port.scale_watchdog(10)
    (host,) = site.welcome("host")
    site.port.received(host, HELLO)
    site.tick(round(19 / TICK))
    assert not site.body.drive.held
    site.tick(round(2 / TICK))
    assert site.body.drive.held
    site.port.received(host, SYNC)
    site.port.scale_watchdog(inf)
    site.tick(5000)
    assert not site.body.drive.held
    never = Firmware(site.world, site.body, watchdog=0)
    RobotPort(never).scale_watchdog(inf)
    assert never.device.watchdog == 0
