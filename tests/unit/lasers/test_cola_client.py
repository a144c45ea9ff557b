"""The host's side, against simulated lasers in all the states that one may find them in."""

from math import degrees, inf, radians

import pytest

from pioneer3.lasers.client import (
    Identified,
    LaserClient,
    LaserIdentity,
    Patience,
    RawScan,
    ScanSettings,
)
from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.cola.configuration import Measuring
from pioneer3.lasers.cola.wire import encode
from pioneer3.models.lasers import LASERS
from tests.unit.lasers.cola_room import LOGIN, Program, Room, losses, remarks, room, writes

MODELS = ["lms-111", "lms-511", "tim551", "tim561", "tim571"]


def true_stamp(scan: RawScan) -> float:
    """Return the time of the first reading by the laser's own clock, which began at 0."""
    assert scan.device_time is not None
    return scan.device_time


def test_it_is_a_client() -> None:
    client: LaserClient = ColaClient(5.0)
    assert client.deadline == 5.0


@pytest.mark.parametrize("name", MODELS)
def test_scans_come_as_the_model_makes_them(name: str) -> None:
    at, model = room(name), LASERS[name]
    at.run(1.0)
    assert len(at.scans) == pytest.approx(1.0 / model.turn, abs=1)
    for scan in at.scans:
        assert len(scan.ranges) == model.count
        assert scan.first == pytest.approx(model.first)
        assert scan.step == pytest.approx(model.step, rel=1e-9)
        assert scan.period == pytest.approx(model.turn)
        assert scan.beam_time == pytest.approx(model.turn * model.step / 6.283185307179586)
        assert (scan.near, scan.far) == (model.near, model.far)
        assert scan.stamp == pytest.approx(true_stamp(scan), abs=1e-5)
        assert scan.ranges[9] == inf
        assert scan.ranges[10] == pytest.approx(1.02, abs=0.0011)
        assert not scan.intensities
        assert not scan.echoes


@pytest.mark.parametrize("name", MODELS)
def test_a_laser_that_is_as_wished_is_not_written_to(name: str) -> None:
    at = room(name)
    at.run(0.5)
    assert writes(at) == []
    assert remarks(at) == losses(at) == []


def test_the_laser_says_what_it_is() -> None:
    at = room()
    at.run(0.1)
    assert at.events[0] == Identified(
        LaserIdentity(
            vendor="SICK",
            product="LMS111",
            serial="10010001",
            firmware="V1.36-21.10.2010",
            protocol="CoLa-A",
        )
    )


def test_finer_steps_bring_a_slower_scan_that_the_laser_can_do() -> None:
    at = room(wishes=ScanSettings(step=radians(0.25)))
    at.run(0.5)
    assert at.scans[-1].step == pytest.approx(radians(0.25))
    assert at.scans[-1].period == 0.04
    assert len(at.scans[-1].ranges) == 1081
    assert writes(at) == [
        LOGIN,
        "sMN mLMPsetscancfg +2500 +1 +2500 -450000 +2250000",
        "sMN Run",
    ]
    assert remarks(at) == []


@pytest.mark.parametrize(
    ("name", "wished", "step", "frequency"),
    [
        ("lms-111", 1.0, 0.5, 50),
        ("lms-511", 1 / 6, 1 / 6, 25),
        ("lms-511", 0.3, 1 / 3, 50),
        ("lms-511", 1.0, 1.0, 50),
        ("tim561", 1.0, 1 / 3, 15),
    ],
)
def test_the_nearest_step_that_there_is(
    name: str, wished: float, step: float, frequency: float
) -> None:
    at = room(name, ScanSettings(step=radians(wished)))
    at.run(0.5)
    assert degrees(at.scans[-1].step) == pytest.approx(step)
    assert 1 / at.scans[-1].period == pytest.approx(frequency)
    assert remarks(at) == []


@pytest.mark.parametrize("name", ["lms-111", "lms-511", "tim561"])
def test_a_part_of_the_field(name: str) -> None:
    at = room(name, ScanSettings(first=radians(-60), last=radians(45)))
    at.run(0.5)
    scan = at.scans[-1]
    assert degrees(scan.first) == pytest.approx(-60, abs=0.01)
    assert degrees(scan.first + (len(scan.ranges) - 1) * scan.step) == pytest.approx(45, abs=0.01)
    assert remarks(at) == []


def test_the_whole_field_again_after_a_program_that_wanted_less() -> None:
    at = room()
    other = Program(Room(at.laser))
    other.ask(LOGIN)
    other.ask("sMN mLMPsetscancfg +2500 +1 +5000 +0 +1800000")
    other.ask("sWN LMPoutputRange 1 1388 +450000 +1350000")
    other.ask("sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +8")
    at.run(1.0)
    assert len(at.scans[-1].ranges) == 541
    assert at.scans[-1].period == 0.04
    assert at.scans[-1].intensities == ()


def test_intensities_skipped_scans_and_echoes_are_there_if_wished() -> None:
    at = room("lms-511", ScanSettings(intensities=True, multi_echo=True, skip=4))
    at.echoes = lambda turn: [(1.0, 2.0)] * (turn.count - 1) + [()]
    at.ranges = lambda turn: [1.0] * (turn.count - 1) + [inf]
    at.run(1.0)
    scan = at.scans[-1]
    assert scan.period == pytest.approx(0.1)
    assert len(at.scans) == pytest.approx(10, abs=1)
    assert scan.intensities[0] == 100
    assert (scan.echoes[0], scan.echoes[-1]) == ((1.0, 2.0), ())
    assert remarks(at) == []


def test_nothing_is_stored_in_the_laser() -> None:
    at = room(wishes=ScanSettings(intensities=True, step=radians(0.25), first=0.0))
    at.run(1.0)
    assert len(at.scans) > 5
    assert "sMN mEEwriteall" not in at.sent


