"""What a robot is to go on sending, over sessions and lost frames."""

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode
from pioneer3.errors import CommandError
from pioneer3.robot.report_requests import RENEW, ReportRequest, ReportRequests

ON, OFF = commands.IoRequest(RequestMode.STREAM), commands.IoRequest(RequestMode.STOP)
IO = ReportRequest(begin=(ON,), end=(OFF,), answers=(reports.Io,))
PACKET = reports.Io((), (), ())


def opened() -> ReportRequests:
    requests = ReportRequests()
    requests.session_opened(0.0)
    return requests


def test_it_is_asked_for_once_however_many_want_it() -> None:
    requests = opened()
    requests.want("io", IO, 0.0)
    requests.want("io", IO, 0.0)
    assert requests.outgoing() == [ON]
    requests.release("io")
    assert requests.outgoing() == []
    requests.release("io")
    assert requests.outgoing() == [OFF]


def test_without_a_session_it_waits_for_one() -> None:
    requests = ReportRequests()
    requests.want("io", IO, 0.0)
    assert requests.outgoing() == []
    requests.session_opened(1.0)
    assert requests.outgoing() == [ON]


def test_what_was_not_sent_before_a_loss_never_is() -> None:
    requests = opened()
    requests.want("io", IO, 0.0)
    requests.release("io")
    requests.session_lost()
    requests.session_opened(1.0)
    assert requests.outgoing() == []


def test_silence_is_asked_again_and_a_report_ends_the_silence() -> None:
    requests = opened()
    requests.want("io", IO, 0.0)
    requests.outgoing()
    requests.tick(RENEW - 0.1)
    assert requests.outgoing() == []
    requests.received(PACKET, RENEW - 0.1)
    requests.tick(RENEW + 0.1)
    assert requests.outgoing() == []
    requests.tick(2 * RENEW)
    assert requests.outgoing() == [ON]


def test_what_brings_no_answer_is_not_asked_again() -> None:
    requests = opened()
    requests.want("io", ReportRequest(begin=(ON,), end=(OFF,)), 0.0)
    requests.outgoing()
    requests.tick(100.0)
    assert requests.outgoing() == []


def test_another_way_of_asking_lasts_as_long_as_it_is_wanted() -> None:
    once = commands.IoRequest(RequestMode.ONCE)
    requests = opened()
    requests.change("io", ReportRequest(begin=(once,), end=(OFF,)), 0.0)
    assert requests.outgoing() == []
    requests.want("io", IO, 0.0)
    requests.change("io", ReportRequest(begin=(once,), end=(OFF,)), 0.0)
    requests.session_lost()
    requests.session_opened(1.0)
    assert requests.outgoing() == [once]


def test_what_does_not_fit_the_protocol_is_refused_at_once() -> None:
    with pytest.raises(CommandError):
        ReportRequest(begin=(commands.DigOut(mask=256, values=0),), end=())


def test_the_farewell_ends_all_that_is_wanted() -> None:
    requests = opened()
    assert requests.end_commands() == []
    requests.want("io", IO, 0.0)
    assert requests.end_commands() == [OFF]
