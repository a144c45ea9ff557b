"""Measured numbers in a robot's own file: all else in it stays, and a copy of it."""

from dataclasses import replace
from math import radians
from pathlib import Path

import pytest

from pioneer3.calibration.calibration import Calibration
from pioneer3.calibration.own_file import OLD, Numbers, with_numbers, write_numbers
from pioneer3.calibration.procedure import Procedure
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import EncoderNumbers, OdometryCorrection, load_model
from pioneer3.models.catalog import parse_own
from pioneer3.models.model import OwnFile
from pioneer3.models.own import own_folder
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity
from tests.support import disk_of

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
    assert (own.lasers[0].mount.x, own.lasers[0].mount.delay) == (0.1235, 0.041)
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


ROSIE = RobotInfo(
    identity=Identity(name="rosie", family="Pioneer", model="p3dx-sh"),
    model=load_model("p3dx-sh"),
    limits=limits_for(load_model("p3dx-sh"), None),
    config=None,
    url="serial:/dev/ttyUSB0",
    speed=9600,
)


def test_a_full_disk_leaves_the_file_whole() -> None:
    own_folder().mkdir(parents=True)
    path = own_folder() / "rosie.toml"
    path.write_text(FILE)
    with disk_of(64), pytest.raises(ConfigError, match=r"cannot be written: File too large"):
        write_numbers(ROSIE, NUMBERS)
    assert path.read_text() == FILE
    assert list(own_folder().iterdir()) == [path]
    _, before = write_numbers(ROSIE, NUMBERS)
    assert before is not None
    assert before.read_text() == FILE


def test_a_folder_that_cannot_be_made_is_told() -> None:
    own_folder().parent.parent.mkdir(parents=True, exist_ok=True)
    own_folder().parent.write_text("no folder")
    with pytest.raises(ConfigError, match="cannot be written: Not a directory"):
        write_numbers(ROSIE, NUMBERS)


def test_a_file_of_aria_is_told_before_anything_is_driven() -> None:
    own = OwnFile(model=ROSIE.model, path=Path("rosie.p"))
    with pytest.raises(ConfigError, match=r"rosie\.p is ARIA's.* make rosie\.toml beside it"):
        Procedure(replace(ROSIE, own=own), Calibration(ROSIE.model), by_laser=False)


def test_the_copy_is_no_own_file() -> None:
    assert not PATH.with_name(PATH.name + OLD).match("*.toml")
