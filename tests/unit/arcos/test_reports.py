"""What reports hold, keep and refuse."""

import pytest
from msgspec.structs import replace

from pioneer3.arcos import reports as r
from pioneer3.errors import CommandError

SHORTEST = bytes.fromhex("32 6e 00 c8 00 00 00 00 00 00 00 82 00 00 00 00 01 00 00 00")
TAIL_SIZES = [0, 5, 7, 8, 10, 12, 14, 15, 16, 20, 24]


def test_every_class_is_exported_once() -> None:
    assert {cls.__name__ for cls in r.ALL} <= set(r.__all__)
    assert len(r.__all__) == len(set(r.__all__))


@pytest.mark.parametrize("number", range(0x30, 0x35))
def test_a_sip_keeps_its_id(number: int) -> None:
    payload = bytes([number]) + SHORTEST[1:]
    sip = r.from_payload(payload)
    assert isinstance(sip, r.Sip)
    assert sip.moving == (number == 0x33)
    assert r.to_payload(sip) == payload


@pytest.mark.parametrize("size", range(30))
def test_a_sip_may_end_after_each_field_and_keeps_the_rest(size: int) -> None:
    payload = SHORTEST + bytes(range(1, size + 1))
    sip = r.from_payload(payload)
    assert isinstance(sip, r.Sip)
    assert len(sip.extra) == size - max(end for end in TAIL_SIZES if end <= size)
    assert r.to_payload(sip) == payload


def test_a_sip_reads_its_tail_in_order() -> None:
    tail = bytes.fromhex("01 02 03 04 05 0601 07 ffff 0800 feff 80 09 0a000000 01000000")
    sip = r.from_payload(SHORTEST + tail)
    assert sip == r.Sip(
        x_raw=110,
        y_raw=200,
        battery_decivolts=130,
        flags=r.SipFlag.MOTORS_ENABLED,
        analog_port=1,
        gripper_state=2,
        analog=3,
        digital_in=4,
        digital_out=5,
        battery_decivolts_wide=262,
        charge_state=7,
        turn_rate_decidegrees=-1,
        faults=r.Fault.UNDERVOLTAGE,
        lateral_speed_mm=-2,
        temperature_celsius=r.NO_TEMPERATURE,
        charge_percent=9,
        timestamp_us=10,
        flags3=r.SipFlag3.JOYSTICK_OVERRIDE,
    )


def test_a_sip_that_promises_more_sonars_than_it_holds_is_unknown() -> None:
    payload = SHORTEST[:-1] + b"\x02\x00\x01\x02"
    assert r.from_payload(payload) == r.UnknownReport(0x32, payload[1:])


@pytest.mark.parametrize(
    ("sip", "says"),
    [
        (r.Sip(x_raw=-1), "Sip.x_raw: -1 is outside 0..65535"),
        (r.Sip(heading_raw=40000), "Sip.heading_raw: 40000 is outside -32768..32767"),
        (r.Sip(number=0x35), "Sip.number: 53 is outside 0x30..0x34"),
        (r.Sip(analog_port=1), "Sip.gripper_state: None, but a field of its group is set"),
        (r.Sip(charge_state=1), "Sip.analog_port: None, but a field behind it is set"),
        (
            r.Sip(sonar=(r.SonarReading(0, 1), r.SonarReading(1, 70000))),
            "Sip.sonar[1].range_raw: 70000 is outside 0..65535",
        ),
        (r.Sip(sonar=(r.SonarReading(0, 1),) * 256), "Sip.len(sonar): 256 is outside 0..255"),
        (r.Sip(x_raw=float("nan")), "Sip.x_raw: nan is not an integer"),  # type: ignore[arg-type]
    ],
)
def test_a_sip_that_does_not_fit_names_the_field(sip: r.Sip, says: str) -> None:
    with pytest.raises(CommandError) as caught:
        r.to_payload(sip)
    assert str(caught.value) == says


def test_config_may_stop_after_each_field() -> None:
    config = r.Config(family="Pioneer", model="p3at-sh", serial_number="SIM", four_motors=1)
    payload = r.to_payload(config)
    assert payload == b"\x20Pioneer\0p3at-sh\0SIM\0\x01"
    assert r.from_payload(payload) == config
    assert r.from_payload(payload[:-1]) == replace(config, four_motors=None)


