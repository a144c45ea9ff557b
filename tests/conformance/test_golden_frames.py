"""Byte-exact frames: rows of protocol.md 1.5, 2.1 and 4.3, each checked in both directions."""

from math import radians

import pytest

from pioneer3.arcos import commands as c
from pioneer3.arcos import reports
from pioneer3.arcos.packet import encode

SENT = [
    ("fa fb 03 00 00 00", c.Pulse()),
    ("fa fb 06 01 3b 01 00 02 3b", c.Open()),
    ("fa fb 06 02 3b 01 00 03 3b", c.Close()),
    ("fa fb 0d 03 2b 08 01 02 03 04 05 06 07 08 17 33", c.Polling((1, 2, 3, 4, 5, 6, 7, 8))),
    ("fa fb 06 04 3b 01 00 05 3b", c.Enable(on=True)),
    ("fa fb 06 04 3b 00 00 04 3b", c.Enable(on=False)),
    ("fa fb 06 05 3b 2c 01 31 3c", c.SetA(0.3)),
    ("fa fb 06 05 1b 2c 01 31 1c", c.SetA(-0.3)),
    ("fa fb 06 06 3b c8 00 ce 3b", c.SetV(0.2)),
    ("fa fb 06 06 3b ee 02 f4 3d", c.SetV(0.75)),
    ("fa fb 03 07 00 07", c.SetO()),
    ("fa fb 06 08 3b e8 03 f0 3e", c.Move(1.0)),
    ("fa fb 06 08 1b e8 03 f0 1e", c.Move(-1.0)),
    ("fa fb 06 0a 3b 64 00 6e 3b", c.SetRV(radians(100))),
    ("fa fb 06 0b 3b 90 01 9b 3c", c.Vel(0.4)),
    ("fa fb 06 0b 3b 00 00 0b 3b", c.Vel(0.0)),
    ("fa fb 06 0b 1b c8 00 d3 1b", c.Vel(-0.2)),
    ("fa fb 06 0c 3b 5a 00 66 3b", c.Head(radians(90))),
    ("fa fb 06 0c 1b 5a 00 66 1b", c.Head(radians(-90))),
    ("fa fb 06 0d 3b 2d 00 3a 3b", c.DHead(radians(45))),
    ("fa fb 06 0d 1b 2d 00 3a 1b", c.DHead(radians(-45))),
    ("fa fb 09 0f 2b 04 0a 64 14 32 77 7b", c.Say((c.Tone(0.2, 100), c.Tone(0.4, 50)))),
    ("fa fb 06 11 3b 02 00 13 3b", c.JoyInfo(c.RequestMode.STREAM)),
    ("fa fb 06 12 3b 01 00 13 3b", c.RequestConfig()),
    ("fa fb 06 13 3b 02 00 15 3b", c.RequestEncoders(c.RequestMode.STREAM)),
    ("fa fb 06 15 3b 64 00 79 3b", c.RVel(radians(100))),
    ("fa fb 06 15 1b 1e 00 33 1b", c.RVel(radians(-30))),
    ("fa fb 06 15 3b 00 00 15 3b", c.RVel(0.0)),
    ("fa fb 06 17 3b 64 00 7b 3b", c.SetRA(radians(100))),
    ("fa fb 06 17 1b 64 00 7b 1b", c.SetRA(radians(-100))),
    ("fa fb 06 1c 3b 01 00 1d 3b", c.Sonar(on=True)),
    ("fa fb 06 1c 3b 00 00 1c 3b", c.Sonar(on=False)),
    ("fa fb 03 1d 00 1d", c.Stop()),
    ("fa fb 06 1e 1b f1 00 0f 1b", c.DigOut(mask=0xFF, values=0x0F)),
    ("fa fb 06 1e 3b 05 0f 23 4a", c.DigOut(mask=0x0F, values=0x05)),
    ("fa fb 06 1f 3b 01 0b 20 46", c.SetPbioPort(port=11, on=True)),
    ("fa fb 06 20 3b 05 0f 25 4a", c.Vel2(left_units=15, right_units=5)),
    ("fa fb 06 20 1b f6 09 16 24", c.Vel2(left_units=-10, right_units=10)),
    ("fa fb 06 20 3b f6 0a 16 45", c.Vel2(left_units=10, right_units=-10)),
    ("fa fb 06 20 1b 0a 09 2a 24", c.Vel2(left_units=-10, right_units=-10)),
    ("fa fb 06 20 1b 00 80 20 9b", c.Vel2(left_units=-128, right_units=0)),
    ("fa fb 06 21 3b 01 00 22 3b", c.Gripper(c.GripperAction.OPEN)),
    ("fa fb 06 25 3b 02 00 27 3b", c.GripperPacRequest(c.RequestMode.STREAM)),
    ("fa fb 06 28 3b 02 00 2a 3b", c.IoRequest(c.RequestMode.STREAM)),
    ("fa fb 08 2a 2b 03 41 42 43 6f af", c.Tty2(b"ABC")),
    ("fa fb 07 2a 2b 02 41 42 2c 2e", c.Tty2(b"AB")),
    ("fa fb 06 2b 3b 0a 00 35 3b", c.GetAux(10)),
    ("fa fb 06 2c 3b 03 00 2f 3b", c.BumpStall(front=True, rear=True)),
    ("fa fb 06 2d 3b 03 00 30 3b", c.Tcm2(c.Tcm2Mode.STREAM)),
    ("fa fb 06 2f 3b 01 00 30 3b", c.named("JOYDRIVE", True)),
    ("fa fb 06 32 3b 02 00 34 3b", c.named("HOSTBAUD", c.Baud.B38400)),
    ("fa fb 06 37 3b 01 00 38 3b", c.EStop()),
    ("fa fb 06 3a 3b 01 00 3b 3b", c.Gyro(c.GyroMode.ON)),
    ("fa fb 06 3e 3b 01 00 3f 3b", c.RequestBatteryInfo(c.RequestMode.ONCE)),
    ("fa fb 06 52 3b 28 00 7a 3b", c.named("ROTKP", 40)),
    ("fa fb 06 5c 3b 00 00 5c 3b", c.named("SOUNDTOG", False)),
    ("fa fb 06 6e 3b 64 00 d2 3b", c.named("LATVEL", 0.1)),
    ("fa fb 06 6e 1b 64 00 d2 1b", c.named("LATVEL", -0.1)),
    (
        "fa fb 10 e0 00 e8 03 00 00 0c fe ff ff 5a 00 00 00 2f 00",
        c.SimSetPose(x=1.0, y=-0.5, heading=radians(90)),
    ),
    ("fa fb 03 e1 00 e1", c.SimReset()),
    ("fa fb 07 e6 3b 01 00 00 e7 3b", c.SimLrfEnable(c.SimLaserMode.RANGES, laser=0)),
    (
        "fa fb 0d ec 3b 01 00 05 00 61 2e 6d 61 70 c0 ba",
        c.SimCtrl(c.SimOperation.LOAD_MAP, "a.map"),
    ),
    ("fa fb 06 ed 3b 01 00 ee 3b", c.RequestSimStat()),
    ("fa fb 08 ee 2b 02 68 69 00 59 93", c.SimMessage("hi")),
    ("fa fb 06 ef 3b 00 00 ef 3b", c.SimExit(0)),
    ("fa fb 06 fa 3b 7d 00 77 3b", c.BatTest(12.5)),
]

