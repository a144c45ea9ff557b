"""A robot that is all right passes; one that is wrong in one way fails for that, and only there."""

from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest

from pioneer3.doctor.facts import Level
from pioneer3.ros.checks.check import check
from pioneer3.ros.checks.facts import RobotFacts
from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, Qos
from pioneer3.ros.ros2.remapping import Remapping
from tests.unit.ros.checks.robot import NANO, NODE, TYPES, Network, now, pose, row, stamp, transform
from tests.unit.ros.ros2.memory import MemoryBackend

BEST_EFFORT = Qos(reliable=False)
Spoil = Callable[[Network], object]


async def test_a_robot_that_is_all_right_passes() -> None:
    report = await Network().checked()
    assert [each for each in report.rows if each.faults] == []
    assert report.count(Level.FAIL) == 0
    assert row(report, "odom").rate == pytest.approx(10, abs=0.3)
    assert row(report, "sonar/range_1").found.startswith("3.3 Hz")


async def test_parts_that_a_robot_may_lack_are_absent_and_not_wrong() -> None:
    the = Network()
    del the.topics["/robot1/scan"], the.services["/robot1/sonar/enable"]
    report = await the.checked()
    assert row(report, "scan").absent == "a laser range finder"
    assert row(report, "compass").absent == "a compass"
    assert row(report, "sonar/enable").absent == "sonars"
    assert report.count(Level.FAIL) == 0


def set_(name: str, path: str, value: object) -> Spoil:
    """Return the spoiler that sets a field in each message of a topic."""
    *parts, last = path.split(".")

    def change(message: Any) -> None:
        for part in parts:
            message = message.transforms[0] if part == "transforms" else getattr(message, part)
        setattr(message, last, value)

    return lambda the: the.change(name, change)


def covariance(value: float) -> Spoil:
    def change(message: Any) -> None:
        message.pose.covariance[:] = value

    return lambda the: the.change("odom", change)


def ranges(*values: float) -> Spoil:
    return set_("scan", "ranges", np.array(values, np.float32))


def stamped(name: str, moment: Callable[[int], int]) -> Spoil:
    """Return the spoiler that stamps each message of a topic, given the time."""

    def change(message: Any) -> None:
        part = message.transforms[0] if hasattr(message, "transforms") else message
        stamp(part.header.stamp, moment(now()))

    return lambda the: the.change(name, change)


def adds(name: str, *transforms: tuple[str, str]) -> Spoil:
    """Return the spoiler that adds transforms to those on `tf` or `tf_static`."""

    def change(message: Any) -> None:
        message.transforms += [transform(*each) for each in transforms]

    return lambda the: the.change(name, change)


def another_tree(the: Network) -> None:
    """Let another node publish the robot's pose, too."""
    writer = the.publisher("/robot1/tf", "tf2_msgs/TFMessage", "filter")

    def change(message: Any) -> None:
        other = TYPES.make("tf2_msgs/TFMessage")
        pose(other)
        writer.write(TYPES.encode(other))

    the.change("tf", change)


def bytes_of_another_type(the: Network) -> None:
    writer = the.publisher("/robot1/joint_states", "sensor_msgs/JointState")
    the.change("odom", lambda message: writer.write(b"\0\1\0\0abc"))


def diagnosed(the: Network) -> None:
    def change(message: Any) -> None:
        message.status[0].level, message.status[0].message = 2, "lost"

    the.change("/diagnostics", change)


