"""The columns of each mode against facts.md 8: names, widths, numbers."""

from dataclasses import replace
from math import inf, nan, radians

import pytest

from pioneer3.arcos.commands import GyroMode
from pioneer3.demo.columns import ColumnCell, ColumnRow, bits, degrees_tenths, hundredths, tenths
from pioneer3.demo.modes.devices import gripper_row, io_row, tcm2_row
from pioneer3.demo.modes.driving import driving_row, motion
from pioneer3.demo.modes.position import position_row
from pioneer3.demo.modes.reports import flag_lines, status_row
from pioneer3.demo.modes.sensors import GROUPS, buffer_line, bumps_row, raw_line, sonar_row
from pioneer3.geometry import ORIGIN, Pose2, Twist2
from pioneer3.robot.devices.compass import CompassReading
from pioneer3.robot.devices.gripper import GripperReading, PaddlePosition
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.robot.devices.lines import LinesReading
from pioneer3.state import (
    Battery,
    Bumpers,
    Charging,
    Inputs,
    LinkQuality,
    Motors,
    Odometry,
    Scan,
    Snapshot,
    Words,
)

POSE = Pose2(1.234, -0.567, radians(45.25))
SNAPSHOT = Snapshot(
    stamp=0.0,
    sequence=1,
    odometry=Odometry(
        robot_in_odom=POSE,
        robot_in_encoder=Pose2(0.012, 0.034, radians(-90)),
        twist=Twist2(0.3, radians(-20)),
        left_speed=0.35,
        right_speed=0.25,
    ),
    battery=Battery(voltage=12.75, charge=0.87, charging=Charging.FLOAT),
    motors=Motors(enabled=True),
    inputs=Inputs(compass=radians(88), temperature=31),
    link=LinkQuality(rate=9.8),
    words=Words(flags=0b1, stalls=0b10, faults=0b1000, flags3=None),
)


def widths(row: ColumnRow) -> list[int]:
    return [cell.width for cell in row.cells]


class TestRows:
    def test_header_and_line_stand_under_each_other(self) -> None:
        row = ColumnRow((ColumnCell("a", 4, "1"), ColumnCell("bb", 5, "22")), tail=" [X]")
        assert row.header == "   a   bb"
        assert row.line == "   1   22 [X]"

    def test_what_is_too_long_is_not_cut(self) -> None:
        assert ColumnRow((ColumnCell("a", 2, "12345"),)).line == "12345"

    def test_a_row_folds_between_columns(self) -> None:
        row = ColumnRow(
            tuple(ColumnCell(str(n), 6, str(n * 100)) for n in range(4)), tail=" [STALL]"
        )
        assert row.folded(12) == [
            "     0     1",
            "     0   100",
            "     2     3",
            "   200   300",
            "[STALL]",
        ]
        assert row.folded(80) == [row.header, row.line]
        assert all(len(line) <= 13 for line in row.folded(13))

    def test_a_line_without_columns_folds_anywhere(self) -> None:
        assert ColumnRow(tail="abcdef").folded(4) == ["abcd", "ef"]

    @pytest.mark.parametrize(
        ("text", "shown"),
        [(tenths(-0.04), "0.0"), (hundredths(-0.004), "0.00"), (degrees_tenths(-1e-9), "0.0")],
    )
    def test_nothing_is_not_negative(self, text: str, shown: str) -> None:
        assert text == shown

    def test_bits_begin_with_bit_0(self) -> None:
        assert bits(0b1_0000_0010, 16, group=8) == "01000000 10000000"