SENT_TO_SIMULATORS = [
    ("fa fb 06 24 1b 5a 00 7e 1b", c.OldLaserStart(radians(-90))),
    ("fa fb 06 25 3b 5a 00 7f 3b", c.OldLaserEnd(radians(90))),
    ("fa fb 06 26 3b 64 00 8a 3b", c.OldLaserStep(radians(1))),
    ("fa fb 06 23 3b 02 00 25 3b", c.OldLaser(c.SimLaserMode.EXTENDED)),
]

TOLERATED = [
    ("fa fb 03 01 00 01", c.Open()),
    ("fa fb 04 07 3b 07 3b", c.SetO()),
    ("fa fb 09 2a 2b 03 41 42 43 00 6f af", c.Tty2(b"ABC")),
    ("fa fb 08 2a 2b 02 41 42 00 6e 6c", c.Tty2(b"AB")),
    ("fa fb 07 2a 2b 41 42 43 6b 2e", c.Tty2(b"ABC")),
]

FULL_SIP = reports.Sip(
    x_raw=100,
    y_raw=200,
    heading_raw=1024,
    left_speed_raw=300,
    right_speed_raw=200,
    battery_decivolts=130,
    control_raw=1024,
    flags=reports.SipFlag(0x1F),
    sonar=(reports.SonarReading(3, 1234), reports.SonarReading(15, 5000)),
    analog_port=0,
    gripper_state=0,
    analog=0,
    digital_in=0xFF,
    digital_out=0xFF,
    battery_decivolts_wide=130,
    charge_state=0,
    turn_rate_decidegrees=-98,
    faults=reports.Fault(0),
    lateral_speed_mm=0,
    temperature_celsius=reports.NO_TEMPERATURE,
    charge_percent=0,
)

