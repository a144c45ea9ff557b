"""Lasers as people write them on a command line."""

from dataclasses import replace
from math import pi, radians

import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.lasers.client import ScanSettings
from pioneer3.models import LaserMount, load_model
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.lasers.mounting import Mounting, Sector
from pioneer3.robot.lasers.spec import (
    LaserSpec,
    mounting_of,
    own_laser,
    parse_laser,
    parse_lasers,
    parse_mask,
    parse_mounting,
)

SCIP, LMS, COLA = LaserProtocol.SCIP, LaserProtocol.LMS2XX, LaserProtocol.COLA


@pytest.mark.parametrize(
    ("text", "url", "protocol"),
    [
        ("/dev/ttyACM0", "/dev/ttyACM0", None),
        ("COM3", "COM3", None),
        ("utm-30lx@/dev/ttyACM0", "/dev/ttyACM0", SCIP),
        ("lms-200@/dev/ttyUSB1", "/dev/ttyUSB1", LMS),
        ("tcp://192.168.0.10", "tcp://192.168.0.10:10940", None),
        ("tcp://192.168.0.10/", "tcp://192.168.0.10:10940", None),
        ("tcp://192.168.0.10:2112", "tcp://192.168.0.10:2112", None),
        ("192.168.0.10:10940", "192.168.0.10:10940", None),
        ("ust-10lx@tcp://laser", "tcp://laser:10940", SCIP),
        ("lms-111@tcp://192.168.0.1", "tcp://192.168.0.1:2111", COLA),
        ("tim551@tcp://192.168.0.1:2112", "tcp://192.168.0.1:2112", COLA),
        ("192.168.0.10", "tcp://192.168.0.10:10940", None),
        ("replay:walk.log", "replay:walk.log", None),
        ("/dev/serial/by-id/usb-a@b", "/dev/serial/by-id/usb-a@b", None),
    ],
)
def test_a_port_may_carry_the_model(text: str, url: str, protocol: LaserProtocol | None) -> None:
    spec = parse_laser(text)
    assert (spec.url, spec.protocol) == (url, protocol)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("lms200@/dev/ttyUSB1", "no such laser, did you mean lms-200?"),
        ("nonsense@/dev/ttyUSB1", "no such laser; known are urg-04lx"),
        ("nowhere", "'nowhere' names no port"),
        ("", "names no port"),
        ("http://laser", "names no port"),
        ("lms-200@", "names no port"),
    ],
)
def test_what_is_no_laser_is_refused_in_a_sentence(text: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words.replace("?", r"\?")) as refused:
        parse_laser(text)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "pose", "upside_down"),
    [
        ("0.16,0,0", Pose2(0.16), False),
        ("160mm,0,180", Pose2(0.16, 0, pi), False),
        (" -0.1 , 0.05 , -90deg ", Pose2(-0.1, 0.05, -pi / 2), False),
        ("0,0,1.57rad,upside-down", Pose2(0, 0, 1.57), True),
        ("0,0,270, upside-down", Pose2(0, 0, -pi / 2), True),
    ],
)
def test_poses_are_in_metres_and_degrees(text: str, pose: Pose2, *, upside_down: bool) -> None:
    mounting = parse_mounting(text)
    found = mounting.sensor_in_robot
    assert (found.x, found.y, found.theta) == pytest.approx((pose.x, pose.y, pose.theta))
    assert mounting.upside_down is upside_down


@pytest.mark.parametrize(
    "text",
    ["", "0,0", "0,0,0,0", "0,0,0,upside", "upside-down", "a,b,c", "nan,0,0", "11,0,0", "0,-11,0"],
)
def test_what_is_no_pose_is_refused_with_the_option(text: str) -> None:
    with pytest.raises(ConfigError, match=f"--laser-pose {text}: ") as refused:
        parse_mounting(text)
    assert "\n" not in str(refused.value)


def test_masks_are_sectors_in_degrees() -> None:
    assert parse_mask("-135:-120,120:135deg") == (
        Sector(radians(-135), radians(-120)),
        Sector(radians(120), radians(135)),
    )
    assert parse_mask("0.1rad:10") == (Sector(0.1, radians(10)),)


