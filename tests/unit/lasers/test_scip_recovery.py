"""The client makes a laser scan in whatever state that is."""

from collections.abc import Callable
from dataclasses import replace
from random import Random

import pytest

from pioneer3.geometry import TURN
from pioneer3.lasers.client import Event, Identified, Measured, Patience, ScanSettings, ScansLost
from pioneer3.lasers.scip.client import ScipClient
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.models.lasers import LASERS, LaserModel, LaserProtocol, Steps
from tests.unit.lasers.scip_rig import URG, URG_SPEEDS, UST, UTM, Rig

SOON = 3.0
MODELS = [model for model in LASERS.values() if model.protocol is LaserProtocol.SCIP]


def speeds_of(device: ScipDevice) -> tuple[int, ...]:
    return URG_SPEEDS if device.speed else ()


def expect_scans(rig: Rig, *, within: float = SOON) -> None:
    """Check that scans come soon, and go on."""
    before = len(rig.scans)
    rig.run(within, Measured)
    assert len(rig.scans) > before, (rig.remarks, rig.losses)
    rig.run(1.0)
    assert len(rig.scans) >= before + 5
    assert rig.losses == []


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_every_model_scans_after_power_on(model: LaserModel) -> None:
    device = ScipDevice(model)
    rig = Rig(device)
    client = rig.connect(speeds_of(device))
    expect_scans(rig, within=1.0)
    assert client.refused == 0
    assert rig.remarks == []
    scan = rig.scans[-1]
    assert len(scan.ranges) == model.count
    assert scan.first == pytest.approx(model.first)
    assert scan.step == pytest.approx(model.step)
    assert max(scan.ranges[1:]) == pytest.approx(2.3, abs=0.001)
    (identified,) = rig.identities
    assert identified.identity.product == model.product
    assert identified.identity.serial == "H0012345"
    assert identified.identity.firmware == "3.3.00"
    assert identified.identity.firmware_date == "12/Sep./2012"
    assert identified.identity.status == "Sensor works well."


STATES: dict[str, Callable[[Rig], None]] = {
    "left scanning": lambda rig: rig.enter(b"BM\nMD0044072501000\n"),
    "left scanning with skipped scans": lambda rig: rig.enter(b"MS0044072599900\n"),
    "asking for some scans": lambda rig: rig.enter(b"MD0044072501099\n"),
    "laser switched on": lambda rig: rig.enter(b"BM\n"),
    "waiting for a single scan": lambda rig: rig.enter(b"BM\nGD0044072501\n"),
    "telling its time": lambda rig: rig.enter(b"TM0\nTM1\n"),
    "in half a command": lambda rig: rig.enter(b"MD00440725"),
    "in half a command that is too long": lambda rig: rig.enter(b"MD" + bytes(500)),
    "asked once to restart": lambda rig: rig.enter(b"RB\n"),
    "sleeping": lambda rig: rig.enter(b"%SL\n"),
    "slowed down": lambda rig: rig.enter(b"CR05\n"),
}


@pytest.mark.parametrize(
    "after",
    [
        pytest.param(0.0, marks=pytest.mark.thorough),
        0.33,
        pytest.param(1.0, marks=pytest.mark.thorough),
    ],
)
@pytest.mark.parametrize("model", [URG, UTM, UST], ids=lambda model: model.name)
@pytest.mark.parametrize("state", STATES)
def test_any_state_is_left(model: LaserModel, state: str, after: float) -> None:
    device = ScipDevice(model)
    rig = Rig(device)
    rig.baud = device.speed
    STATES[state](rig)
    rig.run(after)
    rig.connect(speeds_of(device))
    expect_scans(rig)


def test_half_a_command_is_ended_before_the_first_question() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.enter(b"MD0000")
    rig.connect()
    expect_scans(rig)
    assert rig.sent[:3] == [b"\nQT\n", b"VV\n", b"PP\n"]


@pytest.mark.parametrize("state", ["left scanning", "telling its time", "in half a command"])
@pytest.mark.parametrize("speed", URG_SPEEDS)
def test_the_speed_is_found_in_any_state(speed: int, state: str) -> None:
    rig = Rig(ScipDevice(URG, start_speed=speed))
    STATES[state](rig)
    rig.run(0.5)
    rig.connect(URG_SPEEDS)
    expect_scans(rig)


def test_scip_1_1_is_left_for_2_0() -> None:
    rig = Rig(ScipDevice(URG, scip1=True))
    rig.connect(URG_SPEEDS)
    expect_scans(rig)
    assert rig.scans[-1].device_time is not None


