"""The scans that the client reads: bearings, times, codes (lms2xx.md 1.8 to 1.11, 3.1, 3.2)."""

from math import inf, isnan, nan, pi, radians

import pytest

from pioneer3.lasers.client import (
    ScanSettings,
)
from pioneer3.lasers.device import MirrorTurn
from pioneer3.lasers.lms2xx import LmsClient
from pioneer3.lasers.lms2xx.measuring import MIRROR_TURN
from pioneer3.lasers.lms2xx.telegram import encode
from tests.unit.lasers.lms_support import SPEEDS, first_scan, ready, remarks


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_the_period_is_that_of_the_scans(step: float) -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS, ScanSettings(step=radians(step)))
    stamps = [first_scan(cable, client).stamp]
    for _ in range(10):
        scan = first_scan(cable, client)
        stamps.append(scan.stamp)
    assert (stamps[-1] - stamps[0]) / 10 == pytest.approx(scan.period, abs=2e-4)


def test_scans_can_be_left_out() -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS, ScanSettings(skip=3))
    first, second = first_scan(cable, client), first_scan(cable, client)
    assert second.stamp - first.stamp == pytest.approx(4 * 8 / 75, abs=2e-3)
    assert first.period == pytest.approx(4 * 8 / 75)


@pytest.mark.parametrize(("step", "turns"), [(1.0, 1), (0.5, 2), (0.25, 4)])
def test_readings_have_their_time(step: float, turns: int) -> None:
    """A wall moves; each range tells the time at which it was taken."""
    cable = ready(38400)
    start = cable.now

    def moving(turn: MirrorTurn, index: int) -> float:
        return 1.0 + cable._began + index * turn.beam_time - start

    cable.scene = moving
    edge = radians(50)
    settings = ScanSettings(step=radians(step), first=-edge, last=edge)
    scan = first_scan(cable, LmsClient(cable.now, SPEEDS, settings))
    times = [start + metres - 1.0 for metres in scan.ranges]
    errors = [scan.stamp + index * scan.beam_time - time for index, time in enumerate(times)]
    spread = (turns - 1) * MIRROR_TURN / 2
    assert max(errors) == pytest.approx(spread, abs=0.003)
    assert min(errors) == pytest.approx(-spread, abs=0.003)


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_readings_have_their_bearing(step: float) -> None:
    cable = ready(38400)
    cable.scene = lambda turn, index: 4.0 + turn.first + index * turn.step
    scan = first_scan(cable, LmsClient(cable.now, SPEEDS, ScanSettings(step=radians(step))))
    assert scan.first == pytest.approx(-pi / 2)
    bearings = [4.0 + scan.first + index * scan.step for index in range(len(scan.ranges))]
    assert scan.ranges == pytest.approx(bearings, abs=0.0006)


def test_a_part_of_the_field_is_cut_out() -> None:
    cable = ready(38400)
    cable.scene = lambda turn, index: 4.0 + turn.first + index * turn.step
    settings = ScanSettings(first=radians(-60.5), last=radians(30))
    scan = first_scan(cable, LmsClient(cable.now, SPEEDS, settings))
    assert scan.first == pytest.approx(radians(-60))
    assert len(scan.ranges) == 91
    assert scan.ranges[0] == pytest.approx(4.0 - radians(60), abs=0.0006)
    assert scan.ranges[-1] == pytest.approx(4.0 + radians(30), abs=0.0006)


def test_codes_become_inf_and_nan() -> None:
    cable = ready(38400)
    cable.scene = lambda _, index: (inf, nan, 31.0)[index % 3]
    ranges = first_scan(cable, LmsClient(cable.now, SPEEDS)).ranges
    assert ranges[0] == inf
    assert isnan(ranges[1])
    assert ranges[2] == 31.0


def test_intensities_come_where_they_are_wanted() -> None:
    cable = ready(38400)
    cable.intensity = 5.0
    assert first_scan(cable, LmsClient(cable.now, SPEEDS)).intensities == ()
    client = LmsClient(cable.now, SPEEDS, ScanSettings(intensities=True))
    scan = first_scan(cable, client)
    assert scan.intensities == (2,) * 181
    assert scan.far == pytest.approx(16.374)
    assert cable.device.unit.config.measuring_mode == 3


def test_scans_of_others_are_left_alone() -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS)
    first_scan(cable, client)
    for code, body in ((0xB7, b"\1\0\1\0\1\x40\0\0"), (0xB0, b"\3\x40\1"), (0xB0, b"\1\x40\1\0")):
        assert client.receive(encode(code, body + b"\x10", 0x80), cable.now) == []
    partial = b"\xb5\x60" + bytes(2 * 181)
    assert client.receive(encode(0xB0, partial + b"\x10", 0x80), cable.now) == []


def test_the_status_byte_is_told_when_it_changes() -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS)
    first_scan(cable, client)
    body = b"\xb5\x40" + bytes(2 * 181)
    clean, dirty = (encode(0xB0, body + bytes((status,)), 0x80) for status in (0x10, 0x93))
    told = [remarks(client.receive(data, cable.now)) for data in (clean, dirty, dirty, clean)]
    assert told[0] == told[2] == told[3] == ""
    assert "window is dirty" in told[1]
    assert "error" in told[1]
