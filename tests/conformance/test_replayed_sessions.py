"""Our simulated robot answers as the old emulator did, but for the latter's faults.

Real ARIA programs drove the old emulator; the bytes of each are played to our robot, open loop, at
the same place of the same map. :mod:`test_replayed_motion` compares how both moved.
"""

from pathlib import Path

import numpy as np
import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.reports import BatteryInfo, Config, Io, SyncEcho, SyncIdentity
from pioneer3.geometry import Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.world import World
from tests.conformance.old_emulator import BEAM_STEP
from tests.conformance.replay import (
    CAPTURES,
    CYCLE,
    MAP,
    MODEL,
    START,
    Float,
    Session,
    capture,
    captured,
    pair,
    played,
    said,
    the_map,
)

pytestmark = pytest.mark.skipif(
    not (CAPTURES and MAP.exists()), reason="no captures or no maps beside this checkout"
)


each = pytest.mark.parametrize(
    "path", CAPTURES, ids=[path.stem.removeprefix("aria291-") for path in CAPTURES]
)
scanned = pytest.mark.parametrize(
    "path", [capture(name) for name in ("demo", "laserConnect", "wander")], ids=lambda p: p.stem
)

BUSY = "demo"
"""The machine that ran this one was busy; pauses between reports reach half a second."""


@each
def test_the_handshake_is_the_same_byte_for_byte(path: Path) -> None:
    theirs, ours = captured(path), played(path)
    answers = [report for _, report in theirs.answers[:3]]
    assert answers == [SyncEcho(0), SyncEcho(1), SyncIdentity("AMRISim", "Pioneer", "p3at")]
    assert [report for _, report in ours.answers[:3]] == answers


@each
def test_the_configuration_comes_once_within_a_cycle_of_being_asked_for(path: Path) -> None:
    asked = [time for time, order in said(path) if isinstance(order, commands.RequestConfig)]
    for session in (captured(path), played(path)):
        told = [time for time, report in session.answers if isinstance(report, Config)]
        assert len(told) == len(asked) == 1
        assert asked[0] <= told[0] <= asked[0] + CYCLE


@each
def test_a_report_comes_every_cycle_of_the_session(path: Path) -> None:
    theirs, ours = captured(path).sips, played(path).sips
    owed = (theirs[-1][0] - theirs[0][0]) / CYCLE + 1
    assert len(ours) == pytest.approx(owed, abs=2)
    if path != capture(BUSY):
        assert len(theirs) == pytest.approx(owed, abs=2)


@each
def test_both_send_as_many_reports_in_the_old_emulators_own_time(path: Path) -> None:
    # 9.2: each of its reports is one cycle of its time, however late the machine lets it be
    both = pair(path)
    assert len(both.ours.sips) == pytest.approx(len(both.theirs.sips), abs=2)


@scanned
def test_each_report_is_followed_by_the_packets_of_one_whole_sweep(path: Path) -> None:
    both = pair(path)
    for session in (both.theirs, both.ours):
        for sweep in session.sweeps:
            assert [packet.first for packet in sweep] == [0, 32, 64, 96, 128, 160]
            assert [len(packet.readings) for packet in sweep] == [32] * 5 + [21]
            assert {packet.total for packet in sweep} == {181}
    # the old emulator begins two or three cycles after it has been asked (9.2)
    assert 0 <= len(both.ours.sweeps) - len(both.theirs.sweeps) <= 3


@each
def test_after_a_report_come_the_same_packets_in_the_same_order(path: Path) -> None:
    both = pair(path)
    assert _kinds_per_cycle(both.ours) == _kinds_per_cycle(both.theirs)


def _kinds_per_cycle(session: Session) -> list[tuple[type[reports.Report], ...]]:
    """The different sets of packets that follow a report, in order of their first appearance."""
    answers_to_requests = {Config, BatteryInfo, Io}
    seen: dict[tuple[type[reports.Report], ...], None] = {}
    for cycle in session.cycles:
        seen[tuple(type(report) for report in cycle if type(report) not in answers_to_requests)] = (
            None
        )
    return list(seen)


@each
def test_only_what_was_asked_for_comes_besides(path: Path) -> None:
    # 9.6: the old emulator ignores BATTERYINFO, IOREQUEST and JOYINFO; ours has no joystick either
    both = pair(path)
    besides = both.ours.kinds.keys() - both.theirs.kinds.keys()
    asked = {type(order) for _, order in said(path)}
    answers = {commands.RequestBatteryInfo: BatteryInfo, commands.IoRequest: Io}
    assert besides == {answer for request, answer in answers.items() if request in asked}
    assert both.ours.kinds[BatteryInfo] == 1


@each
def test_the_sonars_say_the_same_at_the_start(path: Path) -> None:
    (_, first), *_ = pair(path).theirs.sips
    (_, ours), *_ = pair(path).ours.sips
    assert [s.number for s in ours.sonar] == [s.number for s in first.sonar]
    assert [s.range_raw for s in ours.sonar] == pytest.approx(
        [s.range_raw for s in first.sonar], abs=30
    )


@each
def test_the_sonars_say_the_same_wherever_it_went(path: Path) -> None:
    apart_mm = np.abs(_sonar_of_the_map(path) - _sonar_heard(path))
    assert np.median(apart_mm) < 10
    # the rest looks past edges: a heading in whole degrees (4.9) moves a beam by 40 mm at 5 m
    assert np.mean(apart_mm < 50) > 0.94


def _sonar_heard(path: Path) -> Float:
    return np.array([[s.range_raw for s in sip.sonar] for _, sip in pair(path).theirs.sips])


def _sonar_of_the_map(path: Path) -> Float:
    """What our transducers measure at the places where the old emulator was [mm]."""
    body = Body(MODEL, START)
    world = World(the_map(), [body], Kernels())
    ranges = []
    for place in _places(pair(path).theirs):
        body.robot_in_world = place
        ranges.append(np.array(world.sonar(body)) * 1000)
    return np.array(ranges)


def _places(session: Session) -> list[Pose2]:
    track = session.track
    return [
        START @ Pose2(x, y, theta)
        for x, y, theta in zip(track.x, track.y, track.theta, strict=True)
    ]


@scanned
def test_the_laser_says_the_same_wherever_it_went(path: Path) -> None:
    theirs = pair(path).theirs
    body = Body(MODEL, START)
    world = World(the_map(), [body], Kernels())
    apart_mm = []
    for place, cycle in zip(_places(theirs), theirs.cycles, strict=True):
        sweep = [
            r.range_mm for p in cycle if isinstance(p, reports.SimLaserExtended) for r in p.readings
        ]
        if sweep:
            body.robot_in_world = place
            # 6.5: it mounts the laser 125 mm ahead, whatever the parameter file says
            ranges = world.laser(body, Pose2(0.125, 0.0, 0.0), -np.pi / 2, BEAM_STEP, 181)
            apart_mm.append(np.abs(ranges * 1000 - sweep))
    assert np.median(apart_mm) < 10
    assert np.mean(np.array(apart_mm) < 50) > 0.9
