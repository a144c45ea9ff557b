import math
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest

from docs.reference.ros_tables import PAGES, filled
from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import load_model
from pioneer3.models.description.tree import Frames
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.robot.devices.pictures import Image
from pioneer3.ros.messages import sensors
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate
from pioneer3.ros.messages.update import (
    DescriptionUpdate,
    MessageOptions,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
)
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.p2os_topics import P2OS_TOPICS
from pioneer3.ros.node.topic import Topic, Update
from pioneer3.ros.node.topics import (
    COMMANDS,
    STAMPED_COMMANDS,
    TOPICS,
    aria_laser,
    published,
    topics_of,
)
from pioneer3.state import Battery, Bumpers, Charging, Inputs, Motors, Scan, Sonar
from tests.unit.ros.support import P3AT, Blank, seen, update

ROSARIA = {
    "~cmd_vel": "geometry_msgs/Twist",
    "~pose": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "~bumper_state": "rosaria/BumperState",
    "~battery_voltage": "std_msgs/Float64",
    "~sonar": "sensor_msgs/PointCloud",
    "~sonar_pointcloud2": "sensor_msgs/PointCloud2",
    "~battery_recharge_state": "std_msgs/Int8",
    "~motors_state": "std_msgs/Bool",
    "~battery_state_of_charge": "std_msgs/Float32",
}
CAMERA = {
    "camera/image_raw": "sensor_msgs/Image",
    "camera/camera_info": "sensor_msgs/CameraInfo",
}
STANDARD = {
    "cmd_vel": "geometry_msgs/Twist",
    "odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/tf_static": "tf2_msgs/TFMessage",
    "joint_states": "sensor_msgs/JointState",
    "battery_state": "sensor_msgs/BatteryState",
    "sonar/points": "sensor_msgs/PointCloud2",
    "bumper_state": "rosaria/BumperState",
    "bumpers/points": "sensor_msgs/PointCloud2",
    "motors_state": "std_msgs/Bool",
    "emergency_stop": "std_msgs/Bool",
    "compass": "std_msgs/Float32",
    "dio": "std_msgs/UInt16",
    "aio": "std_msgs/Float32MultiArray",
    "imu/data_raw": "sensor_msgs/Imu",
    "scan": "sensor_msgs/LaserScan",
    **CAMERA,
    "/diagnostics": "diagnostic_msgs/DiagnosticArray",
    **{f"sonar/range_{number}": "sensor_msgs/Range" for number in range(16)},
}
P2OS = {
    "cmd_vel": "geometry_msgs/Twist",
    "pose": "nav_msgs/Odometry",
    "battery_state": "p2os_msgs/BatteryState",
    "motor_state": "p2os_msgs/MotorState",
    "sonar": "p2os_msgs/SonarArray",
    "dio": "p2os_msgs/DIO",
    "aio": "p2os_msgs/AIO",
}
LATCHED = {
    "~battery_recharge_state",
    "~motors_state",
    "/tf_static",
    "motors_state",
    "emergency_stop",
}


def rows(profile: Profile) -> dict[str, Topic]:
    """Return the topics of a P3-AT by name."""
    return {name: topic for topic in topics_of(P3AT) for name in topic.names(profile)}


def named(name: str) -> Topic:
    """Return the topic that has this name in any profile."""
    return rows(Profile.BOTH)[name]


def test_only_rosarias_name_has_bumpers_that_are_not_there() -> None:
    fills = {name: topic.fill for topic in TOPICS for name in topic.names(Profile.BOTH)}
    assert fills["~bumper_state"] is sensors.rosarias_bumpers
    assert fills["bumper_state"] is sensors.bumpers


def test_the_compatible_names_types_and_latches_are_rosarias() -> None:
    found = rows(Profile.COMPATIBILITY)
    assert {name: topic.type_name for name, topic in found.items()} == {
        **ROSARIA,
        "/tf_static": "tf2_msgs/TFMessage",  # which RosAria leaves out, so that nothing is shown
        "/diagnostics": "diagnostic_msgs/DiagnosticArray",
        "scan": "sensor_msgs/LaserScan",  # of lasers that somebody asked for
        **CAMERA,
    }