@pytest.mark.parametrize("typed", [b"", b"V\n", b"G0440", b"G04472501\n", b"S115200765"])
def test_the_first_firmware_is_polled(typed: bytes) -> None:
    rig = Rig(ScipDevice(URG, scip2=False))
    rig.enter(typed)
    rig.connect(URG_SPEEDS)
    expect_scans(rig)
    assert rig.identities[0].identity.protocol == "SCIP 1.1"
    scan = rig.scans[-1]
    assert scan.device_time is None
    assert len(scan.ranges) == URG.count
    assert scan.far == pytest.approx(4.095)


@pytest.mark.parametrize("model", [URG, UTM], ids=lambda model: model.name)
def test_a_laser_that_starts_anew_is_made_to_scan_again(model: LaserModel) -> None:
    device = ScipDevice(model, boot_time=0.1, start_speed=500000 if len(model.speeds) > 1 else None)
    rig = Rig(device)
    rig.connect([500000] if device.speed else [])
    expect_scans(rig)
    before = len(rig.scans)
    device.switch_on(rig.laser_time(rig.now))
    expect_scans(rig)
    assert [remark for remark in rig.remarks if "starting the laser again" in remark]
    assert max(map(abs, rig.stamp_errors(before))) < 0.002


def test_a_laser_that_lost_its_speed_is_lost_and_found() -> None:
    device = ScipDevice(URG, boot_time=0.1)
    rig = Rig(device)
    rig.connect(URG_SPEEDS)
    expect_scans(rig)
    assert device.speed == max(URG_SPEEDS)
    device.switch_on(rig.laser_time(rig.now))
    waited = rig.run(4.0, ScansLost)
    if rig.losses:
        rig.events.clear()
        rig.connect(URG_SPEEDS)
    expect_scans(rig, within=SOON + 4.0 - waited)


def test_a_speed_that_was_agreed_to_in_vain_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(ScipDevice(URG, start_speed=115200))
    monkeypatch.setattr(rig.host.line, "then_change_to", lambda _: None)
    rig.connect([115200, 750000])
    expect_scans(rig)
    assert rig.remarks == ["the laser does not answer at 750000 baud, which it agreed to"]
    assert rig.baud == 115200


def test_a_silent_laser_is_lost() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect()
    expect_scans(rig)
    rig.deaf = True
    rig.device.unit.restart(rig.now)
    rig.device.switch_on(rig.now + 1000)
    took = rig.run(5.0, ScansLost)
    assert took == pytest.approx(Patience().silence, abs=0.05)
    assert "said nothing" in rig.losses[0]


@pytest.mark.parametrize("before", [0.0, 2.0])
def test_a_laser_whose_mirror_is_stuck_is_lost(before: float) -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect()
    rig.run(before)
    rig.stuck = True
    took = rig.run(20.0, ScansLost)
    assert took == pytest.approx(Patience().give_up, abs=0.1)
    assert "does its mirror turn?" in rig.losses[0]
    assert len(rig.remarks) > 5


@pytest.mark.parametrize("question", [b"VV", b"PP", b"BM", b"MD"])
def test_a_laser_that_leaves_a_question_open_is_lost(question: bytes) -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect()
    rig.spoil = lambda data: b"" if data.startswith(question) else data
    rig.run(20.0, ScansLost)
    assert "not all questions" in rig.losses[0]


def test_a_laser_without_a_sensible_geometry_is_lost() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect()
    rig.spoil = lambda data: data.replace(b"SCAN:2400;U", b"SCAN:0;?")
    rig.run(20.0, ScansLost)
    assert "not the geometry of a laser" in rig.losses[0]


def test_an_error_in_mid_stream_starts_the_laser_again() -> None:
    rig = Rig(ScipDevice(UTM))
    client = rig.connect()
    expect_scans(rig)
    rig.events += [
        (rig.now, event) for event in client.receive(b"MD0000108001000\n98a\n\n", rig.now)
    ]
    assert "status 98" in rig.remarks[-1]
    expect_scans(rig)


def test_no_laser_at_all_is_lost_with_advice() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.deaf = True
    rig.connect(URG_SPEEDS)
    took = rig.run(20.0, ScansLost)
    assert took == pytest.approx(Patience().give_up)
    assert "check its power" in rig.losses[0]


def test_another_device_is_lost_with_another_reason() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect(URG_SPEEDS)
    noise = Random(1)
    rig.spoil = lambda data: noise.randbytes(len(data))
    rig.run(20.0, ScansLost)
    assert "not as a Hokuyo laser does" in rig.losses[0]


