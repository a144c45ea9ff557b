"""Parameters of lasers, with the names of urg_node and of hokuyo_node."""

from dataclasses import replace
from math import inf, nan, pi, radians

import pytest

from pioneer3.cli.options import LaserOptions
from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN
from pioneer3.lasers.client import AS_DELIVERED, RawScan, ScanSettings
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.lasers.spec import parse_lasers
from pioneer3.ros.node.laser_parameters import (
    FOREIGN,
    LaserParameters,
    overridden_laser_parameters,
    read_laser_parameters,
    unused_laser_parameters,
)
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import rows_of
from pioneer3.ros.node.parameter_reading import read_parameters


def test_without_any_nothing_is_asked_for() -> None:
    found = read_laser_parameters({})
    assert found == LaserParameters()
    assert found.settings == AS_DELIVERED
    assert found.ports == ()
    assert found.applied_to(()) == ()


@pytest.mark.parametrize(
    ("given", "url"),
    [
        ({"serial_port": "/dev/ttyACM0"}, "/dev/ttyACM0"),
        ({"port": "/dev/ttyACM0"}, "/dev/ttyACM0"),
        ({"port": "/dev/old", "serial_port": "/dev/new"}, "/dev/new"),
        ({"serial_port": "", "port": ""}, None),
        ({"ip_address": "192.168.0.10"}, "tcp://192.168.0.10:10940"),
        ({"ip_address": "192.168.0.1", "ip_port": 2112}, "tcp://192.168.0.1:2112"),
        ({"ip_address": "", "serial_port": "/dev/a"}, "/dev/a"),
        ({"ip_address": "192.168.0.10", "serial_port": "/dev/a"}, "tcp://192.168.0.10:10940"),
        ({"host": "10.42.1.197"}, "tcp://10.42.1.197:2111"),
        ({"host": "10.42.1.197", "port": 2112}, "tcp://10.42.1.197:2112"),
        ({"hostname": "192.168.0.1", "port": "2112"}, "tcp://192.168.0.1:2112"),
        ({"host": "192.168.0.1", "ip_port": 2113}, "tcp://192.168.0.1:2113"),
        ({"ip_address": "192.168.0.10", "host": "a"}, "tcp://192.168.0.10:10940"),
    ],
)
def test_the_port_is_that_of_either_node(given: dict[str, object], url: str | None) -> None:
    found = read_laser_parameters(given)
    assert found.ports == ((url,) if url else ())


def test_the_names_of_both_nodes_mean_the_same() -> None:
    rep138 = read_laser_parameters(
        {
            "frame_id": "/front",
            "publish_intensity": True,
            "angle_min": -1.5,
            "angle_max": 1.0,
            "cluster": 3,
            "skip": 2,
            "calibrate_time": False,
            "time_offset": -0.02,
            "publish_multiecho": True,
        }
    )
    assert (rep138.frame_id, rep138.time_offset) == ("/front", -0.02)
    assert rep138.settings == ScanSettings(
        first=-1.5,
        last=1.0,
        cluster=3,
        skip=2,
        intensities=True,
        multi_echo=True,
        calibrate_time=False,
    )
    hokuyo = read_laser_parameters(
        {"frameid": "front", "intensity": True, "min_ang": -1.5, "max_ang": 1, "cluster": 3}
    )
    assert (hokuyo.frame_id, hokuyo.settings.intensities) == ("front", True)
    assert (hokuyo.settings.first, hokuyo.settings.last) == (-1.5, 1.0)


def test_the_parameters_of_sicktoolbox_are_taken() -> None:
    found = read_laser_parameters(
        {
            "port": "/dev/ttyUSB1",
            "baud": 38400,
            "angle": 100,
            "resolution": 0.25,
            "inverted": True,
            "frame_id": "base_laser",
        }
    )
    assert (found.ports, found.frame_id) == (("/dev/ttyUSB1",), "base_laser")
    settings = found.settings
    assert (settings.first, settings.last, settings.step) == pytest.approx(
        (-radians(50), radians(50), radians(0.25))
    )
    assert read_laser_parameters({"angle": 0, "resolution": 0.0}).settings == AS_DELIVERED


