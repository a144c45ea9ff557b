"""Scans are dated with the time of their first reading."""

from random import Random

import pytest

from pioneer3.lasers.client import ScanSettings
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.lasers.scip.timing import SETTLING, WRAP, ScipClock
from pioneer3.models.lasers import LaserModel
from tests.unit.lasers.scip_rig import URG, URG_SPEEDS, UTM, Rig

MAX_DELAY = 0.01


def jittery(device: ScipDevice, *, drift: float = 0.0, seed: int = 5) -> Rig:
    """Return a cable on which bytes are up to :data:`MAX_DELAY` late."""
    random = Random(seed)
    return Rig(device, delay=lambda: 0.0005 + MAX_DELAY * random.random() ** 2, drift=drift)


@pytest.mark.parametrize("drift", [0.0, 1e-4, -1e-4])
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("model", [URG, UTM], ids=lambda model: model.name)
def test_scans_are_dated_within_milliseconds(model: LaserModel, drift: float, seed: int) -> None:
    device = ScipDevice(model)
    rig = jittery(device, drift=drift, seed=seed)
    rig.connect(URG_SPEEDS if device.speed else ())
    rig.run(6.0)
    errors = rig.stamp_errors()
    assert len(errors) > 50
    assert max(map(abs, errors)) < 0.0025


def test_the_bytes_of_the_comparison_take_their_time_on_a_slow_line() -> None:
    rig = Rig(ScipDevice(URG))
    rig.connect([19200])
    rig.run(8.0)
    assert len(rig.scans) > 4
    assert max(map(abs, rig.stamp_errors())) < 0.002


def test_without_a_comparison_the_quickest_scan_counts() -> None:
    rig = jittery(ScipDevice(UTM))
    rig.connect(settings=ScanSettings(calibrate_time=False))
    rig.run(6.0)
    assert b"TM0\n" not in b"".join(rig.sent)
    errors = rig.stamp_errors()
    assert min(errors) > -0.001
    assert max(errors) < MAX_DELAY
    assert max(errors[100:]) < 0.004


def test_a_part_of_the_field_is_dated_with_its_own_first_reading() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect(settings=ScanSettings(first=0.0))
    rig.run(1.0)
    turn = rig.turns[len(rig.turns) - 2]
    ahead = 540 * 60 / (2400 * 1440)
    assert min(abs(scan.stamp - turn - ahead) for scan in rig.scans) < 0.001
    assert rig.scans[0].beam_time == pytest.approx(60 / (2400 * 1440))


def test_a_slow_line_is_told_in_the_period() -> None:
    rig = Rig(ScipDevice(URG))
    rig.connect([19200])
    rig.run(8.0)
    assert rig.scans[-1].period == pytest.approx(1.2, abs=0.11)


def test_the_clock_wraps_in_mid_stream() -> None:
    device = ScipDevice(UTM)
    rig = Rig(device)
    device.unit.reset(rig.now - WRAP / 1000 + 2.0)  # it wraps in two seconds
    rig.connect()
    rig.run(4.0)
    times = [scan.device_time or 0.0 for scan in rig.scans]
    assert times[0] < WRAP / 1000 < times[-1]
    assert times == sorted(times)
    assert max(map(abs, rig.stamp_errors())) < 0.002


def test_the_clock_wraps_between_comparison_and_scan() -> None:
    clock = ScipClock()
    clock.compare(WRAP - 10, 5.0, 5.002)
    assert clock.our_time(10, None, 0.0) == pytest.approx(5.021, abs=0.001)


def test_the_shortest_round_trip_counts() -> None:
    clock = ScipClock()
    clock.compare(1000, 10.0, 10.2)
    clock.compare(2000, 11.0, 11.002)
    clock.compare(3000, 12.0, 12.3)
    assert clock.our_time(4000, None, 0.0) == pytest.approx(13.001, abs=0.001)


def test_without_any_source_there_is_no_date() -> None:
    assert ScipClock().our_time(1000, None, 0.0) is None


def test_drift_is_followed_for_hours() -> None:
    clock, drift = ScipClock(), 5e-5
    clock.compare(0, 0.0, 0.001)
    for second in range(4 * 3600):
        ours = second * (1 + drift)
        dated = clock.our_time(second * 1000 % WRAP, ours + 0.02, 0.02)
        assert dated is not None
        if second > SETTLING + 1:
            assert dated == pytest.approx(ours, abs=0.002)
