"""The host's side of a session, packet by packet and second by second."""

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.host import Host
from pioneer3.arcos.host_events import (
    Configured,
    Event,
    Lost,
    Opened,
    ReportReceived,
    SessionState,
    SpeedWanted,
    Timing,
)
from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import Report
from pioneer3.errors import CommandError
from pioneer3.state import Identity
from tests.support import decoded, frame

LISTEN, RETRY = Timing().listen, Timing().retry
STOP, CLOSE = frame(commands.Stop()), frame(commands.Close())
SYNC = [encode(bytes([number])) for number in (0, 1, 2)]
WHO = encode(b"\x02Robot\0Pioneer\0P3AT-SH\0")
IDENTITY = Identity(name="Robot", family="Pioneer", model="p3at-sh")
CONFIG = reports.Config(family="Pioneer", model="P3AT-SH", serial_number="1")
SIP = reports.Sip()


def wire(report: Report) -> bytes:
    return encode(reports.to_payload(report))


def spoilt(data: bytes) -> bytes:
    return data[:-1] + bytes([data[-1] ^ 1])


def listened(now: float = 0.0) -> Host:
    """Return a host that heard nothing, and has just sent its first SYNC0."""
    host = Host(now - LISTEN)
    host.tick(now - LISTEN)
    host.tick(now)
    return host


def opened(now: float = 0.0) -> Host:
    """Return a host that has just sent what follows the handshake."""
    host = listened(now)
    for answer in (SYNC[0], SYNC[1]):
        assert host.receive(answer, now) == []
    assert host.receive(WHO, now) == [Opened(IDENTITY)]
    return host


def configured(now: float = 0.0) -> Host:
    host = opened(now)
    host.outgoing()
    assert host.receive(wire(CONFIG), now) == [Configured(CONFIG)]
    return host


def closed(host: Host) -> bool:
    return host.state is SessionState.CLOSED


def later(host: Host, until: float) -> list[Event]:
    """Let the host act at each of its deadlines up to `until`."""
    events: list[Event] = []
    while host.deadline <= until and not closed(host):
        due = host.deadline
        events += host.tick(due)
        assert host.deadline > due or closed(host)
    return events


def test_a_handshake_is_three_questions_to_a_robot_that_was_silent() -> None:
    host = Host(0.0)
    host.tick(0.0)
    host.tick(0.19)
    assert host.outgoing() == b""
    host.tick(0.2)
    assert host.outgoing() == SYNC[0]
    host.receive(SYNC[0], 0.0)
    assert host.outgoing() == SYNC[1]
    host.receive(SYNC[1], 0.0)
    assert host.outgoing() == SYNC[2]
    assert host.receive(WHO, 0.1) == [Opened(IDENTITY)]
    assert host.state is SessionState.OPEN
    assert host.identity == IDENTITY


def test_after_open_come_stop_and_motors_off_before_anything_else() -> None:
    host = listened()
    for answer in (SYNC[0], SYNC[1]):
        host.receive(answer, 0.0)
    host.outgoing()
    host.receive(WHO, 0.0)
    expected: list[Command] = [
        commands.Open(),
        commands.Stop(),
        commands.Enable(on=False),
        commands.RequestConfig(),
    ]
    assert decoded(host.outgoing()) == expected


@pytest.mark.parametrize("answers", [0, 1, 2])
def test_silence_in_the_handshake_begins_it_anew(answers: int) -> None:
    host = listened()
    for answer in SYNC[:answers]:
        host.receive(answer, 0.0)
    host.outgoing()
    host.tick(0.39)
    assert host.outgoing() == b""
    host.tick(0.4)
    assert host.outgoing() == SYNC[0]
    assert host.state is SessionState.SYNC0


@pytest.mark.parametrize("stray", [SYNC[1], SYNC[2], WHO, encode(b"\xff"), encode(b"\x90\1\2")])
def test_late_mail_is_ignored_in_the_handshake(stray: bytes) -> None:
    host = listened()
    host.outgoing()
    assert host.receive(stray, 0.0) == []
    assert host.state is SessionState.SYNC0
    assert host.outgoing() == b""


def test_each_speed_gets_two_tries_in_turn() -> None:
    host = Host(0.0, speeds=(9600, 38400))
    assert host.speed == 9600
    wanted = [event.baud for event in later(host, 4.3) if isinstance(event, SpeedWanted)]
    assert wanted == [9600, 38400, 9600, 38400, 9600]
    assert host.outgoing() == (SYNC[0] + STOP + SYNC[0]) * 4 + SYNC[0]


