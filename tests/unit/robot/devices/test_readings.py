"""Packets become readings in SI, with frames of the protocol as vectors."""

from math import pi

import pytest

from pioneer3.arcos.reports import (
    Compass,
    Fault,
    Io,
    Report,
    Sip,
    SipFlag,
    SipFlag3,
    from_payload,
)
from pioneer3.geometry import STILL, Twist2
from pioneer3.models import load_model
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.devices.compass import read_compass
from pioneer3.robot.devices.gyro import GyroHeading
from pioneer3.robot.devices.lines import read_io
from pioneer3.robot.devices.status import detailed_status, names
from pioneer3.state import Charging, Snapshot


def received(text: str) -> Report:
    return from_payload(bytes.fromhex(text))


def snapshot(sip: Sip) -> Snapshot:
    assembler, model = Assembler(), load_model("p3at-sh")
    assembler.session_opened(model)
    return assembler.assemble(sip, 0.0, model=model, config=None)


def test_an_io_packet() -> None:
    # two bytes in, one out, two analog values of which 12 bits count
    packet = received("f0 02 01 80 01 0f 02 0002 00f4")
    assert isinstance(packet, Io)
    reading = read_io(packet, 1.0)
    assert [line for line, high in enumerate(reading.digital_in) if high] == [0, 15]
    assert reading.digital_out == (True,) * 4 + (False,) * 4
    # 0x200 = 512 steps of 4.8828 mV; of 0xF400 only 0x400 counts
    assert reading.analog == pytest.approx((512 * 0.0048828, 1024 * 0.0048828))


def test_a_compass_packet() -> None:
    # heading 2700 = 270.0 deg, pitch -15, roll 20; field; 22.0 degC; error 0x8001; scores
    packet = received("c0 8c0a f1ff 1400 d007 30f8 9411 dc00 0180 09 08 b80b")
    assert isinstance(packet, Compass)
    reading = read_compass(packet, 1.0)
    assert reading.heading == pytest.approx(-pi / 2)
    assert (reading.pitch, reading.roll) == pytest.approx((-1.5 * pi / 180, 2 * pi / 180))
    assert reading.magnetic == (20.0, -20.0, 45.0)
    assert (reading.temperature, reading.error) == (22.0, 0x8001)
    assert (reading.calibration_h, reading.calibration_v, reading.calibration_m) == (9, 8, 30.0)


class TestGyro:
    def learnt(self, zero: int = 510) -> GyroHeading:
        gyro = GyroHeading(scaler=1.0)
        for sample in range(60):
            gyro.update(zero, STILL, sample * 0.025)
        return gyro

    def test_until_it_has_stood_for_a_second_it_says_nothing(self) -> None:
        gyro = GyroHeading(scaler=1.0)
        known = [gyro.update(512, STILL, sample * 0.025) for sample in range(60)]
        assert known.index(True) * 0.025 == pytest.approx(1.0, abs=0.06)

    def test_less_is_counter_clockwise(self) -> None:
        gyro = self.learnt()
        turning = Twist2(0.0, 0.5)
        gyro.update(410, turning, 2.0)
        # -(-100 * 5/1023) * 300/2.5 = 58.65 deg/s for 25 ms
        assert gyro.rate * 180 / pi == pytest.approx(58.65, abs=0.01)
        assert gyro.heading * 180 / pi == pytest.approx(58.65 * 0.025, abs=0.001)

    def test_noise_of_a_standing_gyro_does_not_add_up(self) -> None:
        gyro = self.learnt()
        for sample in range(400):
            gyro.update(510 + sample % 2, STILL, 2 + sample * 0.025)
        assert gyro.heading == 0.0

    def test_a_drive_does_not_become_the_zero(self) -> None:
        gyro = self.learnt()
        for sample in range(200):
            gyro.update(500, Twist2(0.3, 0.0), 2 + sample * 0.025)
        assert gyro.rate > 0


class TestStatus:
    def test_bits_have_names_and_those_without_have_numbers(self) -> None:
        assert names(SipFlag(0b1_0000_0010_0001), 16) == (
            "motors enabled",
            "stop button",
            "bit 12",
        )
        assert names(Fault(1 << 3 | 1 << 15), 16) == ("undervoltage", "joydrive unsafe")
        assert names(SipFlag3(1 << 31 | 4), 32) == ("silent estop", "bit 31")

    def test_what_a_short_report_leaves_out_is_none(self) -> None:
        status = detailed_status(snapshot(Sip()))
        assert (status.faults, status.flags3) == (None, None)
        assert status.charging is Charging.UNKNOWN

    def test_flags_of_the_report(self) -> None:
        flags = SipFlag.CHARGER_POWER_GOOD | SipFlag.HIGH_TEMPERATURE
        status = detailed_status(snapshot(Sip(flags=flags)))
        assert status.charger_power
        assert status.high_temperature
        assert status.flags == ("charger power good", "high temperature")

    def test_stalls_are_one_word_as_aria_shows_it(self) -> None:
        taken = snapshot(Sip(left_stall_rear_bumpers=0x03, right_stall_front_bumpers=0x81))
        assert taken.words.stalls == 0x8103
