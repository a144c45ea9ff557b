"""The sending half of a line."""

from math import inf

import pytest

from pioneer3.lasers.clock import Envelope
from pioneer3.lasers.line import PIECE, SerialLine, duration


def test_bytes_leave_at_the_speed_of_the_line() -> None:
    line = SerialLine(9600)
    line.send(b"0123456789", 5.0)
    assert line.take(5.0) == b""
    assert line.take(5.0 + duration(3, 9600)) == b"012"
    assert line.waiting == 7
    assert line.take(6.0) == b"3456789"
    assert (line.waiting, line.due) == (0, inf)


def test_an_idle_line_saves_no_time_up() -> None:
    line = SerialLine(9600)
    line.send(b"a", 1.0)
    assert line.take(2.0) == b"a"
    line.send(b"b", 3.0)
    assert line.due == pytest.approx(3.0 + duration(1, 9600))


def test_a_new_speed_holds_when_the_bytes_before_it_have_left() -> None:
    line = SerialLine(9600)
    line.send(b"old", 0.0)
    line.then_change_to(38400)
    line.send(b"new", 0.0)
    assert line.free_at == pytest.approx(duration(3, 9600) + duration(3, 38400))
    assert (line.take(1.0), line.speed) == (b"old", 38400)
    assert line.take(1.0) == b"new"


def test_a_change_of_the_speed_outlives_the_bytes_that_are_dropped() -> None:
    line = SerialLine(9600)
    line.send(b"old", 0.0)
    line.then_change_to(38400)
    line.drop()
    line.send(b"new", 0.0)
    assert (line.take(1.0), line.speed, line.waiting) == (b"", 38400, 3)
    assert line.take(1.0) == b"new"


def test_a_network_takes_all_at_once() -> None:
    line = SerialLine(None)
    line.send(b"x" * 100_000, 7.0)
    assert line.due == line.free_at == 7.0
    assert len(line.take(7.0)) == 100_000


@pytest.mark.parametrize(("speed", "piece"), [(9600, PIECE), (500_000, 100)])
def test_a_wake_up_is_worth_some_bytes(speed: int, piece: int) -> None:
    line = SerialLine(speed)
    line.send(bytes(1000), 0.0)
    assert line.due == pytest.approx(duration(piece, speed))
    assert len(line.take(line.due)) == piece


def test_what_is_forgotten_never_leaves() -> None:
    line = SerialLine(9600)
    line.send(b"abc", 0.0)
    line.then_change_to(38400)
    line.clear(19200)
    assert (line.take(1.0), line.speed, line.waiting, line.due) == (b"", 19200, 0, inf)


def test_the_quickest_arrival_counts_until_clocks_have_drifted() -> None:
    envelope = Envelope(drift=1e-3)
    assert envelope.follow(0.5, 10.0) == 0.5
    assert envelope.follow(0.9, 20.0) == pytest.approx(0.51)
    assert envelope.follow(0.4, 21.0) == 0.4
    assert (envelope.lag, envelope.at) == (0.4, 21.0)
