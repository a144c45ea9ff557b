from pioneer3.models import load_model
from pioneer3.ros.interface.topics import TOPICS, Profile, Topic, command_names, topics_of
from pioneer3.ros.messages import convert
from pioneer3.ros.messages.conventions import Conventions
from pioneer3.state import Battery, Bumpers, Charging, Inputs, Motors, Sonar
from tests.unit.ros.support import P3AT, Blank, reading, seen

ROSARIA = {
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
STANDARD = {
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
    **{f"sonar/range_{number}": "sensor_msgs/Range" for number in range(16)},
}
"""facts.md 14.6; `scan`, `imu/data_raw` and `/diagnostics` do not come from readings."""
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
    assert fills["~bumper_state"] is convert.rosarias_bumpers
    assert fills["bumper_state"] is convert.bumpers


def test_the_compatible_names_types_and_latches_are_rosarias() -> None:
    found = rows(Profile.COMPATIBILITY)
    assert {name: topic.kind for name, topic in found.items()} == {
        **ROSARIA,
        "/tf_static": "tf2_msgs/TFMessage",  # which RosAria leaves out, so that nothing is shown
    }


def test_the_standard_names_and_types_are_those_of_today() -> None:
    assert {name: topic.kind for name, topic in rows(Profile.STANDARD).items()} == STANDARD


def test_both_at_once_is_all_of_them() -> None:
    both = {name: topic.kind for name, topic in rows(Profile.BOTH).items()}
    assert both == {**ROSARIA, **STANDARD}
    assert {name for name, topic in rows(Profile.BOTH).items() if topic.latched} == LATCHED


def test_every_row_fills_a_message() -> None:
    now = seen(sonar=Sonar(ranges=(1.0,) * 16), inputs=Inputs(compass=0.5))
    for topic in topics_of(P3AT):
        message = Blank()
        topic.fill(message, reading(now))
        assert vars(message)


def test_a_robot_without_sonars_has_no_topics_for_them() -> None:
    names = {
        name for topic in topics_of(load_model("amigo-sh")) for name in topic.names(Profile.BOTH)
    }
    assert {name for name in names if "range_" in name} == {f"sonar/range_{n}" for n in range(8)}


def test_a_transducer_is_told_of_when_it_was_read() -> None:
    now = reading(seen(sonar=Sonar(ranges=(1.0,) * 16, fresh=(3, 4))))
    known = [number for number in range(16) if named(f"sonar/range_{number}").known(now)]
    assert known == [3, 4]
    assert not named("sonar/points").known(reading(seen(sonar=Sonar(ranges=(1.0,) * 16))))


def test_what_a_robot_does_not_have_is_not_told() -> None:
    bare = reading(seen(battery=Battery(voltage=0.0)))
    for name in ("bumpers/points", "compass", "battery_state", "~battery_state_of_charge"):
        assert not named(name).known(bare)
    whole = reading(
        seen(
            battery=Battery(voltage=12.0, charge=0.5),
            bumpers=Bumpers(rear=(False,)),
            inputs=Inputs(compass=0.0),
        )
    )
    for name in ("bumpers/points", "compass", "battery_state", "~battery_state_of_charge"):
        assert named(name).known(whole)


def test_what_is_sent_on_change_changes_with_what_it_tells_of() -> None:
    recharge, motors = named("~battery_recharge_state").told, named("~motors_state").told
    assert recharge is not None
    assert motors is not None
    docked = Battery(voltage=12.0, charging=Charging.BULK)
    now = reading(seen())
    assert recharge(now) != recharge(reading(seen(battery=docked)))
    assert recharge(now) == recharge(reading(seen(battery=Battery(voltage=9.0))))
    assert motors(now) != motors(reading(seen(motors=Motors(enabled=True))))


def test_without_a_robot_nobody_hears_that_it_is_safe_to_drive() -> None:
    assert named("emergency_stop").unknown is True
    assert named("motors_state").unknown is False


def test_the_tree_of_frames_can_be_left_to_others() -> None:
    alone = Conventions(odometry_in_tree=False, description=False)
    assert not named("/tf").wanted(alone)
    assert not named("/tf_static").wanted(alone)
    assert named("/tf").wanted(Conventions(odometry_in_tree=False, wheels_in_tree=True))


def test_commands_are_private_only_where_rosaria_has_them_so() -> None:
    assert command_names(Profile.COMPATIBILITY, "cmd_vel") == ("~cmd_vel",)
    assert command_names(Profile.STANDARD, "cmd_vel") == ("cmd_vel",)
    assert command_names(Profile.BOTH, "cmd_vel") == ("~cmd_vel", "cmd_vel")
