"""Which robots there are on a master, by what its nodes do."""

import pytest

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.client.graph import RobotTopics, chosen, robots_on

ODOMETRY, CLOUD = "nav_msgs/Odometry", "sensor_msgs/PointCloud"
TWIST, STAMPED = "geometry_msgs/Twist", "geometry_msgs/TwistStamped"


def topics(nodes: dict[str, list[str]]) -> list[tuple[str, list[str]]]:
    """Turn what each node does into what the master tells."""
    names = sorted({topic for several in nodes.values() for topic in several})
    return [(name, [node for node in nodes if name in nodes[node]]) for name in names]


def lab(*names: str) -> list[RobotTopics]:
    """Return the robots on a master with the lab's nodes, and others that are none."""
    published = {f"/RosAria_{name}": [f"/RosAria_{name}/pose"] for name in names}
    published |= {"/rob_key": ["/RosAria/cmd_vel"], "/rosout": ["/rosout_agg"]}
    heard = {f"/RosAria_{name}": ["/RosAria/cmd_vel", f"/RosAria/cmd_vel_{name}"] for name in names}
    heard |= {"/rosout": ["/rosout"], "/recorder": [f"/RosAria_{name}/pose" for name in names]}
    types = {name: ODOMETRY for each in published.values() for name in each if "pose" in name}
    types |= {name: TWIST for each in heard.values() for name in each if "cmd_vel" in name}
    return robots_on(topics(published), topics(heard), types)


def test_a_robot_tells_its_pose_and_listens_to_velocities() -> None:
    assert [robot.node for robot in lab("a", "b")] == ["/RosAria_a", "/RosAria_b"]
    assert robots_on([], [], {}) == []


def test_it_is_commanded_where_no_other_robot_listens() -> None:
    assert [robot.commands for robot in lab("a", "b")] == [
        "/RosAria/cmd_vel_a",
        "/RosAria/cmd_vel_b",
    ]


def test_its_own_name_comes_before_others() -> None:
    heard = [("/RosAria/cmd_vel", ["/x"]), ("/teleop", ["/x"]), ("/x/cmd_vel", ["/x"])]
    types = {name: TWIST for name, _ in heard} | {"/x/pose": ODOMETRY}
    (robot,) = robots_on([("/x/pose", ["/x"])], heard, types)
    assert robot.commands == "/x/cmd_vel"


def test_a_robot_that_takes_stamped_velocities_only_is_one_too() -> None:
    heard = [("/x/cmd_vel", ["/x"]), ("/x/cmd_vel_unstamped", ["/x"]), ("/y/cmd_vel", ["/y"])]
    types = {name: STAMPED for name, _ in heard} | {"/x/cmd_vel_unstamped": TWIST}
    types |= {"/x/pose": ODOMETRY, "/y/pose": ODOMETRY}
    found = robots_on([("/x/pose", ["/x"]), ("/y/pose", ["/y"])], heard, types)
    assert [(robot.commands, robot.command_type) for robot in found] == [
        ("/x/cmd_vel_unstamped", TWIST),
        ("/y/cmd_vel", STAMPED),
    ]


def test_topics_are_found_by_type_and_the_end_of_their_names() -> None:
    published = {
        "/x/sonar": CLOUD,
        "/x/laser_pointcloud": CLOUD,
        "/x/sonar/range_0": "sensor_msgs/Range",
        "/x/sonar/range_12": "sensor_msgs/Range",
    }
    robot = RobotTopics(node="/x", pose="/x/pose", commands="/x/cmd_vel", published=published)
    assert robot.topic(CLOUD, "sonar") == "/x/sonar"
    assert robot.topic("std_msgs/Bool") is None
    assert robot.numbered("sensor_msgs/Range") == {0: "/x/sonar/range_0", 12: "/x/sonar/range_12"}


@pytest.mark.parametrize("name", ["/RosAria_p3at_1_113", "RosAria_p3at_1_113", "p3at_1_113"])
def test_a_robot_is_called_by_its_node_or_the_labs_name(name: str) -> None:
    assert chosen(lab("p3at_0_119", "p3at_1_113"), name).node == "/RosAria_p3at_1_113"


def test_a_robot_in_a_namespace_is_called_by_that() -> None:
    robot = RobotTopics(node="/front/RosAria", pose="/front/odom", commands="/front/cmd_vel")
    assert chosen([robot], "front") is robot
    assert chosen([robot], "RosAria") is robot


def test_the_only_robot_needs_no_name() -> None:
    assert chosen(lab("a"), None).node == "/RosAria_a"


def test_what_is_not_clear_is_told_with_what_there_is() -> None:
    two = lab("a", "b")
    with pytest.raises(ConfigError, match="--robot; RosAria_a, RosAria_b"):
        chosen(two, None)
    with pytest.raises(NoRobotError, match="'c' on this ROS graph, but RosAria_a, RosAria_b"):
        chosen(two, "c")
    with pytest.raises(NoRobotError, match="there is no robot on this ROS graph"):
        chosen([], None)
    twins = [
        RobotTopics(node=f"/{place}/RosAria", pose="p", commands="c") for place in ("left", "right")
    ]
    with pytest.raises(ConfigError, match="several robots are called 'RosAria'"):
        chosen(twins, "RosAria")


def test_nodes_of_one_name_are_not_driven_together() -> None:
    twins = RobotTopics(node="/pioneer3", pose="/odom", commands="/cmd_vel", nodes=2)
    with pytest.raises(ConfigError, match=r"2 nodes are called /pioneer3.*--namespace"):
        chosen([twins], None)