@pytest.mark.parametrize("fault", ["01", "0L", "50"])
def test_a_faulty_laser_is_reset_and_then_given_up(fault: str) -> None:
    device = ScipDevice(UST, status="Laser error.")
    device.unit.fault = fault
    rig = Rig(device)
    rig.connect()
    rig.run(8.0, ScansLost)
    assert len([remark for remark in rig.remarks if "resetting it" in remark]) == 2
    assert f"status {fault}" in rig.losses[0]
    assert "Laser error." in rig.losses[0]
    assert rig.scans == []


def test_a_fault_that_a_reset_mends_is_only_remarked() -> None:
    device = ScipDevice(UST)
    device.unit.fault = "0L"
    rig = Rig(device)
    rig.connect()
    while not rig.remarks:
        rig.run(0.01)
    device.unit.fault = ""
    expect_scans(rig)


def test_a_laser_that_is_not_ready_is_waited_for() -> None:
    device = ScipDevice(UST, status="Unstable.")
    device.unit.fault = "0M"
    rig = Rig(device)
    rig.connect()
    rig.run(4.0)
    assert not rig.losses
    assert not rig.scans
    device.unit.fault = ""
    expect_scans(rig)
    assert any("not ready yet" in remark for remark in rig.remarks)


def test_a_late_start_is_waited_for() -> None:
    device = ScipDevice(UTM, boot_time=5.0, status="Stable 000 no error.")
    rig = Rig(device)
    device.switch_on(rig.now)
    rig.connect()
    assert rig.run(8.0, Identified) == pytest.approx(5.2, abs=0.3)
    expect_scans(rig)


def test_lost_bytes_cost_some_scans_only() -> None:
    rig = Rig(ScipDevice(UTM))
    client = rig.connect()
    random = Random(3)

    def lossy(data: bytes) -> bytes:
        if random.random() < 0.1:
            at = random.randrange(len(data))
            return data[:at] + data[at + 3 :]
        return data

    rig.spoil = lossy
    rig.run(10.0)
    assert rig.losses == []
    assert client.refused > 10
    assert len(rig.scans) > 200
    assert all(len(scan.ranges) == UTM.count for scan in rig.scans)


def test_leaving_ends_the_scans_and_gives_the_speed_back() -> None:
    device = ScipDevice(URG)
    rig = Rig(device)
    client = rig.connect(URG_SPEEDS)
    expect_scans(rig)
    assert device.speed == max(URG_SPEEDS)
    client.leave(rig.now)
    client.leave(rig.now)
    rig.run(1.0)
    assert device.turn is None
    assert not device.unit.laser_on
    assert device.speed == URG.speeds[0]
    assert sum(data.count(b"QT\n") for data in rig.sent[-1:]) == 1


@pytest.mark.parametrize("when", [0.0, 0.02, 0.05, 0.09, 0.3])
def test_leaving_at_any_time_leaves_the_laser_idle(when: float) -> None:
    device = ScipDevice(UTM)
    rig = Rig(device)
    client = rig.connect()
    rig.run(when)
    client.leave(rig.now)
    rig.run(1.0)
    rig.enter(b"QT\n")
    assert rig.host.outgoing(rig.now + 1) == b"QT\n00P\n\n"
    assert device.turn is None


def test_wishes_become_the_command() -> None:
    rig = Rig(ScipDevice(UTM))
    wishes = ScanSettings(first=-1.0, last=1.0, cluster=3, skip=1, intensities=True)
    rig.connect(settings=wishes)
    expect_scans(rig)
    scan = rig.scans[-1]
    assert rig.sent[-1] == b"ME0311076903100\n"
    assert len(scan.ranges) == len(scan.intensities) == (769 - 311) // 3 + 1
    assert scan.step == pytest.approx(3 * UTM.step)
    assert scan.first == pytest.approx((311 + 1 - 540) * UTM.step)
    assert scan.period == pytest.approx(0.05)
    assert set(scan.echoes) == set()


def test_an_unknown_product_is_described_by_pp_alone() -> None:
    steps = Steps(shortest=30, longest=11000, per_turn=2000, first=0, last=1500, front=700, rpm=900)
    model = replace(UTM, name="new", product="SOKUIKI Sensor XYZ-11LX", steps=steps)
    model = replace(model, first=steps.angle(0), last=steps.angle(1500), step=steps.angle(701))
    rig = Rig(ScipDevice(model))
    rig.connect()
    expect_scans(rig)
    scan = rig.scans[-1]
    assert len(scan.ranges) == 1501
    assert scan.first == pytest.approx(-700 / 2000 * TURN)
    assert (scan.near, scan.far) == pytest.approx((0.03, 11.0))
    assert scan.period == pytest.approx(60 / 900)


