"""When ticks are due."""

from math import inf, nan

import pytest

from pioneer3.errors import ConfigError
from pioneer3.sim.server.pacer import LATE, TICK, Pacer


def ticks(pace: Pacer, seconds: float, *, work: float = 0.0, start: float = 100.0) -> int:
    """Return how many ticks happen within `seconds`, each of which takes `work` [s]."""
    now, count, end = start, 0, start + seconds
    while now < end - 1e-9:
        wait = pace.wait(now)
        if wait == inf:
            break
        if wait == 0:
            pace.passed(now)
            count += 1
            now += work or 1e-6
        else:
            now += wait
    pace.wait(now)
    return count


@pytest.mark.parametrize(("speed", "expected"), [(1, 50), (10, 500), (0.1, 5), (2.5, 125)])
def test_ticks_come_at_the_speed_that_is_asked_for(speed: float, expected: int) -> None:
    pace = Pacer(speed)
    assert ticks(pace, 1.0) == pytest.approx(expected, abs=1)
    assert ticks(pace, 1.0, start=101.0) == pytest.approx(expected, abs=1)
    assert pace.real_time_factor == pytest.approx(speed, rel=0.05)


def test_as_fast_as_possible_waits_for_nothing() -> None:
    pace = Pacer(inf)
    assert ticks(pace, 1.0, work=0.001) == 1000
    assert pace.real_time_factor == pytest.approx(20, rel=0.01)


def test_timers_that_fire_a_little_early_are_taken_for_due() -> None:
    pace = Pacer()
    assert pace.wait(5.0) == 0
    pace.passed(5.0)
    assert pace.wait(5.0 + TICK - 1e-4) == 0
    assert pace.wait(5.0 + TICK / 2) == pytest.approx(TICK / 2)


def test_a_short_delay_is_made_up_for_and_a_long_one_is_not() -> None:
    pace = Pacer()
    assert ticks(pace, 1.0, start=0.0) == 50
    assert ticks(pace, 0.02, start=1.2) == pytest.approx(11, abs=1)  # 0.2 s late
    assert ticks(pace, 0.02, start=100.0) == pytest.approx(LATE / TICK, abs=2)


def test_a_machine_that_is_too_slow_falls_behind_steadily() -> None:
    pace = Pacer(10)
    assert ticks(pace, 10.0, work=0.005) == 2000
    assert pace.real_time_factor == pytest.approx(4, rel=0.02)


def test_a_new_speed_begins_now() -> None:
    pace = Pacer(inf)
    ticks(pace, 1.0, work=0.001)
    pace.speed = 1
    assert ticks(pace, 1.0, start=101.0) == pytest.approx(50, abs=1)


def test_no_time_passes_in_a_pause_and_none_is_made_up_for() -> None:
    pace = Pacer()
    ticks(pace, 1.0)
    pace.pause()
    assert pace.paused
    assert ticks(pace, 1.0, start=101.0) == 0
    pace.wait(103.0)
    assert pace.real_time_factor == 0
    pace.resume()
    assert ticks(pace, 1.0, start=160.0) == pytest.approx(50, abs=1)


@pytest.mark.parametrize(("seconds", "expected"), [(0.02, 1), (0.1, 5), (0.001, 1), (10.0, 500)])
def test_a_step_passes_at_once_and_then_time_stands_still(seconds: float, expected: int) -> None:
    pace = Pacer(paused=True)
    pace.step(seconds)
    assert ticks(pace, 0.5) == expected
    pace.step(seconds)
    pace.step(seconds)
    assert ticks(pace, 0.5, start=200.0) == 2 * expected


def test_a_step_of_a_running_simulation_pauses_it() -> None:
    pace = Pacer()
    ticks(pace, 1.0)
    pace.step()
    assert pace.paused
    assert ticks(pace, 1.0, start=101.0) == 1


def test_what_was_left_of_a_step_is_forgotten_when_time_runs_again() -> None:
    pace = Pacer(paused=True)
    pace.step(10)
    pace.resume()
    pace.pause()
    assert pace.wait(1.0) == inf


@pytest.mark.parametrize("speed", [0.0, -1.0, nan, -inf])
def test_a_speed_is_above_zero(speed: float) -> None:
    pace = Pacer(3)
    with pytest.raises(ConfigError, match="not above 0"):
        Pacer(speed)
    with pytest.raises(ConfigError, match="not above 0"):
        pace.speed = speed
    assert pace.speed == 3


@pytest.mark.parametrize("seconds", [0.0, -1.0, nan, inf])
def test_a_step_is_a_time(seconds: float) -> None:
    with pytest.raises(ConfigError, match="not a time"):
        Pacer().step(seconds)


def test_hosts_keep_their_seconds_above_real_time() -> None:
    assert [Pacer(speed).watchdog_factor for speed in (0.1, 1, 10, inf)] == [1, 1, 10, inf]
    assert Pacer(10, lock_step=True).watchdog_factor == 1


def test_a_tick_that_was_held_back_is_not_made_up_for() -> None:
    pace = Pacer()
    ticks(pace, 1.0, start=0.0)
    pace.postpone(1.3)
    assert ticks(pace, 0.1, start=1.3) == pytest.approx(5, abs=1)


def test_between_ticks_time_passes_at_the_speed_that_is_asked_for() -> None:
    pace = Pacer(0.5)
    assert pace.elapsed(7.0) == 0.0
    pace.wait(7.0)
    pace.passed(7.0)
    assert [pace.elapsed(7.0 + later) for later in (0.0, 0.01, 0.04, 5.0, -1.0)] == pytest.approx(
        [0.0, 0.005, TICK, TICK, 0.0]
    )


@pytest.mark.parametrize("pace", [Pacer(inf), Pacer(lock_step=True), Pacer(paused=True)])
def test_where_time_goes_in_whole_ticks_none_passes_between_them(pace: Pacer) -> None:
    pace.wait(7.0)
    pace.passed(7.0)
    assert not pace.steady
    assert pace.elapsed(7.015) == 0.0