def test_the_standard_names_and_types_are_those_of_today() -> None:
    assert {name: topic.type_name for name, topic in rows(Profile.STANDARD).items()} == STANDARD


def test_both_at_once_is_all_of_them() -> None:
    both = {name: topic.type_name for name, topic in rows(Profile.BOTH).items()}
    assert both == {**ROSARIA, **STANDARD}
    assert {name for name, topic in rows(Profile.BOTH).items() if topic.latched} == LATCHED


@pytest.mark.parametrize(
    ("number", "kind", "protocol", "simulated", "name"),
    [
        (1, "lms2xx", None, True, "sim_lms2xx_1"),
        (1, "", None, True, "sim_lms2xx_1"),
        (1, "lms1XX", None, True, "sim_lms1xx_1"),
        (1, "s3series", None, True, "sim_S3Series_1"),
        (1, "lms2xx", LaserProtocol.LMS2XX, False, "lms2xx_1"),
        (1, "lms2xx", None, False, "lms2xx_1"),
        (1, "lms5XX", LaserProtocol.COLA, False, "lms5XX_1"),
        (1, "tim561", LaserProtocol.COLA, False, "tim561_1"),
        (1, "lms2xx", LaserProtocol.COLA, False, "lms1xx_1"),
        (1, "lms2xx", LaserProtocol.SCIP, False, "urg20_1"),
        (1, "urg2.0", LaserProtocol.SCIP, False, "urg20_1"),
        (1, "urg", LaserProtocol.SCIP, False, "urg_1"),
        (2, "lms2xx", LaserProtocol.SCIP, False, "urg20_2"),
    ],
)
def test_lasers_have_the_names_of_aria_in_rosarias_topics(
    number: int, kind: str, protocol: LaserProtocol | None, simulated: bool, name: str
) -> None:
    assert aria_laser(number, kind, protocol, simulated=simulated) == name
    topics = published(P3AT, MessageOptions(), Profile.COMPATIBILITY, aria={"laser": name})
    found = {name: each.type_name for each in topics for name in each.names(Profile.COMPATIBILITY)}
    assert found[f"~{name}_laserscan"] == "sensor_msgs/LaserScan"
    assert found[f"~{name}_pointcloud"] == "sensor_msgs/PointCloud"


def test_in_the_place_of_p2os_topics_have_its_names_and_types() -> None:
    found = {name: topic.type_name for name, topic in rows(Profile.P2OS).items()}
    assert {name: found[name] for name in P2OS} == P2OS
    assert "odom" not in found
    assert found.keys() - P2OS.keys() == STANDARD.keys() - {"odom"} - P2OS.keys()


def test_messages_of_p2os_have_what_the_robot_says() -> None:
    ranges = (1.0, inf, nan, *(2.0,) * 13)
    now = update(
        seen(
            sonar=Sonar(ranges=ranges, fresh=(0,)),
            inputs=Inputs(digital_in=0x1A5, digital_out=3, analog=2.5),
            motors=Motors(enabled=True),
        )
    )
    filled = {}
    for topic in P2OS_TOPICS:
        assert topic.p2os
        assert topic.fill
        assert topic.has_data(now)
        filled[topic.p2os] = Blank()
        topic.fill(filled[topic.p2os], now)
    assert filled["motor_state"].state == 1
    assert filled["battery_state"].voltage == 12.4
    assert filled["sonar"].ranges == [1.0, 5.0, 5.0, *[2.0] * 13]
    assert filled["sonar"].ranges_count == 16
    assert (filled["dio"].count, filled["dio"].bits) == (8, 0xA5)
    assert (filled["aio"].voltages_count, filled["aio"].voltages) == (1, [2.5])