def test_a_mirror_that_gets_up_to_speed_is_waited_for() -> None:
    at = room(spin_up=29.0)
    at.run(30.0)
    assert remarks(at) == ["no scans yet: its mirror is getting up to speed"]
    assert len(at.scans) > 10


def test_a_tim_that_gets_up_to_speed_is_waited_for() -> None:
    at = room("tim551", spin_up=29.0)
    at.run(30.0)
    assert remarks(at) == ["no scans yet: it is busy"]
    assert len(at.scans) > 4


def test_a_mirror_that_never_gets_up_to_speed_is_given_up() -> None:
    at = room(spin_up=inf)
    at.run(100.0)
    (reason,) = losses(at)
    assert reason.startswith("the laser does not measure 60 s after its first answer")
    assert not reason.endswith(".")
    assert at.client is not None
    assert at.client.deadline == inf


def test_a_laser_that_was_stopped_is_started() -> None:
    at = room()
    other = Program(Room(at.laser))
    other.ask(LOGIN)
    other.ask("sMN LMCstopmeas")
    at.run(2.0)
    assert remarks(at) == ["no scans yet: it is ready, but stopped"]
    assert "sMN LMCstartmeas" in at.sent
    assert len(at.scans) > 10
    assert at.laser.unit.state is Measuring.MEASURING


def test_a_laser_left_streaming_is_understood() -> None:
    at = room(wishes=ScanSettings(intensities=True))
    at.connection.receive(encode("sEN LMDscandata 1"), 0.0)
    at.instead["sEN LMDscandata 0"] = "sFA 3"  # and it does not stop
    assert at.client is not None
    other = Program(Room(at.laser))
    for _ in range(20):
        at.run(0.015)
        other.ask("sRI0")
    assert len(at.scans) > 5
    assert losses(at) == []


def test_silence_at_the_start_is_given_up_with_advice() -> None:
    at = room()
    at.deaf = True
    at.run(20.0)
    (reason,) = losses(at)
    assert "2111" in reason
    assert 5 <= at.sent.count("sEN LMDscandata 0") == len(at.sent) <= 12
    assert at.client is not None
    assert at.client.outgoing() == b""


def test_silence_later_is_given_up_too() -> None:
    at = room()
    at.instead["sRN LMPscancfg"] = ""
    at.run(20.0)
    assert losses(at) == ["the laser answered at first, but not to `sRN LMPscancfg`"]


def test_a_cable_that_is_pulled_loses_the_laser() -> None:
    at = room()
    at.run(1.0)
    assert at.scans
    at.deaf = True
    at.run(0.9)
    assert losses(at) == []
    at.run(0.2)
    assert losses(at) == ["the laser sends no scans any more: check its power and its cable"]


def test_slow_scans_have_ten_periods() -> None:
    at = room("tim551", ScanSettings(skip=9))
    at.run(3.0)
    at.deaf = True
    before = len(at.scans)
    at.run(5.0)
    assert losses(at) == []
    at.run(2.0)
    assert len(at.scans) == before
    assert len(losses(at)) == 1


def test_a_power_cycle_ends_the_session_and_a_new_one_begins() -> None:
    at = room(wishes=ScanSettings(intensities=True))
    at.run(1.0)
    at.laser.unit._spin_up = 10.0
    at.laser.switch_on(at.now)
    at.run(3.0)
    assert len(losses(at)) == 1
    again = Room(at.laser, ColaClient(at.now, ScanSettings(intensities=True)), now=at.now)
    again.run(10.0)
    assert losses(again) == []
    assert again.scans[-1].intensities


def test_answers_may_be_late() -> None:
    at = room(wishes=ScanSettings(intensities=True))
    client, mail = at.client, list[tuple[float, bytes]]()
    assert client is not None
    at.client = None
    while at.now < 20.0 and not at.scans:
        at.run(0.02)
        at.events += client.tick(at.now)
        if data := client.outgoing():
            at.connection.receive(data, at.now)
        if data := at.connection.outgoing(at.now):
            mail.append((at.now + 0.6, data))
        while mail and mail[0][0] <= at.now:
            at.events += client.receive(mail.pop(0)[1], at.now)
    assert remarks(at) == losses(at) == []
    assert at.scans[0].intensities


def test_a_wide_link_is_waited_for() -> None:
    near, far = ColaClient(0.0), ColaClient(0.0, None, Patience(), 0.8)
    for client in (near, far):
        client.tick(0.0)
    assert near.deadline == pytest.approx(0.25)
    assert far.deadline == pytest.approx(1.05)


def test_without_the_lasers_clock_stamps_follow_arrival() -> None:
    at = room(wishes=ScanSettings(calibrate_time=False))
    at.run(0.5)
    scan = at.scans[-1]
    assert true_stamp(scan) + 0.02 - 540 * scan.beam_time == pytest.approx(scan.stamp)


def test_who_leaves_ends_the_scans() -> None:
    at = room()
    at.run(0.5)
    client = at.client
    assert client is not None
    client.leave(at.now)
    before = len(at.scans)
    at.run(1.0)
    client.leave(at.now)
    assert at.sent[-1] == "sEN LMDscandata 0"
    assert at.laser.turn is None
    assert len(at.scans) == before
    assert client.tick(at.now + 100) == []
    assert client.outgoing() == b""


def test_ticks_too_often_do_no_harm() -> None:
    client = ColaClient(0.0)
    client.tick(0.0)
    sent = client.outgoing()
    for _ in range(3):
        assert client.tick(0.1) == []
    assert sent == encode("sEN LMDscandata 0")
    assert client.outgoing() == b""
