"""Bags made of a log have what the nodes publish: names, types, frames, stamps and numbers."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from math import isnan
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag2 import Reader as Ros2Reader

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.log.reader import open_log
from pioneer3.log.topics import LogEvent
from pioneer3.models import load_model
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.recording import EstimateMade, MapUsed
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.ros.bag.convert import BagKind, write_bag
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.topics import COMMANDS, topics_of
from pioneer3.ros.ros2.distros import DEFAULT, distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.ros.typestore import full_name
from pioneer3.runtime.recording import (
    EMERGENCY_STOP,
    RESET,
    CommandGiven,
    DecisionMade,
    StandsBecause,
)
from tests.logs import BEGAN, READINGS, SECOND, Message, drive, scan, snapshot, write_log

ROS1, ROS2 = Ros1Types(), MessageTypes(distro_of(DEFAULT))
MAP = "2D-Map\nLineMinPos: 0 0\nLineMaxPos: 2000 1000\nNumLines: 1\nLINES\n0 0 2000 0\n"
Messages = dict[str, list[tuple[int, Any]]]


class Bag:
    """A bag as rosbags reads it: its messages by topic, and their types."""

    def __init__(self, path: Path) -> None:
        ros_1 = path.suffix == ".bag"
        reader: Any = (Ros1Reader if ros_1 else Ros2Reader)(path)
        decode = ROS1.decode if ros_1 else ROS2.decode
        self.messages: Messages = defaultdict(list)
        with reader:
            self.types = {each.topic: each.msgtype for each in reader.connections}
            self.connections = {each.topic: each for each in reader.connections}
            for connection, time, data in reader.messages():
                message = decode(bytes(data), connection.msgtype)
                self.messages[connection.topic].append((time, message))

    def of(self, topic: str) -> list[Any]:
        return [message for _, message in self.messages[topic]]

    def edges(self) -> set[tuple[str, str]]:
        """Return parent and child of all transforms."""
        return {
            (each.header.frame_id, each.child_frame_id)
            for message in (*self.of("/tf"), *self.of("/tf_static"))
            for each in message.transforms
        }


def converted(
    folder: Path,
    messages: Iterable[Message],
    kind: BagKind = BagKind.ROS2,
    profile: Profile = Profile.ROS2,
    **more: Any,
) -> Bag:
    robots = more.pop("robots", None)
    log = write_log(folder / "a.mcap", messages, robots)
    path = folder / ("a.bag" if kind is BagKind.ROS1 else "bag")
    counts = write_bag(open_log(log), path, kind, profile, **more).counts
    bag = Bag(path)
    assert counts == {topic: len(each) for topic, each in bag.messages.items()}
    return bag


def nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * SECOND + int(stamp.nanosec)


@pytest.mark.parametrize(
    ("kind", "profile"),
    [
        (BagKind.ROS2, Profile.ROS2),
        (BagKind.ROS1, Profile.COMPATIBILITY),
        (BagKind.ROS1, Profile.STANDARD),
        (BagKind.ROS1, Profile.BOTH),
        (BagKind.ROS1, Profile.P2OS),
    ],
)
def test_the_topics_are_those_of_the_table_with_their_types(
    kind: BagKind, profile: Profile, tmp_path: Path
) -> None:
    bag = converted(tmp_path, drive(lasers=["laser"]), kind, profile)
    table = {
        name.replace("~", "/RosAria/") if name[0] in "~/" else f"/{name}": topic.type_name
        for topic in (*topics_of(load_model("p3at-sh")), *NAVIGATION_TOPICS)
        for name in topic.names(profile)
    }
    assert bag.types == {topic: full_name(table[topic]) for topic in bag.types}
    (commands,) = (each for each in COMMANDS.names(profile)[:1])
    for name in ("/scan", "/tf", commands.replace("~", "/RosAria/")):
        assert name in bag.messages or f"/{name}" in bag.messages


def test_the_numbers_are_those_of_the_log(tmp_path: Path) -> None:
    bag = converted(tmp_path, drive(lasers=["laser"]))
    for number, (time, message) in enumerate(bag.messages["/odom"]):
        at = 0.02 + number / 10
        known = snapshot(at)
        pose, position = known.odometry.robot_in_odom, message.pose.pose.position
        assert time == BEGAN + round(at * SECOND)
        assert nanoseconds(message.header.stamp) == pytest.approx(time - 0.002 * SECOND, abs=1000)
        assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_footprint")
        assert (position.x, position.y) == (pose.x, pose.y)
        turn = message.pose.pose.orientation
        assert 2 * np.arctan2(turn.z, turn.w) == pytest.approx(pose.theta, abs=1e-12)
        assert message.twist.twist.linear.x == 0.3
        assert message.pose.covariance[0] == 1e-3
    assert len(bag.messages["/odom"]) == 31
    (found,) = {str(message.ranges) for message in bag.of("/scan")}
    assert found == str(np.array(READINGS, np.float32))
    first = bag.of("/scan")[0]
    assert (first.header.frame_id, first.range_min) == ("laser", np.float32(0.02))
    battery = bag.of("/battery_state")[0]
    assert (battery.voltage, battery.percentage) == (np.float32(12.3), 0.75)
    assert isnan(battery.current)
    assert [message.linear.x for message in bag.of("/cmd_vel")] == [0.3] * 4
    assert bag.of("/sonar/range_0")[0].range == 0.5
    assert bag.of("/sonar/range_1")[0].range == 5.0
    assert len(bag.messages["/motors_state"]) == 1


def test_each_robot_at_a_port_has_the_sonars_of_its_model(tmp_path: Path) -> None:
    amigo, p3at = load_model("amigo-sh"), load_model("p3at-sh")
    messages = [(0.0, "model", amigo), *drive(), (1.5, "model", p3at)]
    bag = converted(tmp_path, sorted(messages, key=itemgetter(0)))
    frames = [{each.child_frame_id for each in tree.transforms} for tree in bag.of("/tf_static")]
    assert "sonar_9" not in str(frames[0])
    assert "sonar_9" in str(frames[-1])


def test_the_place_on_the_map_is_that_of_the_newest_estimate(tmp_path: Path) -> None:
    office = MapUsed(name="office", file="", sha256="", text=MAP)
    bag = converted(tmp_path, [(0.0, "map", office), *drive()])
    odom_in_map = Pose2(5.0, 6.0, 0.5)
    place = odom_in_map @ snapshot(0.02).odometry.robot_in_odom
    told = bag.of("/amcl_pose")[0]
    assert (told.pose.pose.position.x, told.pose.pose.position.y) == (place.x, place.y)
    assert told.pose.covariance[[0, 7, 35]] == pytest.approx([0.01, 0.01, 0.0004])
    assert {("map", "odom"), ("odom", "base_footprint")} <= bag.edges()
    stamps = {
        each.child_frame_id: nanoseconds(each.header.stamp)
        for each in bag.of("/tf")[0].transforms
        if each.child_frame_id in {"odom", "base_footprint"}
    }
    assert stamps["odom"] - stamps["base_footprint"] == pytest.approx(0.1 * SECOND, abs=1000)
    assert [pose.pose.position.x for pose in bag.of("/plan")[0].poses] == [5.0, 6.0]
    (grid,) = bag.of("/map")
    assert grid.info.resolution == np.float32(0.05)
    assert (grid.data == 100).sum() >= 40


def test_a_robot_that_may_be_anywhere_has_no_place(tmp_path: Path) -> None:
    lost = EstimateMade(
        map="office", robot_in_map=None, odom_in_map=Pose2(), sure=False, spread=float("inf")
    )
    messages = [each for each in drive() if each[1] != "estimate"]
    bag = converted(tmp_path, [(0.0, "estimate", lost), *messages])
    assert ("map", "odom") not in bag.edges()
    assert "/amcl_pose" not in bag.messages


def test_several_robots_have_namespaces_and_one_tree_of_frames(tmp_path: Path) -> None:
    robots = {"bob": "p3at-sh", "Ännie 2": "p3dx-sh"}
    messages = [each for robot in robots for each in drive(robot=robot, lasers=["laser"])]
    bag = converted(tmp_path, sorted(messages, key=lambda each: each[0]), robots=robots)
    shared = {"diagnostics", "tf", "tf_static"}
    assert {topic.split("/")[1] for topic in bag.messages} == {"bob", "nnie_2", *shared}
    assert len(bag.messages["/bob/odom"]) == len(bag.messages["/nnie_2/odom"]) == 31
    assert bag.of("/nnie_2/scan")[0].header.frame_id == "nnie_2/laser"
    wheels = {child for _, child in bag.edges() if child.endswith("wheel")}
    assert wheels >= {"bob/front_left_wheel", "nnie_2/left_wheel"}
    assert ("map", "bob/odom") in bag.edges()


def test_each_laser_has_its_topic_and_its_frame(tmp_path: Path) -> None:
    later = replace(scan(2.0, "laser2"), sensor_in_robot=Pose2(-0.2, 0.0, 3.0))
    bag = converted(tmp_path, [*drive(lasers=["laser"]), (2.0, "scan/laser2", later)])
    assert len(bag.messages["/scan"]) == 31
    assert bag.of("/scan2")[0].header.frame_id == "laser2"
    (tree,) = bag.of("/tf_static")  # from the beginning with both
    places = {each.child_frame_id: each.transform.translation.x for each in tree.transforms}
    assert (places["laser"], places["laser2"]) == (0.16, -0.2)


def test_a_laser_that_is_none_is_left_out(tmp_path: Path) -> None:
    bag = converted(tmp_path, [*drive(), (1.0, "scan/../x", scan(1.0, "../x"))])
    assert not any("scan" in topic or "x" in topic for topic in bag.messages)


def test_the_emergency_stop_lasts_until_it_is_reset_or_the_robot_obeys_again(
    tmp_path: Path,
) -> None:
    def bag(freed: CommandGiven, folder: str) -> list[bool]:
        stop = CommandGiven("", EMERGENCY_STOP)
        refused = replace(CommandGiven("program", "drive"), refused="latched")
        told = [(0.1, stop), (0.3, refused), (0.5, CommandGiven("", "motors on")), (0.7, freed)]
        seen = [(each, "snapshot", snapshot(each)) for each in (0.0, 0.2, 0.4, 0.6, 0.8)]
        commands = [(at, "command", given) for at, given in told]
        made = converted(_made(tmp_path / folder), sorted([*seen, *commands], key=itemgetter(0)))
        return [message.data for message in made.of("/emergency_stop")]

    held = [False, True, True, True, False]
    assert bag(CommandGiven("", RESET), "reset") == held
    assert bag(CommandGiven("keyboard", "drive"), "driven") == held


def test_commands_that_were_refused_or_ask_for_no_speed_are_no_velocity_commands(
    tmp_path: Path,
) -> None:
    commands = [
        CommandGiven("keyboard", "let go"),
        replace(CommandGiven("program", "drive", seconds=0.5), refused="the motors are off"),
    ]
    given = [(1.0 + i, "command", each) for i, each in enumerate(commands)]
    bag = converted(tmp_path, [(0.0, "snapshot", snapshot(0.0)), *given])
    assert "/cmd_vel" not in bag.messages


def test_latched_topics_are_marked_and_quality_is_as_the_node_offers_it(tmp_path: Path) -> None:
    bag = converted(tmp_path, drive(1))
    qualities = {
        topic: (each.ext.offered_qos_profiles[0].durability.name, each.digest)
        for topic, each in bag.connections.items()
    }
    assert qualities["/tf_static"][0] == "TRANSIENT_LOCAL"
    assert qualities["/odom"] == ("VOLATILE", ROS2.message_type("nav_msgs/Odometry").hash)
    old = converted(_made(tmp_path / "old"), drive(1), BagKind.ROS1, Profile.COMPATIBILITY)
    latched = {topic for topic, each in old.connections.items() if each.ext.latching}
    assert latched >= {"/tf_static", "/RosAria/motors_state"}
    assert "/RosAria/pose" not in latched
    assert old.connections["/RosAria/pose"].ext.callerid == "/RosAria"


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder


def test_a_type_that_nobody_knows_is_said_and_a_model_helps(tmp_path: Path) -> None:
    log = open_log(write_log(tmp_path / "a.mcap", drive(1), {"": "r2d2"}))
    warnings = write_bag(log, tmp_path / "bag", BagKind.ROS2, Profile.ROS2).warnings
    assert len(warnings) == 1
    assert "'r2d2', which nobody knows" in warnings[0]
    given = write_bag(log, tmp_path / "other", BagKind.ROS2, Profile.ROS2, model="p3dx-sh")
    assert not given.warnings
    assert "/sonar/range_3" in given.counts


def test_a_log_without_a_robot_is_refused(tmp_path: Path) -> None:
    log = open_log(write_log(tmp_path / "a.mcap", [(0.0, "wire/robot/in", b"x")]))
    with pytest.raises(ConfigError, match="no robot in it"):
        write_bag(log, tmp_path / "bag", BagKind.ROS2, Profile.ROS2)
    assert [each.name for each in tmp_path.iterdir()] == ["a.mcap"]


def test_numbers_that_no_robot_sends_end_with_a_sentence_and_leave_nothing(tmp_path: Path) -> None:
    wild = replace(snapshot(0.0), stamp=1e300)
    log = open_log(write_log(tmp_path / "a.mcap", [(0.0, "snapshot", wild)]))
    for kind, profile in ((BagKind.ROS2, Profile.ROS2), (BagKind.ROS1, Profile.BOTH)):
        with pytest.raises(ConfigError, match="a message of snapshot that is none"):
            write_bag(log, tmp_path / "a.bag", kind, profile)
    assert [each.name for each in tmp_path.iterdir()] == ["a.mcap"]


def test_the_real_time_of_a_log_counts_and_not_that_of_the_computer(tmp_path: Path) -> None:
    bag = converted(tmp_path, drive(1), BagKind.ROS1, Profile.COMPATIBILITY)
    time, message = bag.messages["/RosAria/pose"][0]
    assert time == BEGAN + round(0.02 * SECOND)
    assert nanoseconds(message.header.stamp) == pytest.approx(time - 0.002 * SECOND, abs=1000)
    assert message.header.frame_id == "odom"
    assert message.child_frame_id == "base_link"


def parts(message: Any) -> dict[str, Any]:
    """Return the states of a diagnosis by the names of the parts."""
    return {each.name.partition(": ")[2]: each for each in message.status}


def test_a_diagnosis_of_each_part_comes_once_a_second_also_of_a_lost_robot(tmp_path: Path) -> None:
    stands = StandsBecause(Reason(ReasonKind.FAULT, "It is held."))
    made = Decision(contributions=(Contribution("keyboard", "v", 0.0, 1.0, ""),))
    lost = [
        (3.5, "event", LogEvent("link", "robot: lost: the cable is out")),
        (3.6, "event", LogEvent("link", "laser: lost: no scans")),
        (7.5, "event", LogEvent("link", "robot: connected: again")),
    ]
    log = [
        *drive(lasers=["laser"]),
        (3.1, "standing", stands),
        (3.1, "decision", DecisionMade("", made, ())),
        *lost,
        (8.6, "snapshot", snapshot(8.6)),
    ]
    for kind, profile in ((BagKind.ROS2, Profile.ROS2), (BagKind.ROS1, Profile.STANDARD)):
        bag = converted(_made(tmp_path / kind), log, kind, profile)
        times = [time for time, _ in bag.messages["/diagnostics"]]
        assert times == [BEGAN + round(0.02 * SECOND) + each * SECOND for each in range(9)]
        first, *_, gone, last = map(parts, bag.of("/diagnostics"))
        assert [*first] == [
            *("Link", "Motors", "Battery", "Sonar", "Odometry", "Command"),
            *("Laser", "Localization", "Navigation"),
        ]
        assert {each.hardware_id for each in first.values()} == {"bob"}
        assert first["Battery"].message == "12.3 V"
        assert {each.key: each.value for each in first["Localization"].values}["stage"] == "sure"
        assert gone["Link"].message == "no robot is connected: the cable is out"
        assert [gone[each].level for each in ("Link", "Motors", "Laser")] == [2, 3, 2]
        assert gone["Laser"].message == "no scans"
        assert last["Link"].level == 0
        values = {each.key: each.value for each in last["Command"].values}
        assert last["Command"].message == "It is held."
        assert values["driver"] == "keyboard"
        stopped = [message.data for message in bag.of("/emergency_stop")]
        assert stopped == [False] * 31 + [True] * 5 + [False]


def test_a_log_that_says_nothing_for_a_month_has_ten_minutes_of_diagnoses(tmp_path: Path) -> None:
    bag = converted(tmp_path, [(at, "snapshot", snapshot(at)) for at in (0.0, 30 * 86_400.0)])
    assert len(bag.of("/diagnostics")) == 602


def test_goals_are_told_as_the_node_tells_them_whoever_gave_them(tmp_path: Path) -> None:
    kitchen = Destination(x=3.0, y=4.0, heading=0.5, name="kitchen")

    def changed(number: int, status: str, reason: str = "") -> GoalChanged:
        return GoalChanged(
            number=number,
            by="ann",
            places=(Destination(x=0.0, y=0.0), kitchen),
            status=status,
            reason=reason,
            speed=None,
            rounds=1,
        )

    goals: list[Message] = [
        (0.5, "goal", changed(1, "accepted")),
        (0.55, "goal", changed(1, "executing")),
        (1.0, "goal", changed(1, "canceled", "another goal came")),
        (1.0, "goal", changed(2, "accepted")),
        (1.05, "goal", changed(2, "executing")),
        (2.5, "goal", changed(2, "aborted", "a wall")),
    ]
    log = sorted([*drive(9), *goals], key=itemgetter(0))
    bag = converted(_made(tmp_path / "1"), log, BagKind.ROS1, Profile.COMPATIBILITY)
    sent = bag.of("/move_base/goal")
    assert len(sent) == 2
    for each in sent:
        place = each.goal.target_pose
        assert (place.header.frame_id, place.pose.position.x) == ("map", 3.0)
        assert (each.goal_id.stamp, place.header.stamp) == (each.header.stamp,) * 2
    results = bag.of("/move_base/result")
    assert [(each.status.status, each.status.text) for each in results] == [
        (2, "another goal came"),
        (4, "a wall"),
    ]
    assert [each.status.goal_id.id for each in results] == [each.goal_id.id for each in sent]
    fed = bag.messages["/move_base/feedback"]
    assert BEGAN + 0.5 * SECOND < fed[0][0] < fed[-1][0] < BEGAN + 2.5 * SECOND
    assert len(fed) == 20
    where = fed[0][1].feedback.base_position.pose.position
    expected = Pose2(5.0, 6.0, 0.5) @ snapshot(0.52).odometry.robot_in_odom
    assert (where.x, where.y) == (expected.x, expected.y)
    lists = bag.messages["/move_base/status"]
    states = [[each.status for each in message.status_list] for _, message in lists]
    assert [*dict.fromkeys(map(tuple, states))] == [(), (1,), (2,), (2, 1), (2, 4), (4,)]
    assert states[-1] == []
    pauses = np.diff([time for time, _ in lists]) / SECOND
    assert pauses.max() == pytest.approx(0.2)
    new = converted(_made(tmp_path / "2"), log)
    assert [each.pose.position.y for each in new.of("/goal_pose")] == [4.0, 4.0]
    assert not any("move_base" in topic for topic in new.messages)


def test_robots_of_one_log_are_diagnosed_in_the_order_of_time(tmp_path: Path) -> None:
    later = [(at + 0.5, topic, message) for at, topic, message in drive(3, robot="eve")]
    log = sorted([*drive(5, robot="bob"), *later], key=itemgetter(0))
    robots = {"bob": "p3at-sh", "eve": "p3dx-sh"}
    bag = converted(tmp_path, log, robots=robots)
    found = bag.messages["/diagnostics"]
    times = [time for time, _ in found]
    assert times == sorted(times)
    names = [message.status[0].name for _, message in found]
    assert names[:4] == ["bob/RosAria: Link", "eve/RosAria: Link"] * 2