@pytest.mark.parametrize(("longest", "letters"), [(4000, b"MS"), (5600, b"MD")])
def test_a_slow_line_gets_short_values_where_ranges_fit(longest: int, letters: bytes) -> None:
    assert URG.steps is not None
    model = replace(URG, steps=replace(URG.steps, longest=longest))
    rig = Rig(ScipDevice(model, start_speed=115200))
    rig.connect([115200])
    expect_scans(rig, within=2.0)
    assert rig.sent[-1].startswith(letters)
    assert max(rig.scans[-1].ranges) == pytest.approx(2.3, abs=0.001)


def test_all_echoes_are_returned() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect(settings=ScanSettings(multi_echo=True, intensities=True))
    expect_scans(rig)
    scan = rig.scans[-1]
    assert len(scan.echoes) == len(scan.ranges) == len(scan.intensities) == UTM.count
    assert [step[0] for step in scan.echoes] == list(scan.ranges)
    assert [len(step) for step in scan.echoes[:6]] == [2, 1, 1, 1, 1, 2]
    assert scan.echoes[5][1] == pytest.approx(scan.echoes[5][0] + 1.0)


def test_a_laser_without_intensities_sends_distances() -> None:
    rig = Rig(ScipDevice(URG))
    rig.connect(URG_SPEEDS, ScanSettings(intensities=True, multi_echo=True))
    expect_scans(rig)
    assert rig.scans[-1].intensities == ()
    assert len(rig.scans[-1].ranges) == URG.count


def test_a_bad_comparison_of_clocks_is_remarked() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.connect()
    rig.spoil = lambda data: data[:-2] + b"~\n\n" if data.startswith(b"TM1") else data
    expect_scans(rig)
    assert rig.remarks == ["the laser does not tell its time: scans are dated as they come"]


def asked(answer: Callable[[str], str], seconds: float = 10.0) -> tuple[list[str], list[Event]]:
    """Return the commands to a laser that gives `answer` at once, and the events."""
    now, commands, events = 100.0, list[str](), list[Event]()
    client = ScipClient(now)
    while now < 100.0 + seconds:
        events += client.tick(now)
        for command in client.outgoing().decode().split():
            commands.append(command)
            now += 0.0001
            events += client.receive(f"{command}\n{answer(command)}\n\n".encode(), now)
        now = max(min(client.deadline, 200.0), now + 0.0001)
    return commands, events


SCIP1_VERSION = (
    "0\nVEND:Hokuyo\nPROD:URG-04LX\nFIRM:3.0.00,05/09/27\nPROT:00003,(SCIP 1.1)\nSERI:H1"
)


@pytest.mark.parametrize("status", ["00P", "01Q", "0Ee", "10Q", "0Mm", "E", "0", "1"])
def test_a_laser_that_always_answers_the_same_is_asked_with_pauses_and_lost(status: str) -> None:
    commands, events = asked(lambda _: status)
    assert 1 < len(commands) < 250
    assert isinstance(events[-1], ScansLost)
    assert events[-1].reason.startswith("no scan comes from the laser: it ")


@pytest.mark.parametrize("known", ["QT", "SCIP2.0", "VV", "PP", "BM", "MD", "TM0"])
@pytest.mark.parametrize("status", ["00P", "0"])
def test_a_laser_that_knows_one_command_is_asked_with_pauses(known: str, status: str) -> None:
    commands, events = asked(lambda command: status if command.startswith(known) else "E")
    assert len(commands) < 250
    assert isinstance(events[-1], ScansLost)


def test_a_laser_that_agrees_to_scip_2_in_vain_is_said_to_speak_scip_1() -> None:
    answers = {"SCIP2.0": "0", "V": SCIP1_VERSION}
    commands, events = asked(lambda command: answers.get(command, "E"))
    assert len(commands) < 250
    assert isinstance(events[-1], ScansLost)
    assert events[-1].reason == (
        "no scan comes from the laser: "
        "it speaks SCIP 1 (firmware 3.0.00,05/09/27), but does not measure: "
        "switch it off and on, or give it firmware 3.3.00 or later, which knows SCIP 2.0"
    )


def test_a_laser_that_agrees_to_scip_2_in_vain_is_polled() -> None:
    rig = Rig(ScipDevice(URG, scip2=False))
    rig.spoil = lambda data: data.replace(b"E", b"0") if rig.sent[-1] == b"SCIP2.0\n" else data
    rig.connect(URG_SPEEDS)
    expect_scans(rig)


def test_a_scan_over_a_device_server_is_waited_for_however_slow_its_line_is() -> None:
    rig = Rig(ScipDevice(URG))
    rig.connect()
    rig.run(10.0)
    assert len(rig.scans) >= 7
    assert rig.remarks == []
    assert len(rig.scans[-1].ranges) == URG.count