def make(type_name: str) -> Blank:
    """Return an empty message."""
    return Blank(kind=type_name)


def update_of(source: type[Update]) -> Update:
    """Return an update of this kind."""
    if source is ScanUpdate:
        scan = Scan(
            stamp=5.0,
            sequence=1,
            sensor_in_robot=Pose2(),
            robot_in_odom=Pose2(),
            angles=(0.0,),
            ranges=(1.0,),
        )
        return ScanUpdate(scan=scan, frame="laser", stamp="now", make=make)
    if source is SensorUpdate:
        gyro = GyroReading(stamp=5.0, heading=0.0, rate=0.1, temperature_raw=0)
        return SensorUpdate(reading=gyro, frames=Frames(), stamp="now")
    if source is PictureUpdate:
        image = Image(np.zeros((24, 32, 3), np.uint8), stamp=5.0)
        return PictureUpdate(image=image, view=1.0, frame="camera_optical_frame", stamp="now")
    if source is DiagnosticsUpdate:
        return DiagnosticsUpdate(found=(), node="/n", hardware="h", stamp="now", make=make)
    if source is DescriptionUpdate:
        return DescriptionUpdate(urdf="<robot/>")
    return update(seen(sonar=Sonar(ranges=(1.0,) * 16), inputs=Inputs(compass=0.5)))


def test_every_row_fills_a_message_or_parses_one() -> None:
    for topic in topics_of(P3AT):
        commands = topic in (COMMANDS, STAMPED_COMMANDS)
        assert ((topic.fill is None), (topic.parse is None)) == (commands, not commands)
        if topic.fill:
            message = Blank()
            topic.fill(message, update_of(topic.source))
            assert vars(message)


FULL = seen(
    Pose2(1.0, 2.0, 3.0),
    Twist2(0.5, 0.2),
    left=0.4,
    right=0.6,
    battery=Battery(voltage=12.0, charge=0.5, charging=Charging.BULK),
    motors=Motors(enabled=True, moving=True),
    sonar=Sonar(ranges=(1.0,) * 16, fresh=tuple(range(16)), enabled=True),
    bumpers=Bumpers(front=(True,) * 5, rear=(False, True) * 3),
    inputs=Inputs(compass=0.5, digital_in=3, analog=1.0),
)
STANDS = seen(sonar=Sonar(ranges=(math.inf,) * 16))
WITH_WHEELS = MessageOptions(wheels_tf=True)


def scan_of(*ranges: float, reflectances: tuple[int, ...] = ()) -> ScanUpdate:
    scan = Scan(
        stamp=5.0,
        sequence=1,
        sensor_in_robot=Pose2(),
        robot_in_odom=Pose2(),
        angles=tuple(map(float, range(len(ranges)))),
        ranges=ranges,
        reflectances=reflectances,
    )
    return ScanUpdate(scan=scan, frame="laser", stamp="now", make=make)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (update(FULL, WITH_WHEELS, turned=(1.0, 2.0)), update(STANDS, WITH_WHEELS)),
        (update(STANDS, WITH_WHEELS), update(FULL, WITH_WHEELS, turned=(1.0, 2.0))),
        (scan_of(1.0, 2.0, 3.0, reflectances=(0, 1, 2)), scan_of(4.0, 5.0)),
        (scan_of(4.0, 5.0), scan_of(1.0, 2.0, 3.0, reflectances=(0, 1, 2))),
    ],
)
def test_a_message_that_is_filled_again_keeps_nothing(before: Update, after: Update) -> None:
    rows = [topic for topic in topics_of(P3AT) if topic.fill and topic.source is type(after)]
    assert rows
    for topic in rows:
        assert topic.fill is not None
        again, fresh = Blank(), Blank()
        for given in (before, after):
            topic.fill(again, given)
        topic.fill(fresh, after)
        assert again == fresh, topic.standard