def test_a_link_without_speeds_is_asked_for_none() -> None:
    host = Host(0.0)
    assert host.speed is None
    assert later(host, 5.0) == []


@pytest.mark.parametrize(
    ("speeds", "noise", "reason"),
    [
        ((), b"", "nothing answers"),
        ((38400, 9600), b"", "nothing answers at 9600, 38400 baud"),
        ((), b"login: ", "something answers, but not as a Pioneer robot does"),
    ],
)
def test_giving_up_says_what_was_heard(speeds: tuple[int, ...], noise: bytes, reason: str) -> None:
    host = Host(0.0, speeds=speeds)
    host.receive(noise, 0.0)
    assert later(host, 20.0)[-1] == Lost(reason)
    assert host.state is SessionState.CLOSED
    assert host.tick(30.0) == []


@pytest.mark.parametrize("number", [0x32, 0x33])
def test_a_robot_still_in_a_session_is_stopped_closed_and_left_to_fall_silent(number: int) -> None:
    host, sip = Host(0.0), wire(reports.Sip(number=number))
    host.tick(0.0)
    host.receive(sip, 0.05)
    assert host.outgoing() == STOP + CLOSE
    host.receive(sip, 0.10)
    assert host.outgoing() == b""  # not for every report
    host.receive(sip, 0.16)
    assert host.outgoing() == STOP + CLOSE  # the first one may have been lost
    host.tick(0.35)
    assert host.outgoing() == b""
    host.tick(0.36)
    assert host.outgoing() == STOP + SYNC[0]


def test_a_robot_that_reports_while_the_host_listens_hears_stop_and_close_first() -> None:
    host = Host(0.0)
    host.tick(0.0)
    host.receive(wire(SIP), 0.1)
    assert host.outgoing() == STOP + CLOSE
    host.tick(0.31)
    assert host.outgoing() == STOP + SYNC[0]


def test_a_report_that_has_begun_is_heard_out() -> None:
    host, sip = Host(0.0), wire(SIP)
    host.tick(0.0)
    host.receive(sip[:5], 0.19)
    host.tick(0.2)
    assert host.outgoing() == b""
    host.receive(sip[5:], 0.25)
    assert host.outgoing() == STOP + CLOSE


@pytest.mark.parametrize("heard", [b"\x91\x00", spoilt(wire(SIP)), encode(b"\xff")])
def test_whoever_was_heard_hears_a_stop_before_every_sync0(heard: bytes) -> None:
    host = Host(0.0)
    host.tick(0.0)
    host.receive(heard, 0.1)
    later(host, 0.4)
    assert host.outgoing() == STOP + SYNC[0]


def test_at_a_speed_that_gives_noise_nothing_is_sent_before_all_have_been_listened_to() -> None:
    host = Host(0.0, speeds=(9600, 38400))
    host.tick(0.0)
    host.receive(b"\x91\x00", 0.1)
    assert later(host, 0.35) == [SpeedWanted(38400)]
    host.receive(b"\x91\x00", 0.4)
    assert later(host, 0.65) == [SpeedWanted(9600)]
    assert host.outgoing() == b""
    host.receive(b"\x91\x00", 0.7)
    assert later(host, 0.95) == []
    assert host.outgoing() == STOP + SYNC[0]


def test_at_a_speed_that_gives_spoilt_packets_the_robot_is_asked_at_once() -> None:
    host = Host(0.0, speeds=(9600, 38400))
    host.tick(0.0)
    host.receive(spoilt(wire(SIP)), 0.1)
    assert later(host, 0.35) == []
    assert host.outgoing() == STOP + SYNC[0]


def test_over_a_network_the_third_sync0_in_vain_follows_a_stop() -> None:
    host = listened()
    later(host, 1.21)
    assert host.outgoing() == SYNC[0] + SYNC[0] + STOP + SYNC[0]  # at 0, 0.4 and 1.2 s


def test_what_the_network_needs_is_waited_for_besides() -> None:
    host = Host(0.0, round_trip=0.6)
    later(host, 0.7)
    assert host.outgoing() == b""
    later(host, 0.8)
    assert host.outgoing() == SYNC[0]
    later(host, 1.7)
    assert host.outgoing() == b""