@pytest.mark.parametrize("place", ["", "0.2,0,0", "0.2,0,0,upside-down"])
def test_an_inverted_laser_is_mirrored_wherever_it_sits(place: str) -> None:
    raw = RawScan(
        stamp=1.0,
        first=-0.5,
        step=0.5,
        beam_time=0.0,
        period=0.1,
        near=0.1,
        far=8.0,
        ranges=(1.0, 2.0, 3.0, 4.0),
    )
    found = read_laser_parameters({"port": "/dev/a", "inverted": True})
    (spec,) = found.applied_to(parse_lasers(found.ports, [place] if place else []))
    scan = spec.mounting_on(None).scan(raw, 0, "laser", lambda time: ORIGIN)
    assert dict(zip(scan.angles, scan.ranges, strict=True)) == {
        -1.0: 4.0,
        -0.5: 3.0,
        0.0: 2.0,
        0.5: 1.0,
    }
    assert list(scan.angles) == sorted(scan.angles)


def test_directions_are_those_of_the_scan_that_is_published() -> None:
    found = read_laser_parameters({"angle_min": -0.5, "angle_max": 1.0, "inverted": True})
    assert (found.settings.first, found.settings.last) == (-1.0, 0.5)
    one = read_laser_parameters({"angle_min": -0.5, "inverted": True})
    assert (one.settings.first, one.settings.last) == (None, 0.5)


def test_the_driver_gets_all_of_them() -> None:
    found = read_laser_parameters(
        {"port": "lms-200@/dev/ttyUSB1", "intensity": True, "time_offset": 0.1}
    )
    (spec,) = found.applied_to(parse_lasers(found.ports))
    assert spec.protocol is LaserProtocol.LMS2XX
    assert spec.settings.intensities
    assert spec.time_offset == 0.1
    assert spec.name == "laser"


async def test_settings_hold_for_the_first_laser_of_the_command_line() -> None:
    options = LaserOptions(
        laser=("tcp://10.0.0.1:2111", "/dev/ttyACM1"), laser_pose=("0.2,0,10",), laser_mask=("0:5",)
    )
    given = await options.specs(otherwise=["/dev/ttyACM9"])
    found = read_laser_parameters({"port": "/dev/ttyACM9", "skip": 2, "time_offset": 0.1})
    first, second = found.applied_to(given)
    assert first == replace(given[0], settings=ScanSettings(skip=2), time_offset=0.1)
    assert second == given[1]


async def test_a_laser_of_parameters_has_the_place_of_the_command_line() -> None:
    options = LaserOptions(laser_pose=("0.2,0,10",), laser_mask=("0:5",))
    found = read_laser_parameters({"port": "/dev/ttyACM9", "skip": 2})
    (spec,) = found.applied_to(await options.specs(otherwise=found.ports))
    assert spec.url == "/dev/ttyACM9"
    assert spec.mounting is not None
    assert spec.mounting.sensor_in_robot.x == 0.2
    assert spec.masked
    assert spec.settings.skip == 2


async def test_a_laser_of_parameters_is_not_at_the_robots_port() -> None:
    with pytest.raises(ConfigError, match="/dev/ttyUSB0"):
        await LaserOptions().specs(taken=["/dev/ttyUSB0"], otherwise=["/dev/ttyUSB0"])


def test_a_port_that_the_command_line_overrides_is_told() -> None:
    raw = {"port": "/dev/ttyACM0", "ip_port": 2112, "skip": 1, "frame_id": "front"}
    why = "is ignored: --laser or PIONEER3_LASER gives auto and /dev/ttyACM1"
    assert overridden_laser_parameters(raw, ["auto", "/dev/ttyACM1"], below="laser") == [
        f"parameter ~laser/ip_port {why}",
        f"parameter ~laser/port {why}",
    ]
    assert overridden_laser_parameters(raw, ["/dev/ttyACM0"]) == []
    assert overridden_laser_parameters(raw, []) == []
    assert overridden_laser_parameters({"skip": 1, "ip_port": 2112}, ["/dev/ttyACM1"]) == [
        "parameter ~ip_port is ignored: --laser or PIONEER3_LASER gives /dev/ttyACM1"
    ]