@pytest.mark.parametrize("text", ["", "10", "10:20:30", "10:20,", "a:b", "10-20", "nan:3"])
def test_what_is_no_mask_is_refused_with_the_option(text: str) -> None:
    with pytest.raises(ConfigError, match=f"--laser-mask {text}: ") as refused:
        parse_mask(text)
    assert "\n" not in str(refused.value)


def test_several_lasers_have_names_and_places_of_their_own() -> None:
    one, other, third = parse_lasers(
        ["/dev/ttyACM0", "lms-200@/dev/ttyUSB1", "tcp://laser"],
        ["0.1,0,0", "-0.2,0,180"],
        ["1:2"],
    )
    assert [one.name, other.name, third.name] == ["laser", "laser2", "laser3"]
    assert one.masked == (Sector(radians(1), radians(2)),)
    assert (other.masked, third.masked) == ((), ())
    assert other.mounting == Mounting(sensor_in_robot=Pose2(-0.2, 0, pi))
    assert third.mounting is None


@pytest.mark.parametrize(
    ("lasers", "poses", "masks", "words"),
    [
        ([], ["0,0,0"], [], "--laser-pose: 1 given, but lasers: 0"),
        (["/dev/a"], [], ["1:2", "1:2"], "--laser-mask: 2 given, but lasers: 1"),
        (["/dev/a", "/dev/a"], [], [], "--laser /dev/a: given twice"),
        (["/dev/a", "lms-200@/dev/a"], [], [], "--laser /dev/a: given twice"),
        (["tcp://a", "tcp://a:10940"], [], [], "--laser tcp://a:10940: given twice"),
    ],
)
def test_options_that_do_not_fit_together_are_refused(
    lasers: list[str], poses: list[str], masks: list[str], words: str
) -> None:
    with pytest.raises(ConfigError, match=words):
        parse_lasers(lasers, poses, masks)


def test_the_driver_gets_all_of_it() -> None:
    settings = ScanSettings(first=-1.0, cluster=3)
    spec = LaserSpec(url="/dev/a", name="b", protocol=LMS, settings=settings, time_offset=0.1)
    config = spec.config()
    assert (config.url, config.name, config.protocol) == ("/dev/a", "b", LMS)
    assert (config.settings, config.time_offset) == (settings, 0.1)


def test_without_lasers_there_is_nothing_to_read() -> None:
    assert parse_lasers([]) == ()


def test_its_place_is_that_of_the_model_unless_given() -> None:
    model = load_model("p3at-sh")
    assert model.laser is not None
    found = LaserSpec(url="/dev/a").mounting_on(model)
    assert found == mounting_of(model.laser)
    given = Mounting(sensor_in_robot=Pose2(1.0))
    found = LaserSpec(url="/dev/a", mounting=given).mounting_on(model)
    assert found == replace(given, delay=0.0)
    assert LaserSpec(url="/dev/a").mounting_on(None) == Mounting()


def test_a_delay_holds_wherever_the_laser_is_put() -> None:
    model = load_model("p3at-sh")
    assert model.laser is not None
    late = replace(model, laser=replace(model.laser, delay=0.05))
    spec, *_ = parse_lasers(["/dev/a"], ["0.1,0,2"])
    placed = spec.mounting_on(late)
    assert (placed.sensor_in_robot.x, placed.delay) == (0.1, 0.05)
    own = replace(spec, mounting=mounting_of(model.laser))
    assert own.mounting_on(late).delay == 0.0
    assert own_laser("/dev/a", spec, late).mount.delay == 0.05


def test_masks_add_to_those_of_the_model() -> None:
    mount = LaserMount(
        kind="urg2.0", x=0.1, y=0.0, theta=0.5, upside_down=True, masked=((1.0, 2.0),), delay=0.05
    )
    assert mounting_of(mount) == Mounting(
        sensor_in_robot=Pose2(0.1, 0.0, 0.5),
        upside_down=True,
        masked=(Sector(1.0, 2.0),),
        delay=0.05,
    )
    spec = LaserSpec(url="/dev/a", mounting=mounting_of(mount), masked=(Sector(-2.0, -1.0),))
    assert spec.mounting_on(None).masked == (Sector(1.0, 2.0), Sector(-2.0, -1.0))