def test_a_robot_that_streams_and_does_not_listen_is_given_up() -> None:
    host = Host(0.0)
    host.tick(0.0)
    events: list[Event] = []
    for cycle in range(1, 200):
        events += host.receive(wire(SIP), cycle * 0.1)
        events += host.tick(cycle * 0.1)
    assert events == [Lost("the robot sends, but does not receive: its receive line is dead")]


def test_dislodging_keeps_the_speed_that_the_robot_answers_at() -> None:
    host = Host(0.0, speeds=(9600, 38400))
    later(host, 1.3)
    assert host.speed == 38400
    host.receive(wire(SIP), 1.3)
    host.tick(1.7)
    assert host.speed == 38400


def test_config_is_announced_once_and_kept() -> None:
    host = opened()
    assert not host.config_settled
    assert host.receive(wire(CONFIG), 0.1) == [Configured(CONFIG)]
    assert host.config is CONFIG or host.config == CONFIG
    assert host.config_settled
    assert host.receive(wire(CONFIG), 0.2) == [ReportReceived(CONFIG)]


def test_config_is_asked_for_again_and_then_done_without() -> None:
    host = opened()
    host.outgoing()
    for tenth in range(1, 15):
        later(host, tenth / 10)
        assert host.receive(wire(SIP), tenth / 10) == [ReportReceived(SIP)]
    later(host, 1.49)
    assert host.receive(wire(SIP), 1.5) == [Configured(None), ReportReceived(SIP)]
    sent = decoded(host.outgoing())
    assert sent.count(commands.RequestConfig()) == 5  # at 0.25, 0.5, 0.75, 1.0, 1.25
    assert host.config is None
    assert host.config_settled


def test_a_program_that_is_held_up_waits_for_config_all_the_same() -> None:
    host = opened()
    host.receive(wire(SIP), 0.1)
    later(host, 1.9)
    assert host.receive(wire(SIP) + wire(CONFIG), 1.9)[1:] == [Configured(CONFIG)]


def test_an_open_that_was_perhaps_lost_is_repeated_until_a_report_comes() -> None:
    host = opened()
    host.outgoing()
    host.tick(0.25)
    assert decoded(host.outgoing()) == [commands.Open(), commands.RequestConfig()]
    host.receive(wire(SIP), 0.3)
    host.tick(0.5)
    assert decoded(host.outgoing()) == [commands.RequestConfig()]


def test_a_spoilt_config_is_asked_for_at_once_and_believed_when_it_comes_alike() -> None:
    host = opened()
    host.outgoing()
    assert host.receive(spoilt(wire(CONFIG)), 0.1) == []
    assert host.deadline == 0.1
    host.tick(0.1)
    assert commands.RequestConfig() in decoded(host.outgoing())
    assert host.receive(spoilt(wire(CONFIG)), 0.2) == [Configured(CONFIG, trusted=False)]


def test_a_spoilt_config_of_somebody_else_is_never_believed() -> None:
    other = reports.Config(family="Pioneer", model="p3dx-sh", serial_number="1")
    host = opened()
    for _ in range(5):
        assert host.receive(spoilt(wire(other)), 0.1) == []
        assert host.receive(spoilt(wire(SIP)), 0.1) == []


def test_spoilt_configs_that_differ_are_not_believed_and_do_not_flood_the_line() -> None:
    host = opened()
    host.outgoing()
    for serial in range(20):
        config = reports.Config(family="Pioneer", model="p3at-sh", serial_number=str(serial))
        assert host.receive(spoilt(wire(config)), 0.1) == []
        host.tick(0.1)
    assert decoded(host.outgoing()).count(commands.RequestConfig()) == 1


def test_a_sound_config_after_a_spoilt_one_is_trusted() -> None:
    host = opened()
    host.receive(spoilt(wire(CONFIG)), 0.1)
    assert host.receive(wire(CONFIG), 0.2) == [Configured(CONFIG)]


def test_reports_are_handed_on() -> None:
    io = reports.from_payload(b"\x90" + bytes(8))
    assert configured().receive(wire(SIP) + wire(io), 0.1) == [
        ReportReceived(SIP),
        ReportReceived(io),
    ]


def test_a_quiet_host_pulses_with_a_report_before_a_pulse_alone_is_due() -> None:
    host = configured()
    host.outgoing()
    sent = b""
    for tenth in range(1, 21):
        host.receive(wire(SIP), tenth / 10)
        assert host.deadline > tenth / 10 + 0.1
        sent += host.outgoing()
    assert decoded(sent) == [commands.Pulse()] * 5