RECEIVED = [
    ("fa fb 03 00 00 00", reports.SyncEcho(0)),
    ("fa fb 03 01 00 01", reports.SyncEcho(1)),
    ("fa fb 03 02 00 02", reports.SyncEcho(2)),
    (
        "fa fb 1d 02 4d 6f 62 69 6c 65 53 69 6d 00 50 69 6f 6e 65 65 72 00"
        " 70 33 64 78 2d 73 68 00 06 da",
        reports.SyncIdentity("MobileSim", "Pioneer", "p3dx-sh"),
    ),
    (
        "fa fb 1b 02 41 4d 52 49 53 69 6d 00 50 69 6f 6e 65 65 72 00 70 33 61 74 2d 73 68 00 5b 4f",
        reports.SyncIdentity("AMRISim", "Pioneer", "p3at-sh"),
    ),
    (
        "fa fb 1d 02 50 33 44 58 5f 31 32 33 34 00 50 69 6f 6e 65 65 72 00"
        " 70 33 64 78 2d 73 68 00 4f 58",
        reports.SyncIdentity("P3DX_1234", "Pioneer", "p3dx-sh"),
    ),
    (
        "fa fb 2c 32 64 00 c8 00 00 04 2c 01 c8 00 82 00 00 00 04 1f 00 00 02 03 d2 04 0f 88 13"
        " 00 00 00 ff ff 82 00 00 9e ff 00 00 00 00 80 00 08 1c",
        FULL_SIP,
    ),
    (
        "fa fb 16 32 6e 00 c8 00 00 00 00 00 00 00 82 00 00 00 00 01 00 00 00 34 b8",
        reports.Sip(
            x_raw=110, y_raw=200, battery_decivolts=130, flags=reports.SipFlag.MOTORS_ENABLED
        ),
    ),
]


def payload_of(frame: str) -> bytes:
    return bytes.fromhex(frame)[3:-2]


@pytest.mark.parametrize(("frame", "command"), SENT)
def test_a_command_is_the_frame_that_aria_sends(frame: str, command: c.Command) -> None:
    assert encode(c.to_payload(command)).hex(" ") == frame
    assert c.from_payload(payload_of(frame)) == command


@pytest.mark.parametrize(("frame", "command"), SENT_TO_SIMULATORS)
def test_a_simulator_reads_the_laser_numbers_its_own_way(frame: str, command: c.Command) -> None:
    assert encode(c.to_payload(command)).hex(" ") == frame
    assert c.from_payload(payload_of(frame), simulator=True) == command
    assert c.from_payload(payload_of(frame)) != command


@pytest.mark.parametrize(("frame", "command"), TOLERATED)
def test_other_clients_forms_mean_the_same(frame: str, command: c.Command) -> None:
    assert encode(payload_of(frame)).hex(" ") == frame
    assert c.from_payload(payload_of(frame)) == command


@pytest.mark.parametrize(("frame", "report"), RECEIVED)
def test_a_report_is_the_frame_that_robots_send(frame: str, report: reports.Report) -> None:
    assert encode(reports.to_payload(report)).hex(" ") == frame
    assert reports.from_payload(payload_of(frame)) == report
