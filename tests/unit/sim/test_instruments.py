"""The standard report's fields, and the commands that switch or fake them (protocol.md 4)."""

from dataclasses import replace
from math import radians

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.reports import SIP_STOPPED, Config, Fault, Sip, SipFlag
from pioneer3.sim.body import AMBIENT
from pioneer3.sim.firmware.instruments import HOT
from pioneer3.sim.kernels.drives import CAPACITY, HEAT, LEFT_STALLED, STALLED, SUPPLY
from pioneer3.sim.realism import Realism, SonarErrors
from tests.support import wall_at
from tests.unit.sim.bench import ON, Bench

SEGMENTS = 1 << 1 | 1 << 3


@pytest.fixture
def bench() -> Bench:
    made = Bench().open()
    made.hear()
    return made


def test_bumpers_lie_beside_the_stall_bits(bench: Bench) -> None:
    bench.body.pressed = SEGMENTS, 1 << 5
    sip = bench.sip()
    assert sip.right_stall_front_bumpers == SEGMENTS
    assert sip.left_stall_rear_bumpers == 1 << 5
    bench.body.drives.flags[STALLED, bench.body.number] = LEFT_STALLED
    sip = bench.firmware.information(bench.now)
    assert sip.right_stall_front_bumpers == SEGMENTS
    assert sip.left_stall_rear_bumpers == 1 << 5 | 1


@pytest.mark.parametrize(
    ("setting", "speed", "at", "stalls"),
    [
        (None, 0.3, "front", True),
        (None, -0.3, "rear", True),
        (None, 0.3, "rear", False),
        (None, -0.3, "front", False),
        (None, 0.0, "front", False),
        ((False, False), 0.3, "front", False),
        ((True, False), 0.3, "front", True),
        ((False, True), 0.3, "front", False),
        ((False, True), -0.3, "rear", True),
        ((True, False), -0.3, "rear", False),
    ],
)
def test_a_bump_on_the_side_it_drives_to_is_a_stall_unless_switched_off(
    bench: Bench, setting: tuple[bool, bool] | None, speed: float, at: str, *, stalls: bool
) -> None:
    if setting is not None:
        bench.say(commands.BumpStall(*setting))
    bench.say(ON, commands.Vel(speed))
    bench.wait(1.5)
    bench.body.pressed = (SEGMENTS, 0) if at == "front" else (0, SEGMENTS)
    sip = bench.sip()
    assert sip.left_stall_rear_bumpers & 1 == sip.right_stall_front_bumpers & 1 == int(stalls)
    bench.wait(1.0)
    assert bench.speed == (0.0 if stalls else pytest.approx(speed))


def test_after_a_bump_it_backs_out(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.3))
    bench.wait(1.0)
    bench.body.pressed = SEGMENTS, 0
    bench.wait(0.2)
    bench.say(commands.Vel(-0.2))
    bench.wait(1.0)
    assert bench.speed == pytest.approx(-0.2)


def test_a_new_session_stalls_on_bumps_again(bench: Bench) -> None:
    bench.say(commands.BumpStall(front=False, rear=False), commands.Close())
    bench.open()
    bench.say(ON, commands.Move(1.0))
    bench.body.pressed = SEGMENTS, 0
    assert bench.sip().right_stall_front_bumpers == SEGMENTS | 1


@pytest.mark.parametrize(("charge", "state"), [(0.3, 1), (0.85, 2), (1.0, 3)])
def test_in_a_dock_the_charger_goes_from_bulk_to_float(
    bench: Bench, charge: float, state: int
) -> None:
    assert bench.sip().charge_state == 0
    bench.body.set_wheel(SUPPLY, 60.0)
    bench.body.battery.energy = charge * CAPACITY
    sip = bench.firmware.information(bench.now)
    assert sip.charge_state == state
    assert sip.flags & SipFlag.CHARGER_POWER_GOOD


def test_the_charge_is_told_and_never_the_number_for_cannot_tell(bench: Bench) -> None:
    bench.body.battery.energy = 0.42 * CAPACITY
    assert bench.firmware.information(bench.now).charge_percent == 42
    bench.body.battery.energy = 0.0
    assert bench.firmware.information(bench.now).charge_percent == 1


@pytest.mark.parametrize(("volts", "low"), [(11.5, True), (11.7, False)])
def test_a_low_battery_is_a_fault(bench: Bench, volts: float, low: bool) -> None:
    bench.say(commands.BatTest(volts))
    assert bool((bench.sip().faults or Fault(0)) & Fault.UNDERVOLTAGE) == low


@pytest.mark.parametrize("how", ["motors", "digital", "analog"])
def test_heat_shows_among_faults_and_flags(bench: Bench, how: str) -> None:
    def hot() -> bool:
        sip = bench.firmware.information(bench.now)
        fault = bool((sip.faults or Fault(0)) & Fault.HIGH_TEMPERATURE)
        assert fault == bool(sip.flags & SipFlag.HIGH_TEMPERATURE)
        return fault

    assert not hot()
    if how == "motors":
        bench.body.set_wheel(HEAT, HOT - AMBIENT)
    else:
        faked = commands.DigTempTest(on=True), commands.SpoofAnalogTemp(celsius=int(HOT))
        bench.say(faked[how == "analog"])
    assert hot()
    if how == "motors":
        assert bench.firmware.information(bench.now).temperature_celsius == HOT
    else:
        bench.say(commands.DigTempTest(on=False), commands.SpoofAnalogTemp(celsius=-128))
        assert not hot()


