"""Reports reach everybody they interest, and nobody holds up the others."""

import logging

import pytest

from pioneer3.arcos.reports import Encoders, Io, Report
from pioneer3.robot.reports import Reports

IO = Io((), (), ())


def counts(number: int) -> Encoders:
    return Encoders(number, 0)


async def test_a_reader_gets_its_kind_in_order() -> None:
    hub = Reports()
    with hub.subscribe(Encoders) as heard:
        for number in range(3):
            hub.publish(counts(number), 0.0)
            hub.publish(IO, 0.0)
        hub.close()
        assert [report.left_counts async for report in heard] == [0, 1, 2]


async def test_who_is_too_slow_misses_the_oldest_and_can_see_it() -> None:
    hub = Reports()
    with hub.subscribe(Encoders, room=2) as slow, hub.subscribe(Encoders) as other:
        for number in range(5):
            hub.publish(counts(number), 0.0)
        hub.close()
        assert [report.left_counts async for report in slow] == [3, 4]
        assert slow.missed == 3
        assert len([report async for report in other]) == 5


async def test_nothing_is_kept_for_who_has_left() -> None:
    hub = Reports()
    with hub.subscribe(Encoders) as heard:
        pass
    hub.publish(counts(1), 0.0)
    hub.close()
    heard.close()
    assert [report async for report in heard] == []


async def test_a_subscription_after_the_end_ends_at_once() -> None:
    hub = Reports()
    hub.close()
    with hub.subscribe(Encoders) as heard:
        assert [report async for report in heard] == []


def test_one_that_fails_is_logged_and_the_others_get_theirs(
    caplog: pytest.LogCaptureFixture,
) -> None:
    hub, got = Reports(), []

    def fail(report: Report, stamp: float) -> None:
        raise ZeroDivisionError

    hub.hand_to(fail, Io)
    end = hub.hand_to(lambda report, stamp: got.append((report, stamp)), Io)
    with caplog.at_level(logging.ERROR):
        hub.publish(IO, 1.5)
    assert got == [(IO, 1.5)]
    assert "a subscriber failed on Io" in caplog.text
    end()
    hub.publish(IO, 2.0)
    assert len(got) == 1