class TestDriving:
    def test_the_columns_of_teleop(self) -> None:
        row = driving_row(SNAPSHOT, POSE)
        assert row.header == "  transVel    rotVel         x         y        th     volts"
        assert row.line == "       300       -20      1234      -567      45.2      12.8"

    def test_the_charge_is_shown_once_it_was_told(self) -> None:
        row = driving_row(SNAPSHOT, POSE, has_charge=True)
        assert row.header.endswith("     volts       soc")
        assert row.line.endswith("      12.8      87.0")

    @pytest.mark.parametrize(
        ("motors", "emergency", "flags"),
        [
            (Motors(enabled=True), False, ""),
            (Motors(enabled=True, stop_button=True), False, " [ESTOP]"),
            (Motors(enabled=True), True, " [ESTOP]"),
            (Motors(enabled=True, left_stalled=True), False, " [STALL]"),
            (Motors(stop_button=True, right_stalled=True), False, " [ESTOP] [STALL] [DISABLED]"),
        ],
    )
    def test_flags_follow_when_they_are_up(
        self, motors: Motors, emergency: bool, flags: str
    ) -> None:
        snapshot = replace(SNAPSHOT, motors=motors)
        plain = ColumnRow(motion(snapshot, POSE)).line
        assert driving_row(snapshot, POSE, emergency=emergency).line == plain + flags

    def test_wander_has_the_same_columns_without_charge(self) -> None:
        assert widths(ColumnRow(motion(SNAPSHOT, POSE))) == [10] * 6


class TestSensors:
    def test_sonars_are_six_wide_and_5000_without_echo(self) -> None:
        row = sonar_row([0.5, inf, nan, 1.2344, 4.9999, 5.2, 2.0, 3.0, 9.9], GROUPS["2"])
        assert row.header == "     0     1     2     3     4     5     6     7"
        assert row.line == "   500  5000   n/a  1234  5000  5000  2000  3000"

    @pytest.mark.parametrize(
        ("key", "first", "last"),
        [("1", 0, 31), ("2", 0, 7), ("3", 8, 15), ("4", 16, 23), ("5", 24, 31)],
    )
    def test_the_groups_of_sonars(self, key: str, first: int, last: int) -> None:
        row = sonar_row([1.0] * 32, GROUPS[key])
        assert [cell.name for cell in row.cells] == [str(n) for n in range(first, last + 1)]

    def test_bumpers_front_then_rear(self) -> None:
        row = bumps_row(Bumpers(front=(False, True, False), rear=(True, False)))
        assert row.header == "     1     2     3 |     1     2"
        assert row.line == " clear  trig clear |  trig clear"

    def test_lines_by_byte_bit_0_first(self) -> None:
        reading = LinesReading(
            stamp=0.0,
            digital_in=(True, *[False] * 15),
            digital_out=(*[False] * 7, True),
            analog=(1.234, 5.0),
        )
        row = io_row(SNAPSHOT.words, reading)
        assert [cell.name for cell in row.cells] == [
            *("flags", "fault_flags", "digin0", "digin1", "digout0", "a/d0", "a/d1")
        ]
        assert row.line.split() == [
            *("10000000", "00000000", "00010000", "00000000"),
            *("10000000", "00000000", "00000001", "1.23", "5.00"),
        ]

    def test_faults_are_left_out_where_the_robot_sends_none(self) -> None:
        row = io_row(Words(flags=0), None)
        assert row.header.split() == ["flags"]

    def test_the_gripper_is_thirteen_wide(self) -> None:
        reading = GripperReading(
            stamp=0.0,
            paddles=PaddlePosition.BETWEEN,
            lift_at_limit=True,
            left_touches=True,
            right_touches=False,
            outer_beam_broken=True,
            inner_beam_broken=False,
            lift_moves=False,
            paddles_move=False,
        )
        row = gripper_row(reading)
        assert [cell.name for cell in row.cells] == [
            *("BB outer", "BB inner", "Paddles", "Lift", "LeftPaddle", "RightPaddle")
        ]
        assert widths(row) == [13] * 6
        assert row.line.split() == ["blocked", "clear", "between", "maxed", "triggered", "clear"]

    def test_the_compass(self) -> None:
        reading = CompassReading(
            stamp=0.0,
            heading=radians(123.4),
            pitch=radians(-1.5),
            roll=radians(0.2),
            magnetic=(0.38, -20.0, 45.0),
            temperature=22.0,
            error=0x1A,
            calibration_h=5,
            calibration_v=6,
            calibration_m=12.34,
        )
        row = tcm2_row(reading, rate=9.7)
        assert row.header.split() == [
            *("comp", "pitch", "roll", "magX", "magY", "magZ"),
            *("temp", "error", "calH", "calV", "calM", "cnt"),
        ]
        assert widths(row) == [6, 5, 5, 6, 6, 6, 6, 10, 4, 4, 6, 3]
        assert row.line.split() == [
            *("123.4", "-1.5", "0.2", "0.38", "-20.00", "45.00"),
            *("22.0", "0x1a", "5", "6", "12.34", "10"),
        ]
        assert len(row.header) <= 80


