"""Measured numbers in a robot's own file: all else in it stays, and a copy of it."""

from dataclasses import replace
from math import radians
from pathlib import Path

import pytest

from pioneer3.calibration.own_file import OLD, Numbers, with_numbers
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import EncoderNumbers, OdometryCorrection
from pioneer3.models.catalog import parse_own

NUMBERS = Numbers(
    odometry=OdometryCorrection(1.0123456, 0.98, 1.005),
    laser=Pose2(0.123456, -0.01, radians(2)),
    delay=0.0412,
    gyro_scaler=1.70014,
    encoders=EncoderNumbers(ticks_mm=138, rev_count=22500, drift_factor=-12),
    serial_number="A 47",
)
FILE = """\
# rosie, of room 12
like = "p3dx-sh"   # since 2024
max_speed = 0.5

[odometry]   # by hand
scale = 1.1  # five metres
# base_ratio = 1.0

[[lasers]]
port = "/dev/ttyACM0"
kind = "urg-04lx"
x = 0.16  # tape
y = 0.0
theta_deg = 0

[[lasers]]
port = "/dev/ttyACM1"
kind = "urg-04lx"
x = -0.2
y = 0.0
theta_deg = 180
"""
PATH = Path("rosie.toml")


def test_numbers_are_replaced_and_comments_stay() -> None:
    text = with_numbers(FILE, NUMBERS, PATH)
    own = parse_own(text, "rosie.toml")
    assert own.model.odometry == OdometryCorrection(1.01235, 0.98, 1.005)
    assert (own.lasers[0].mount.x, own.lasers[0].delay) == (0.1235, 0.041)
    assert own.lasers[0].mount.theta == pytest.approx(radians(2))
    assert own.lasers[1].mount.x == -0.2
    assert (own.model.max_speed, own.model.gyro_scaler) == (0.5, 1.7001)
    assert own.model.encoders == NUMBERS.encoders
    assert own.serial_number == "A 47"
    for comment in ("# rosie, of room 12", "# since 2024", "# by hand", "# five metres", "# tape"):
        assert comment in text
    again = replace(NUMBERS, serial_number="")  # the file has it
    assert with_numbers(text, again, PATH) == text
    others = replace(again, encoders=EncoderNumbers(ticks_mm=128, rev_count=16570))
    assert (
        parse_own(with_numbers(text, others, PATH), "rosie.toml").model.encoders == others.encoders
    )


def test_a_file_without_odometry_gets_it_and_one_without_a_laser_gets_none() -> None:
    text = with_numbers('like = "p3dx-sh"', NUMBERS, PATH)
    own = parse_own(text, "rosie.toml")
    assert own.model.odometry.base_ratio == 0.98
    assert own.lasers == ()


@pytest.mark.parametrize(
    "text",
    [
        'like = "p3dx-sh"\nodometry = { scale = 1.1 }\n',
        'like = "p3dx-sh"\nodometry.scale = 1.1\n',
        'like = "p3dx-sh"\nnote = """\n[odometry]\n"""\n',
    ],
)
def test_a_file_in_a_form_of_its_own_is_left_alone(text: str) -> None:
    with pytest.raises(ConfigError, match=r"write into it yourself(.|\n)*base_ratio = 0.98"):
        with_numbers(text, NUMBERS, PATH)


def test_the_copy_is_no_own_file() -> None:
    assert not PATH.with_name(PATH.name + OLD).match("*.toml")