SPOILED: dict[str, tuple[Spoil, str, Level, str]] = {
    "missing topic": (
        lambda the: the.topics.pop("/robot1/odom"),
        "odom",
        Level.FAIL,
        "nobody publishes it",
    ),
    "silent topic": (
        lambda the: the.change("odom", lambda message: False),
        "odom",
        Level.FAIL,
        "it is silent",
    ),
    "silent laser": (
        lambda the: the.change("scan", lambda message: False),
        "scan",
        Level.FAIL,
        "it is silent",
    ),
    "silent sonar": (
        lambda the: the.change("sonar/points", lambda message: False),
        "sonar/points",
        Level.WARN,
        "it is silent",
    ),
    "silent transducer": (
        lambda the: the.change("sonar/range_1", lambda message: False),
        "sonar/range_1",
        Level.WARN,
        "it is silent",
    ),
    "nothing latched": (
        lambda the: the.change("motors_state", lambda message: False),
        "motors_state",
        Level.FAIL,
        "a late subscriber hears nothing",
    ),
    "wrong type": (
        lambda the: the.again("motors_state", type_name="std_msgs/UInt8"),
        "motors_state",
        Level.FAIL,
        "the type is std_msgs/msg/UInt8, not std_msgs/msg/Bool",
    ),
    "best effort state": (
        lambda the: the.again("joint_states", qos=BEST_EFFORT),
        "joint_states",
        Level.FAIL,
        "reliability: best effort, not reliable",
    ),
    "best effort laser": (
        lambda the: the.again("scan", qos=BEST_EFFORT),
        "scan",
        Level.WARN,
        "reliability: best effort, not reliable",
    ),
    "not latched": (
        lambda the: the.again("emergency_stop", qos=Qos()),
        "emergency_stop",
        Level.FAIL,
        "durability: volatile, not transient local",
    ),
    "two publishers": (
        lambda the: the.publisher("/robot1/joint_states", "sensor_msgs/JointState", "gui"),
        "joint_states",
        Level.FAIL,
        "it has 2 publishers: /gui and /robot1/base",
    ),
    "slow": (
        lambda the: the.again("joint_states", every=5),
        "joint_states",
        Level.FAIL,
        "it comes too seldom",
    ),
    "a little slow": (
        lambda the: the.again("battery_state", every=13),
        "battery_state",
        Level.WARN,
        "it comes too seldom",
    ),
    "no type at all": (
        bytes_of_another_type,
        "joint_states",
        Level.FAIL,
        "it sends bytes that are no sensor_msgs/msg/JointState",
    ),
    "stamps of 0": (stamped("joint_states", lambda at: 0), "joint_states", Level.FAIL, "are 0"),
    "stamps ahead": (
        stamped("odom", lambda at: at + NANO),
        "odom",
        Level.FAIL,
        "stamps are in the future",
    ),
    "old stamps": (
        stamped("odom", lambda at: at - 2 * NANO),
        "odom",
        Level.FAIL,
        "stamps are old",
    ),
    "late stamps": (
        stamped("odom", lambda at: at - NANO // 2),
        "odom",
        Level.WARN,
        "stamps are late",
    ),
    "stamps that repeat": (
        stamped("odom", lambda at: at - at % (NANO // 4)),
        "odom",
        Level.FAIL,
        "stamps repeat",
    ),
    "stamps that go back": (
        stamped("odom", lambda at: at - (at // (NANO // 10) % 3) * NANO // 5),
        "odom",
        Level.FAIL,
        "stamps go back",
    ),
    "old transforms": (
        stamped("tf", lambda at: at - 2 * NANO),
        "tf",
        Level.FAIL,
        "odom → base_link: stamps are old",
    ),
    "empty frame": (
        set_("scan", "header.frame_id", ""),
        "scan",
        Level.FAIL,
        "frame_id is empty",
    ),
    "frame with a slash": (
        set_("scan", "header.frame_id", "/laser"),
        "scan",
        Level.FAIL,
        "frame_id /laser begins with a slash",
    ),
    "unreachable frame": (
        set_("scan", "header.frame_id", "lidar"),
        "scan",
        Level.FAIL,
        "no transform leads from base_link to lidar",
    ),
    "unusual frame": (
        set_("scan", "header.frame_id", "sonar_0"),
        "scan",
        Level.WARN,
        "frame_id is sonar_0",
    ),
    "no child frame": (
        set_("odom", "child_frame_id", ""),
        "odom",
        Level.FAIL,
        "child_frame_id is ''",
    ),
    "NaN in odometry": (
        set_("odom", "pose.pose.position.x", nan),
        "odom",
        Level.FAIL,
        "pose.pose.position.x is NaN",
    ),
    "infinite speed": (
        set_("odom", "twist.twist.linear.x", inf),
        "odom",
        Level.FAIL,
        "twist.twist.linear.x is infinite",
    ),
    "no rotation": (
        set_("odom", "pose.pose.orientation.w", 0.0),
        "odom",
        Level.FAIL,
        "pose.pose.orientation is no unit quaternion",
    ),
    "negative variance": (covariance(-1.5), "odom", Level.FAIL, "has a negative variance"),
    "NaN in a covariance": (covariance(nan), "odom", Level.FAIL, "has numbers that are NaN"),
    "certain odometry": (covariance(0.0), "odom", Level.WARN, "pose.covariance is all 0"),
    "NaN in a range": (
        set_("sonar/range_0", "range", nan),
        "sonar/range_0",
        Level.FAIL,
        "range is NaN",
    ),
    "range too long": (
        set_("sonar/range_0", "range", 9.0),
        "sonar/range_0",
        Level.WARN,
        "range is outside of min_range to max_range",
    ),
    "bounds in the wrong order": (
        set_("sonar/range_0", "min_range", 9.0),
        "sonar/range_0",
        Level.FAIL,
        "min_range is larger than max_range",
    ),
    "cone without width": (
        set_("sonar/range_0", "field_of_view", 0.0),
        "sonar/range_0",
        Level.WARN,
        "field_of_view is 0",
    ),
    "scan without ranges": (ranges(), "scan", Level.FAIL, "ranges is empty"),
    "too many ranges": (
        ranges(*[1.0] * 9),
        "scan",
        Level.FAIL,
        "angles and ranges do not agree",
    ),
    "scan of failures": (
        ranges(nan, nan, nan, 1.0, 1.0),
        "scan",
        Level.WARN,
        "most ranges are NaN",
    ),
    "scan that calls no echo 0": (
        ranges(0.0, 0.0, 0.0, 1.0, 1.0),
        "scan",
        Level.WARN,
        "most ranges are outside of range_min to range_max",
    ),
    "intensities": (
        set_("scan", "intensities", np.ones(2, np.float32)),
        "scan",
        Level.FAIL,
        "intensities and ranges differ in number",
    ),
    "no voltage": (
        set_("battery_state", "voltage", nan),
        "battery_state",
        Level.FAIL,
        "voltage is NaN",
    ),
    "infinite current": (
        set_("battery_state", "current", inf),
        "battery_state",
        Level.FAIL,
        "current is infinite",
    ),
    "per cent": (
        set_("battery_state", "percentage", 80.0),
        "battery_state",
        Level.FAIL,
        "percentage is not from 0 to 1",
    ),
    "joints without names": (
        set_("joint_states", "name", ["left"]),
        "joint_states",
        Level.FAIL,
        "name and position differ in number",
    ),
    "joints of one name": (
        set_("joint_states", "name", ["left", "left"]),
        "joint_states",
        Level.FAIL,
        "two joints have one name",
    ),
    "NaN in a dense cloud": (
        set_("sonar/points", "data", np.full(6, nan, np.float32).view(np.uint8)),
        "sonar/points",
        Level.FAIL,
        "is_dense, but x is not finite everywhere",
    ),
    "cloud of the wrong size": (
        set_("sonar/points", "row_step", 36),
        "sonar/points",
        Level.FAIL,
        "its sizes do not agree",
    ),
    "orientation of an IMU": (
        set_("imu/data_raw", "orientation_covariance", np.zeros(9)),
        "imu/data_raw",
        Level.FAIL,
        "orientation is no unit quaternion",
    ),
    "error in diagnostics": (diagnosed, "/diagnostics", Level.WARN, "it says of Link: lost"),
    "no pose on tf": (
        set_("tf", "transforms.child_frame_id", "laser"),
        "tf",
        Level.FAIL,
        "there is no odom → base_link",
    ),
    "no rotation on tf": (
        set_("tf", "transforms.transform.rotation.w", 0.5),
        "tf",
        Level.FAIL,
        "transforms[base_link].transform.rotation is no unit quaternion",
    ),
    "slash in a frame of tf": (
        adds("tf_static", ("base_link", "/camera")),
        "tf_static",
        Level.FAIL,
        "the frame /camera begins with a slash",
    ),
    "its own parent": (
        adds("tf_static", ("arm", "arm")),
        "tf_static",
        Level.FAIL,
        "arm is its own parent",
    ),
    "frame without a name": (
        adds("tf_static", ("", "arm")),
        "tf_static",
        Level.FAIL,
        "a transform has a frame without a name",
    ),
    "two parents": (
        adds("tf_static", ("imu_link", "laser")),
        "tf",
        Level.FAIL,
        "laser has several parents: base_link by /robot1/base; imu_link by /robot1/base",
    ),
    "two publishers of a transform": (
        another_tree,
        "tf",
        Level.FAIL,
        "odom → base_link has several publishers: /filter and /robot1/base",
    ),
    "static and moving": (
        adds("tf", ("base_link", "laser")),
        "tf",
        Level.FAIL,
        "base_link → laser is static and moves, too",
    ),
    "a static pose": (
        adds("tf_static", ("odom", "base_link")),
        "tf_static",
        Level.FAIL,
        "odom → base_link is static, though it moves",
    ),
    "a circle": (
        adds("tf", ("laser", "odom")),
        "tf",
        Level.FAIL,
        "transforms go in a circle",
    ),
    "no XML": (
        set_("robot_description", "data", "<robot>"),
        "robot_description",
        Level.FAIL,
        "it is no XML",
    ),
    "no URDF": (
        set_("robot_description", "data", "<sdf/>"),
        "robot_description",
        Level.FAIL,
        "it is no URDF: its root is <sdf>",
    ),
    "a link nowhere": (
        set_("robot_description", "data", "<robot><link name='arm'/></robot>"),
        "robot_description",
        Level.WARN,
        "no transform for arm",
    ),
    "no service": (
        lambda the: the.services.pop("/robot1/e_stop_trigger"),
        "e_stop_trigger",
        Level.FAIL,
        "nobody offers it",
    ),
    "service of another type": (
        lambda the: the.services.update({"/robot1/enable_motors": "std_srvs/Empty"}),
        "enable_motors",
        Level.FAIL,
        "its type is std_srvs/srv/Empty, not std_srvs/srv/Trigger",
    ),
    "commands of the wrong type": (
        lambda the: the.publisher("/robot1/cmd_vel", "geometry_msgs/TwistStamped", "nav"),
        "cmd_vel",
        Level.FAIL,
        "publisher /nav sends geometry_msgs/msg/TwistStamped: nothing arrives",
    ),
    "best effort commands": (
        lambda the: the.publisher("/robot1/cmd_vel", "geometry_msgs/Twist", "nav", BEST_EFFORT),
        "cmd_vel",
        Level.FAIL,
        "publisher /nav does not match, reliability",
    ),
    "a subscriber of another type": (
        lambda the: the.subscriber("/robot1/odom", "std_msgs/String"),
        "odom",
        Level.WARN,
        "subscriber /other expects std_msgs/msg/String: nothing arrives",
    ),
    "a subscriber that wants latched odometry": (
        lambda the: the.subscriber("/robot1/odom", "nav_msgs/Odometry", Qos(transient_local=True)),
        "odom",
        Level.WARN,
        "subscriber /other does not match, durability",
    ),
    "no commands taken": (
        lambda the: setattr(the, "commands", "std_msgs/String"),
        "cmd_vel",
        Level.FAIL,
        "the type is std_msgs/msg/String, not geometry_msgs/msg/Twist",
    ),
}


@pytest.mark.parametrize("how", SPOILED)
async def test_a_robot_that_is_wrong_is_told_so(how: str) -> None:
    spoil, name, level, reason = SPOILED[how]
    the = Network()
    spoil(the)
    found = row(await the.checked(), name)
    assert any(each.level is level and reason in each.reason for each in found.faults), found


async def test_a_fault_of_one_topic_leaves_the_others_right() -> None:
    the = Network()
    set_("scan", "header.frame_id", "lidar")(the)
    report = await the.checked()
    assert [each.name for each in report.rows if each.faults] == ["/robot1/scan"]


async def test_a_fault_in_all_messages_is_told_once_with_their_number() -> None:
    the = Network()
    set_("odom", "pose.pose.orientation.w", 0.5)(the)
    (fault,) = row(await the.checked(), "odom").faults
    assert fault.example.startswith("its length is 0.5; ")
    assert fault.example.endswith(" messages")


async def test_a_topic_that_ends_while_somebody_listens_is_a_fault() -> None:
    the, ticks = Network(), list(range(20))
    the.change("odom", lambda message: bool(ticks) and ticks.pop() >= 0)
    found = row(await the.checked(), "odom")
    assert found.level is Level.FAIL
    assert "it has fallen silent" in [fault.reason for fault in found.faults]


async def test_a_topic_that_pauses_is_worth_a_look() -> None:
    the, ticks = Network(), list(range(200))
    the.change("odom", lambda message: ticks.pop() % 20 < 12)
    reasons = [fault.reason for fault in row(await the.checked(), "odom").faults]
    assert "it pauses" in reasons


async def test_commands_may_be_stamped_and_the_other_topic_is_plain_then() -> None:
    the = Network(commands="geometry_msgs/TwistStamped")
    found = await the.checked()
    assert row(found, "cmd_vel").expected == "geometry_msgs/msg/TwistStamped"
    assert row(found, "cmd_vel").faults == ()
    assert row(found, "cmd_vel_unstamped").absent == "commands of both types"


async def test_topics_stand_in_for_services() -> None:
    the = Network()
    the.services.clear()
    for name in ("enable_motors", "disable_motors", "e_stop_trigger"):
        the.subscriber(f"/robot1/{name}", "std_msgs/Empty")
    the.subscriber("/robot1/e_stop_reset", "std_msgs/Bool")
    report = await the.checked()
    assert row(report, "enable_motors").found == "topic of std_msgs/msg/Empty"
    assert row(report, "enable_motors").faults == ()
    (fault,) = row(report, "e_stop_reset").faults
    assert fault.reason == "the topic in its place is of std_msgs/msg/Bool"


async def test_the_model_tells_how_many_sonars_there_are() -> None:
    report = await Network().checked(transducers=3)
    assert row(report, "sonar/range_1").faults == ()
    (fault,) = row(report, "sonar/range_2").faults
    assert fault.reason == "nobody publishes it"


async def test_a_gap_between_sonars_is_a_fault() -> None:
    the = Network()
    del the.topics["/robot1/sonar/range_0"]
    assert row(await the.checked(), "sonar/range_0").level is Level.FAIL


async def test_remapped_topics_are_found_by_rules_and_named_without() -> None:
    the = Network()
    the.topics["/robot1/odometry"] = the.topics.pop("/robot1/odom")
    (fault,) = row(await the.checked(), "odom").faults
    assert "-r odom:=/robot1/odometry" in fault.advice
    rules = (Remapping("odom", "/robot1/odometry"),)
    assert row(await the.checked(rules=rules), "odometry").faults == ()


async def test_frames_may_have_a_prefix() -> None:
    the = Network()

    def prefix(message: Any) -> None:
        for each in getattr(message, "transforms", [message]):
            each.header.frame_id = f"robot1/{each.header.frame_id}"
            if hasattr(each, "child_frame_id"):
                each.child_frame_id = f"robot1/{each.child_frame_id}"

    with_frames = ("odom", "scan", "imu/data_raw", "sonar/points", "sonar/range_0", "sonar/range_1")
    for name in (*with_frames, "tf", "tf_static"):
        the.change(name, prefix)
    for name in ("tf", "tf_static"):
        the.topics[f"/{name}"] = the.topics.pop(f"/robot1/{name}")
        the.changes[f"/{name}"] = the.changes.pop(f"/robot1/{name}")
    report = await the.checked()
    assert [each for each in report.rows if each.faults] == []
    assert row(report, "/tf").found.startswith("10")


async def test_stamps_are_those_of_the_clock_where_the_node_takes_that() -> None:
    the = Network()
    kind = TYPES.message_type("rosgraph_msgs/Clock")
    node = MemoryBackend(the.memory, NODE)
    node.subscribe("/clock", kind, Qos(), lambda cdr, gid: None, lambda gid: None)
    silent = await the.checked()
    assert "nobody publishes that" in row(silent, "/robot1/base").faults[0].reason
    writer = the.publisher("/clock", "rosgraph_msgs/Clock", "simulator")

    def tick(message: Any) -> None:
        clock = TYPES.make("rosgraph_msgs/Clock")
        stamp(clock.clock, now() - 3600 * NANO)
        writer.write(TYPES.encode(clock))

    the.change("joint_states", tick)
    report = await the.checked()
    assert row(report, "/robot1/base").faults == ()
    assert "future" in row(report, "odom").faults[0].reason


def facts(graph: Graph) -> RobotFacts:
    return RobotFacts(node=NODE, graph=graph, heard={}, ended=0.0, types=TYPES, strict=True)


def test_two_nodes_of_one_name_are_told() -> None:
    twice = check(facts(Graph((NODE.full, NODE.full))))
    assert row(twice, NODE.full).faults[0].reason == "2 nodes have this name"
    assert row(check(facts(Graph((NODE.full,)))), NODE.full).faults == ()


def test_two_servers_of_one_name_are_told() -> None:
    server = Endpoint(
        kind=EndpointKind.SERVER,
        node="/a",
        name="/robot1/self_test",
        type_name="std_srvs/srv/Trigger",
    )
    both = check(facts(Graph(endpoints=(server, replace(server, node="/b")))))
    (fault,) = row(both, "self_test").faults
    assert fault.reason == "several nodes offer it: /a and /b"


def test_another_version_of_a_type_is_told() -> None:
    type_ = TYPES.message_type("nav_msgs/Odometry")
    odom = Endpoint(
        kind=EndpointKind.PUBLISHER,
        node=NODE.full,
        name="/robot1/odom",
        type_name=type_.name,
        type_hash="RIHS01_0",
    )
    reasons = [each.reason for each in row(check(facts(Graph(endpoints=(odom,)))), "odom").faults]
    assert "the version of nav_msgs/msg/Odometry is another" in reasons
    same = replace(odom, type_hash=type_.hash)
    reasons = [each.reason for each in row(check(facts(Graph(endpoints=(same,)))), "odom").faults]
    assert not any("version" in each for each in reasons)


def test_quality_of_service_that_parts_nobody_is_worth_a_look_only() -> None:
    odom = Endpoint(
        kind=EndpointKind.PUBLISHER,
        node=NODE.full,
        name="/robot1/odom",
        type_name="nav_msgs/msg/Odometry",
        qos=BEST_EFFORT,
    )
    over_zenoh = replace(facts(Graph(endpoints=(odom,))), strict=False)
    levels = {each.reason: each.level for each in row(check(over_zenoh), "odom").faults}
    assert levels["reliability: best effort, not reliable"] is Level.WARN


async def test_names_of_others_do_nothing_to_a_terminal() -> None:
    the = Network()
    set_("scan", "header.frame_id", "\x1b[2Jlidar")(the)
    found = row(await the.checked(), "scan")
    assert "\x1b" not in found.found + found.faults[0].reason