def test_settings_of_no_laser_are_told() -> None:
    raw = {"min_ang": -1.0, "skip": 1, "frame_id": "front"}
    why = "is ignored: no laser is given; give it with --laser or ~laser/serial_port"
    assert overridden_laser_parameters(raw, [], below="laser") == [
        f"parameter ~laser/min_ang {why}",
        f"parameter ~laser/skip {why}",
    ]
    assert overridden_laser_parameters({}, [], below="laser") == []
    dumped = {row.name: row.default for row in rows_of(LaserParameters) if row.default is not None}
    assert overridden_laser_parameters(dumped, []) == []


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({"serial_port": 3}, "serial_port"),
        ({"serial_port": "/dev/a b"}, "serial_port"),
        ({"ip_address": True}, "ip_address"),
        ({"ip_address": "a", "ip_port": 0}, "ip_port"),
        ({"ip_address": "a", "ip_port": "10940"}, "ip_port"),
        ({"frame_id": 1}, "frame_id"),
        ({"time_offset": 0.3}, "time_offset"),
        ({"time_offset": nan}, "time_offset"),
        ({"angle_min": -4.0}, "angle_min"),
        ({"angle_max": inf}, "angle_max"),
        ({"min_ang": "left"}, "min_ang"),
        ({"angle_min": 1.0, "angle_max": 0.5}, "angle_min"),
        ({"cluster": 0}, "cluster"),
        ({"cluster": 100}, "cluster"),
        ({"cluster": True}, "cluster"),
        ({"skip": 10}, "skip"),
        ({"skip": 1.5}, "skip"),
        ({"publish_intensity": 1}, "publish_intensity"),
        ({"intensity": "yes"}, "intensity"),
        ({"calibrate_time": None}, "calibrate_time"),
        ({"publish_multiecho": "on"}, "publish_multiecho"),
        ({"inverted": 1}, "inverted"),
        ({"angle": "wide"}, "angle"),
        ({"angle": 361}, "angle"),
        ({"resolution": -0.25}, "resolution"),
        ({"host": "a", "port": "/dev/ttyUSB0"}, "ip_port"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(given: dict[str, object], name: str) -> None:
    with pytest.raises(ConfigError, match=f"~{name} must") as refused:
        read_laser_parameters(given)
    assert "\n" not in str(refused.value)


def test_the_widest_field_is_half_a_turn_each_way() -> None:
    found = read_laser_parameters({"angle_min": -pi, "angle_max": pi})
    assert (found.settings.first, found.settings.last) == (-pi, pi)


def test_what_has_no_effect_is_told() -> None:
    assert unused_laser_parameters({"port": 1, "error_limit": 4, "xyz": 1, "skip": 1}) == [
        "parameter ~error_limit of hokuyo_node or urg_node has no effect here",
        "parameter ~xyz is unknown",
    ]
    assert unused_laser_parameters({"connect_delay": 35}) == [
        "parameter ~connect_delay of sicktoolbox_wrapper has no effect here: the laser is looked"
        " for until it answers"
    ]
    assert unused_laser_parameters({"min_ang_degrees": -90}, Profile.ROS2, "laser") == [
        "parameter laser.min_ang_degrees of hokuyo_node or urg_node has no effect here: write"
        " laser.angle_min in radians"
    ]
    assert unused_laser_parameters({"skp": 1}, below="laser") == [
        "parameter ~laser/skp is unknown; did you mean ~laser/skip?"
    ]
    both = {name for row in rows_of(LaserParameters) for name in row.names(Profile.STANDARD)}
    assert not both & set(FOREIGN)
    assert unused_laser_parameters(dict.fromkeys(both)) == []


def test_in_the_robots_node_they_are_below_a_name() -> None:
    found = read_parameters({"laser": {"serial_port": "/dev/a", "frame_id": "front"}})
    assert found.laser.ports == ("/dev/a",)
    assert found.options.frames.laser == "front"
    own = read_parameters({"laser": {"frame_id": "front"}, "laser_frame_id": "eyes"})
    assert own.options.frames.laser == "eyes"


@pytest.mark.parametrize("given", [{"laser": "/dev/a"}, {"laser": {"serial_port": 3}}])
def test_there_they_are_refused_too(given: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match="serial_port"):
        read_parameters(given)