def test_a_spoofed_temperature_is_told_until_it_is_taken_back(bench: Bench) -> None:
    bench.say(commands.SpoofAnalogTemp(celsius=-7))
    assert bench.sip().temperature_celsius == -7
    bench.say(commands.SpoofAnalogTemp(celsius=-128))
    assert bench.sip().temperature_celsius == round(bench.body.motor_temperature)


def test_however_cold_it_never_reads_as_without_a_sensor(bench: Bench) -> None:
    bench.body.set_wheel(HEAT, -300.0)
    assert bench.firmware.information(bench.now).temperature_celsius == -127


def test_the_set_point_of_a_turn_is_where_it_will_end(bench: Bench) -> None:
    bench.say(ON, commands.Head(radians(90)))
    bench.wait(0.5)
    assert bench.sip().control_raw == pytest.approx(1024, abs=8)  # wheels lag behind their ramp
    bench.wait(5.0)
    sip = bench.sip()
    assert sip.control_raw == sip.heading_raw
    bench.say(commands.RVel(radians(20)))
    bench.wait(1.0)
    sip = bench.sip()
    assert sip.control_raw == sip.heading_raw


@pytest.mark.parametrize(
    ("model", "most"), [("p3at-sh", 16), ("peoplebot-sh", 32), ("amigo-sh", 8)]
)
def test_every_sonar_is_in_every_report(model: str, most: int) -> None:
    sip = Bench(model=model).open().sip()
    assert [reading.number for reading in sip.sonar] == list(range(most))


def test_only_what_has_fired_since_is_in_a_report_of_a_real_robot() -> None:
    bench = Bench(wall_at(2.0), realism=Realism()).open()
    bench.wait(1.0)
    told = []
    for _ in range(8):
        sip = bench.wait(0.1)[0]
        assert isinstance(sip, Sip)
        told += [reading.number for reading in sip.sonar]
        assert len(sip.sonar) in {4, 6}
    # 0.8 s are 20 times 40 ms, for two arrays
    assert len(told) == 40
    assert {told.count(number) for number in range(16)} == {2, 3}


def test_nothing_fires_without_a_session() -> None:
    bench = Bench(realism=Realism())
    bench.wait(1.0)
    assert not any(bench.body.firing)
    bench.open()
    (first,) = [said for said in bench.hear() if isinstance(said, Sip)]
    assert first.sonar == ()
    assert first.flags & SipFlag.SONAR_1
    bench.wait(1.0)
    assert len(bench.sip().sonar) in {4, 6}
    bench.say(commands.Close())
    assert not any(bench.body.firing)


def numbers(bench: Bench) -> list[int]:
    return [reading.number for reading in bench.sip().sonar]


def test_a_host_sets_the_order_of_the_arrays_that_it_names(bench: Bench) -> None:
    bench.say(commands.Polling((3, 1, 3, 99)))
    assert bench.body.firing == ((2, 0, 2), tuple(range(8, 16)))
    assert numbers(bench) == [0, 2, *range(8, 16)]
    bench.say(commands.Polling((9, 10) * 20))
    assert bench.body.firing == ((2, 0, 2), (8, 9) * 8)
    bench.say(commands.Close())
    bench.open()
    assert numbers(bench) == list(range(16))


def test_no_order_at_all_switches_off_and_keeps_the_old_one(bench: Bench) -> None:
    bench.say(commands.Polling((2, 1)), commands.Polling(()))
    assert numbers(bench) == []
    bench.say(commands.Sonar(on=True))
    assert bench.body.firing[0] == (1, 0)


def test_arrays_are_switched_one_by_one(bench: Bench) -> None:
    bench.say(commands.Sonar(on=False, array=1))
    sip = bench.sip()
    assert [reading.number for reading in sip.sonar] == list(range(8, 16))
    assert not sip.flags & SipFlag.SONAR_1
    assert sip.flags & SipFlag.SONAR_2
    bench.say(commands.Sonar(on=True, array=1), commands.Sonar(on=False, array=2))
    assert numbers(bench) == list(range(8))


def test_config_tells_how_often_sonars_fire() -> None:
    quick = replace(Realism(), sonar=SonarErrors(cycle=0.02))
    for realism, cycle_ms in ((None, 40), (Realism(), 40), (quick, 20)):
        bench = Bench(realism=realism).open()
        bench.say(commands.RequestConfig())
        (config,) = [said for said in bench.wait(0.1) if isinstance(said, Config)]
        assert config.sonar_cycle_ms == cycle_ms


def test_a_wall_presses_the_middle_bumper_and_stops_the_robot_until_it_backs_out() -> None:
    bench = Bench(wall_at(0.6), model="peoplebot-sh").open()
    bench.say(ON, commands.Vel(0.3))
    seen = [r for r in bench.wait(4.0) if isinstance(r, Sip) and r.right_stall_front_bumpers]
    assert seen[0].right_stall_front_bumpers & (1 << 3 | 1) == 1 << 3 | 1
    assert seen[-1].number == SIP_STOPPED
    bench.say(commands.Vel(-0.2))
    bench.wait(1.0)
    assert bench.speed == pytest.approx(-0.2)
    assert bench.sip().right_stall_front_bumpers == 0


@pytest.mark.parametrize(
    ("model", "answers"), [("p3dx", True), ("p2at", False), ("amigo", False), ("pion1m", False)]
)
def test_old_controllers_send_short_reports_and_no_configuration(
    model: str, *, answers: bool
) -> None:
    bench = Bench(model=model).open()
    sip = bench.sip()
    assert (sip.charge_percent is not None) == answers
    assert (sip.battery_decivolts_wide is not None) == answers
    assert sip.digital_out is not None
    bench.hear()
    bench.say(commands.RequestConfig())
    assert any(isinstance(report, Config) for report in bench.hear()) == answers