def test_a_quiet_host_pulses_twice_a_second_without_reports() -> None:
    host = configured()
    host.outgoing()
    sent = b""
    for tenth in range(1, 20):
        host.tick(tenth / 10)
        sent += host.outgoing()
    assert decoded(sent) == [commands.Pulse()] * 3


def test_pulses_do_not_queue_up_for_a_link_that_takes_nothing() -> None:
    host = configured()
    host.outgoing()
    for tenth in range(1, 51):
        host.receive(wire(SIP), tenth / 10)
        host.tick(tenth / 10)
    assert decoded(host.outgoing()) == [commands.Pulse()]


def test_a_command_takes_the_place_of_a_pulse() -> None:
    host = configured()
    host.outgoing()
    host.send(commands.Vel(0.2), 0.4)
    host.tick(0.6)
    assert decoded(host.outgoing()) == [commands.Vel(0.2)]
    host.tick(0.9)
    assert decoded(host.outgoing()) == [commands.Pulse()]


def test_time_in_which_nobody_listened_is_no_silence() -> None:
    host = configured()
    host.receive(wire(SIP), 0.5)
    host.tick(0.5)
    host.held_up(3.0)
    assert not any(isinstance(event, Lost) for event in later(host, 5.49))
    assert isinstance(later(host, 5.51)[-1], Lost)


def test_a_handshake_that_was_held_up_asks_again_only_after_its_patience() -> None:
    host = listened()
    host.outgoing()
    host.held_up(20.0)
    assert host.tick(20.39) == []
    assert host.outgoing() == b""
    host.receive(SYNC[0], 20.39)
    assert host.outgoing() == SYNC[1]


def test_two_seconds_without_a_report_are_a_lost_session() -> None:
    host = configured()
    host.receive(wire(SIP), 1.0)
    assert later(host, 2.99) == []
    assert later(host, 3.0) == [Lost("the robot has said nothing for 2 s")]
    assert host.receive(wire(SIP), 3.1) == []


def test_other_reports_do_not_hide_that_the_robot_is_lost() -> None:
    host = configured()
    for tenth in range(1, 20):
        host.receive(wire(CONFIG), tenth / 10)
    assert later(host, 2.0) == [Lost("the robot has said nothing for 2 s")]


@pytest.mark.parametrize("number", [0xFE, 0xFF])
def test_a_robot_may_end_the_session(number: int) -> None:
    host = configured()
    events = host.receive(encode(bytes([number])) + wire(SIP), 0.1)
    assert events == [Lost("the robot ended the session")]


def test_patience_is_a_parameter() -> None:
    host = Host(0.0, timing=Timing(retry=0.1, give_up=0.5))
    assert later(host, 1.0) == [Lost("nothing answers")]
    assert host.outgoing().count(SYNC[0]) == 2  # at 0.2 and 0.3 s


def test_without_a_session_commands_are_refused() -> None:
    host = Host(0.0)
    with pytest.raises(CommandError, match="cannot send Vel: no session is open"):
        host.send(commands.Vel(0.1), 0.0)
    host = configured()
    host.leave(0.1)
    with pytest.raises(CommandError, match="no session is open"):
        host.send(commands.Vel(0.1), 0.2)


@pytest.mark.parametrize("host", [Host(0.0), opened(), configured()], ids=["new", "open", "ready"])
def test_leaving_stops_switches_off_and_closes_whatever_the_state(host: Host) -> None:
    host.outgoing()
    host.leave(0.1)
    farewell: list[Command] = [
        commands.Stop(),
        commands.Enable(on=False),
        commands.Sonar(on=False),
        commands.Close(),
    ]
    assert decoded(host.outgoing()) == farewell
    host.leave(0.2)
    assert host.outgoing() == b""


def test_ticking_too_often_does_no_harm() -> None:
    host = Host(0.0)
    for _ in range(100):
        host.tick(0.0)
        host.tick(LISTEN)
    assert host.outgoing() == SYNC[0]


def test_a_tick_that_comes_early_by_a_rounding_error_is_in_time() -> None:
    host = configured()
    host.receive(wire(SIP), 0.1)
    later(host, 0.3)
    host.outgoing()
    due = host.deadline
    host.tick(due - 1e-12)
    assert decoded(host.outgoing()) == [commands.Pulse()]
    assert host.deadline > due