def test_config_keeps_what_belongs_to_no_field() -> None:
    payload = b"\x20Pioneer\0p3at-sh\0SIM\0\x01\x2c"
    config = r.from_payload(payload)
    assert isinstance(config, r.Config)
    assert config.rotation_top_deg_s is None
    assert config.extra == b"\x2c"
    assert r.to_payload(config) == payload


def test_config_cannot_leave_out_a_field_in_the_middle() -> None:
    config = r.Config(family="", model="", serial_number="", pwm_max_raw=400)
    with pytest.raises(CommandError, match="cannot follow four_motors, which is missing"):
        r.to_payload(config)


@pytest.mark.parametrize(
    ("payload", "report"),
    [
        ("02 41 00 42 00 43 00", r.SyncIdentity("A", "B", "C")),
        ("90 01 00 00 00 ff ff ff ff", r.Encoders(1, -1)),
        ("f0 01 ff 01 0f 02 01 00 ff 0f", r.Io((255,), (15,), (1, 4095))),
        ("98 01 00 02 19", r.GyroRates((r.GyroSample(512, 25),))),
        ("b8 41 42", r.SerialAux(0xB8, b"AB")),
        ("e0 02 31 0a", r.GripperState(2, r.GripperSwitch(0x31), 10)),
        ("a0 03 01 01 02 03 04 05 06", r.ArmStatus(3, 1, (1, 2, 3, 4, 5, 6))),
        ("d3 68 69 00", r.FirmwareText("hi")),
        ("66 01 00 61 00", r.MapChanged(by_user=True, reloaded=0, file_name="a")),
        ("ff", r.LinkLost()),
        ("fe", r.LinkLost(0xFE)),
        (
            "60 0100 0200 0300 b500 2000 01 e803",
            r.SimLaser(x_mm=1, y_mm=2, heading_deg=3, total=181, first=32, ranges_mm=(1000,)),
        ),
        ("fa 00 05", r.BatteryInfo(())),
    ],
)
def test_a_report_is_what_its_bytes_say(payload: str, report: r.Report) -> None:
    decoded = r.from_payload(bytes.fromhex(payload))
    assert decoded == report
    assert r.to_payload(decoded) == bytes.fromhex(payload)


def test_batteries_may_say_more_than_is_known() -> None:
    report = r.from_payload(bytes.fromhex("fa 02 06 01020364 5a ff 00000032 32 ee"))
    assert isinstance(report, r.BatteryInfo)
    assert [battery.relative_charge_percent for battery in report.batteries] == [100, 50]
    assert [battery.extra for battery in report.batteries] == [b"\xff", b"\xee"]


def test_serial_ports_are_numbered_as_on_the_robot() -> None:
    assert [r.SerialAux(number, b"").port for number in (0xB0, 0xB8, 0xC8)] == [1, 2, 3]


@pytest.mark.parametrize(
    "payload", ["", "00 01", "35", "90 01", "10 01 00 02 00", "66 02 00 00", "fa 01 04 01 02 03 04"]
)
def test_what_makes_no_sense_is_unknown_and_keeps_its_bytes(payload: str) -> None:
    report = r.from_payload(bytes.fromhex(payload))
    assert isinstance(report, r.UnknownReport)
    assert r.to_payload(report).hex(" ") == payload


@pytest.mark.parametrize(
    ("report", "says"),
    [
        (r.Encoders(2**31, 0), "Encoders.left_counts: 2147483648 is outside"),
        (r.SyncIdentity("a\0b", "", ""), "SyncIdentity.name: 'a\\\\x00b' contains a NUL"),
        (r.SyncEcho(3), r"SyncEcho.number: 3 is not one of \(0, 1, 2\)"),
        (r.ArmStatus(0, 0, (1, 2)), "ArmStatus.positions_raw: 2 values are not 6"),
        (
            r.SimLaserExtended(total=1, first=0, readings=(r.LaserReading(70000),)),
            "SimLaserExtended.readings: LaserReading.range_mm: 70000 is outside 0..65535",
        ),
        (
            r.SimLaser(total=1, first=0, ranges_mm=(1,) * 256),
            "SimLaser.ranges_mm: 256 values are more than 255",
        ),
    ],
)
def test_a_misfit_names_class_and_field(report: r.Report, says: str) -> None:
    with pytest.raises(CommandError, match=says):
        r.to_payload(report)
