"""The robot's side of a session, packet by packet (protocol.md 2, 2.7)."""

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.device import (
    Commanded,
    Device,
    Event,
    SessionClosed,
    SessionOpened,
    SessionPhase,
    WatchdogExpired,
    WatchdogFed,
)
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.state import Identity
from tests.support import frame

WHO = Identity(name="MobileSim", family="Pioneer", model="p3at-sh")
SYNC0, SYNC1, SYNC2 = (encode(bytes([number])) for number in (0, 1, 2))
IDENTITY = encode(b"\x02MobileSim\0Pioneer\0p3at-sh\0")
OPEN, CLOSE = frame(commands.Open()), frame(commands.Close())


def device(watchdog: float = 2.0) -> Device:
    return Device(WHO, watchdog)


def opened(watchdog: float = 2.0) -> Device:
    robot = device(watchdog)
    assert robot.receive(SYNC0 + SYNC1 + SYNC2 + OPEN, 0.0) == [SessionOpened()]
    robot.outgoing()
    return robot


def test_each_sync_is_answered() -> None:
    robot = device()
    for sync, answer in ((SYNC0, SYNC0), (SYNC1, SYNC1), (SYNC2, IDENTITY)):
        assert robot.receive(sync, 0.0) == []
        assert robot.outgoing() == answer
    assert robot.phase is SessionPhase.READY
    assert not robot.is_open
    assert robot.receive(OPEN, 0.0) == [SessionOpened()]
    assert robot.is_open
    assert robot.outgoing() == b""


def test_a_repeated_sync_is_answered_again() -> None:
    robot = device()
    robot.receive(SYNC0 * 2 + SYNC1 * 2 + SYNC2 * 2, 0.0)
    assert robot.outgoing() == SYNC0 * 2 + SYNC1 * 2 + IDENTITY * 2
    assert robot.receive(OPEN, 0.0) == [SessionOpened()]


@pytest.mark.parametrize("before", [SYNC0, SYNC0 + SYNC1, SYNC0 + SYNC1 + SYNC2])
def test_sync0_begins_anew(before: bytes) -> None:
    robot = device()
    robot.receive(before, 0.0)
    robot.outgoing()
    robot.receive(SYNC0 + SYNC1 + SYNC2, 0.0)
    assert robot.outgoing() == SYNC0 + SYNC1 + IDENTITY


def test_open_without_argument_opens_too() -> None:
    robot = device()
    assert robot.receive(SYNC0 + SYNC1 + SYNC2 + SYNC1, 0.0) == [SessionOpened()]


@pytest.mark.parametrize(
    "stray",
    [SYNC1, SYNC2, OPEN, CLOSE, frame(commands.Vel(0.2)), frame(commands.Enable(on=True))],
)
def test_before_the_handshake_nothing_else_is_answered_or_obeyed(stray: bytes) -> None:
    robot = device()
    assert robot.receive(stray, 0.0) == []
    assert robot.outgoing() == b""
    assert not robot.is_open


@pytest.mark.parametrize("close", [CLOSE, SYNC2])
def test_close_ends_the_session_and_the_next_one_may_begin(close: bytes) -> None:
    robot = opened()
    assert robot.receive(close, 1.0) == [SessionClosed()]
    assert not robot.is_open
    assert robot.receive(SYNC0 + SYNC1 + SYNC2 + OPEN, 1.0) == [SessionOpened()]


def test_commands_come_out_decoded() -> None:
    vel, odd = commands.Vel(0.25), encode(b"\xc8\x3b\x01\x00")
    events = opened().receive(frame(vel) + odd, 0.0)
    assert events == [Commanded(vel), Commanded(commands.from_payload(b"\xc8\x3b\x01\x00"))]


@pytest.mark.parametrize("harmless", [SYNC0, frame(commands.Pulse()), OPEN])
def test_a_pulse_or_another_open_does_nothing(harmless: bytes) -> None:
    robot = opened()
    assert robot.receive(harmless, 0.0) == []
    assert robot.is_open
    assert robot.outgoing() == b""


def test_the_watchdog_expires_once_after_its_time_and_any_packet_restarts_it() -> None:
    robot = opened()
    assert robot.tick(1.99) == []
    assert robot.tick(2.0) == [WatchdogExpired()]
    assert robot.tick(60.0) == []
    expected: list[Event] = [WatchdogFed(), Commanded(commands.Stop())]
    assert robot.receive(frame(commands.Stop()), 60.0) == expected
    assert robot.tick(61.9) == []
    assert robot.tick(62.0) == [WatchdogExpired()]


def test_bytes_that_are_no_packet_do_not_restart_the_watchdog() -> None:
    robot = opened()
    robot.receive(b"noise" + SYNC0[:-1] + b"\x07", 1.9)
    assert robot.tick(2.0) == [WatchdogExpired()]


def test_a_watchdog_of_zero_never_expires() -> None:
    assert opened(watchdog=0).tick(1e6) == []


def test_without_a_session_there_is_no_watchdog() -> None:
    assert device().tick(100.0) == []
    robot = opened()
    robot.receive(CLOSE, 0.0)
    assert robot.tick(100.0) == []


def test_closing_while_the_watchdog_holds_forgets_that() -> None:
    robot = opened()
    robot.tick(3.0)
    assert robot.receive(CLOSE, 4.0) == [WatchdogFed(), SessionClosed()]
    assert robot.receive(SYNC0, 4.0) == []


def test_reports_go_out_only_while_a_session_is_open() -> None:
    robot = device()
    robot.send(reports.Sip())
    assert robot.outgoing() == b""
    robot = opened()
    robot.send(reports.Sip())
    payloads = PacketReader().feed(robot.outgoing())
    assert [reports.from_payload(payload) for payload in payloads] == [reports.Sip()]
    assert robot.outgoing() == b""


def test_hanging_up_ends_the_session_and_forgets_half_a_frame() -> None:
    robot = opened()
    robot.receive(b"\xfa\xfb\xff", 0.0)
    robot.send(reports.Sip())
    assert robot.hang_up() == [SessionClosed()]
    assert robot.hang_up() == []
    assert robot.outgoing() == b""
    robot.receive(SYNC0, 0.0)
    assert robot.outgoing() == SYNC0