def test_a_picture_that_is_filled_again_keeps_nothing() -> None:
    rows = [topic for topic in topics_of(P3AT) if topic.source is PictureUpdate]
    assert rows
    large = Image(np.ones((48, 64, 3), np.uint8), stamp=4.0)
    before = PictureUpdate(image=large, view=1.0, frame="f", stamp="before")
    small = Image(np.zeros((24, 32, 3), np.uint8), stamp=5.0)
    after = PictureUpdate(image=small, view=None, frame="f", stamp="now")
    for topic in rows:
        assert topic.fill is not None
        again, fresh = Blank(), Blank()
        topic.fill(again, before)
        topic.fill(again, after)
        topic.fill(fresh, after)
        assert again == fresh, topic.standard


def test_a_robot_without_sonars_has_no_topics_for_them() -> None:
    names = {
        name for topic in topics_of(load_model("amigo-sh")) for name in topic.names(Profile.BOTH)
    }
    assert {name for name in names if "range_" in name} == {f"sonar/range_{n}" for n in range(8)}


def test_a_transducer_is_told_of_when_it_was_read() -> None:
    now = update(seen(sonar=Sonar(ranges=(1.0,) * 16, fresh=(3, 4))))
    known = [number for number in range(16) if named(f"sonar/range_{number}").has_data(now)]
    assert known == [3, 4]
    assert not named("sonar/points").has_data(update(seen(sonar=Sonar(ranges=(1.0,) * 16))))


def test_what_a_robot_does_not_have_is_not_told() -> None:
    bare = update(seen(battery=Battery(voltage=0.0)))
    for name in ("bumpers/points", "compass", "battery_state", "~battery_state_of_charge"):
        assert not named(name).has_data(bare)
    whole = update(
        seen(
            battery=Battery(voltage=12.0, charge=0.5),
            bumpers=Bumpers(rear=(False,)),
            inputs=Inputs(compass=0.0),
        )
    )
    for name in ("bumpers/points", "compass", "battery_state", "~battery_state_of_charge"):
        assert named(name).has_data(whole)


def test_what_is_sent_on_change_changes_with_what_it_tells_of() -> None:
    recharge, motors = named("~battery_recharge_state").changes, named("~motors_state").changes
    assert recharge is not None
    assert motors is not None
    docked = Battery(voltage=12.0, charging=Charging.BULK)
    now = update(seen())
    assert recharge(now) != recharge(update(seen(battery=docked)))
    assert recharge(now) == recharge(update(seen(battery=Battery(voltage=9.0))))
    assert motors(now) != motors(update(seen(motors=Motors(enabled=True))))


def test_without_a_robot_nobody_hears_that_it_is_safe_to_drive() -> None:
    assert named("emergency_stop").when_lost is True
    assert named("motors_state").when_lost is False


def test_the_tree_of_frames_can_be_left_to_others() -> None:
    alone = MessageOptions(odometry_tf=False, description=False)
    assert not named("/tf").enabled(alone)
    assert not named("/tf_static").enabled(alone)
    assert named("/tf").enabled(MessageOptions(odometry_tf=False, wheels_tf=True))


def test_commands_are_private_only_where_rosaria_has_them_so() -> None:
    assert COMMANDS.names(Profile.COMPATIBILITY) == ("~cmd_vel",)
    assert COMMANDS.names(Profile.STANDARD) == ("cmd_vel",)
    assert COMMANDS.names(Profile.BOTH) == ("~cmd_vel", "cmd_vel")


def test_topics_that_the_options_do_not_want_are_not_published() -> None:
    names = {
        name
        for topic in published(P3AT, MessageOptions(ranges=False, cloud=False), Profile.STANDARD)
        for name in topic.names(Profile.STANDARD)
    }
    assert "odom" in names
    assert not {name for name in names if name.startswith("sonar")}
    assert "cmd_vel" not in names


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_tables_in_the_docs_are_up_to_date(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == filled(text), "run: uv run python -m docs.reference.ros_tables"
