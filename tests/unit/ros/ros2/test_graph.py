"""Robots in a graph of ROS 2, where a topic may have endpoints of several types."""

from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, Qos
from pioneer3.ros.ros2.client import robots_of


def endpoint(node: str, kind: EndpointKind, name: str, type_name: str) -> Endpoint:
    return Endpoint(node=node, kind=kind, name=name, type_name=type_name, qos=Qos(), gid=b"")


ROBOT = (
    endpoint("/pioneer3", EndpointKind.PUBLISHER, "/odom", "nav_msgs/msg/Odometry"),
    endpoint("/pioneer3", EndpointKind.SUBSCRIBER, "/cmd_vel", "geometry_msgs/msg/Twist"),
)


def test_the_type_of_others_on_its_topic_does_not_hide_a_robot() -> None:
    stranger = endpoint(
        "/nav2", EndpointKind.PUBLISHER, "/cmd_vel", "geometry_msgs/msg/TwistStamped"
    )
    (robot,) = robots_of(Graph(("/nav2", "/pioneer3"), (stranger, *ROBOT)))
    assert robot.commands == "/cmd_vel"
    assert robot.published == {"/odom": "nav_msgs/Odometry"}
    assert robot.nodes == 1


def test_two_nodes_of_one_name_are_counted() -> None:
    (robot,) = robots_of(Graph(("/pioneer3", "/pioneer3"), (*ROBOT, *ROBOT)))
    assert robot.nodes == 2