class TestLaser:
    SCAN = Scan(
        stamp=0.0,
        sequence=1,
        robot_in_odom=ORIGIN,
        sensor_in_robot=Pose2(0.1, 0.0, 0.0),
        angles=(radians(-90), 0.0, radians(90)),
        ranges=(inf, 0.9, 3.0),
        reflectances=(0, 32, 7),
    )

    def test_nearest_and_farthest_are_seen_from_the_robot(self) -> None:
        # 0.9 m ahead of a laser that sits 0.1 m before the centre is 1 m away
        assert buffer_line(self.SCAN) == (
            "Close: 1000mm   0.0 deg   Far: 3002mm  88.1 deg   3 readings"
        )

    def test_raw_readings_are_the_lasers_own(self) -> None:
        assert (
            raw_line(self.SCAN)
            == "Close:  900mm   0.0 deg 32 refl   Middle:  900mm   0.0 deg 32 refl"
        )

    def test_nothing_in_front_is_said(self) -> None:
        scan = replace(self.SCAN, ranges=(inf, inf, inf))
        assert buffer_line(scan).startswith("No close reading.")
        assert "no echo" in raw_line(scan)


class TestPosition:
    def test_the_columns_without_gyro(self) -> None:
        row = position_row(SNAPSHOT, POSE, "both", GyroMode.ON, None)
        assert row.header == "      x      y       th   comp   volts  mpacs    mode       raw"
        assert row.line == "   1234   -567    45.25     88   12.75     10    both 12,34,-90.0"
        assert widths(row) == [7, 7, 9, 7, 8, 7, 8, 10]

    def test_the_gyro_adds_three(self) -> None:
        reading = GyroReading(stamp=0.0, heading=radians(44), rate=0.0, temperature_raw=0)
        row = position_row(SNAPSHOT, POSE, "either", GyroMode.ONLY, reading)
        assert widths(row) == [7, 7, 9, 7, 8, 7, 8, 6, 10, 10, 10]
        assert row.line.split()[6:10] == ["either", "only", "44.00", "-90.00"]

    def test_a_robot_without_compass_has_none(self) -> None:
        snapshot = replace(SNAPSHOT, inputs=Inputs())
        assert position_row(snapshot, POSE, "both", GyroMode.ON, None).line.split()[3] == "n/a"


class TestStatus:
    def test_names_and_widths(self) -> None:
        row = status_row(SNAPSHOT)
        assert [(cell.name, cell.width) for cell in row.cells] == [
            *(("volt", 5), ("soc", 5), ("temp", 5), ("mot.enable", 12), ("estop", 6)),
            *(("stall l", 7), ("stall r", 7), ("stallval", 16), ("sips/sec", 9)),
            *(("cycletime", 10), ("flags", 16), ("faults", 16), ("flags3", 32)),
            *(("chargestate", 13), ("chargepower", 13)),
        ]

    def test_words_are_binary_with_the_highest_bit_first(self) -> None:
        values = {cell.name: cell.text for cell in status_row(SNAPSHOT).cells}
        assert values["flags"] == "0000000000000001"
        assert values["stallval"] == "0000000000000010"
        assert values["faults"] == "0000000000001000"
        assert values["flags3"] == "n/a"
        assert values["mot.enable"] == "yes"
        assert values["estop"] == "no"
        assert values["temp"] == "31"
        assert values["soc"] == "87%"
        assert values["chargestate"] == "float"

    def test_what_is_wrong_is_loud(self) -> None:
        motors = Motors(enabled=False, stop_button=True, left_stalled=True)
        values = {
            cell.name: cell.text for cell in status_row(replace(SNAPSHOT, motors=motors)).cells
        }
        assert values["mot.enable"] == "NO"
        assert (values["estop"], values["stall l"], values["stall r"]) == ("YES", "YES", "no")

    def test_flags_have_names(self) -> None:
        assert list(flag_lines(SNAPSHOT)) == [
            "flags: motors enabled",
            "faults: undervoltage",
            "flags3: not sent",
        ]
