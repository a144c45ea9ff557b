"""The table of a bridge: its rows from the table of topics of the robot's node. Pure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel
from pioneer3.ros.node.names import NODE, Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.services import NAVIGATION_SERVICES, SERVICES
from pioneer3.ros.node.topic import Direction, Topic
from pioneer3.ros.node.topics import COMMANDS, STAMPED_COMMANDS, UNSTAMPED_NAME, topics_of
from pioneer3.ros.ros2.distros import Distro
from pioneer3.tables import nearest

LASERS: Final = ("laser", "laser2")
BUMPER_STATE: Final = ("rosaria/BumperState", "std_msgs/UInt8MultiArray")
"""A type that only ROS 1 has, and the one that the topic has in ROS 2."""
TWISTS: Final = {"geometry_msgs/Twist", "geometry_msgs/TwistStamped"}
TRANSFORMS: Final = "tf2_msgs/TFMessage"
PICTURES: Final = {f"sensor_msgs/{name}" for name in ("Image", "CompressedImage", "CameraInfo")}
"""Types of topics that cost much, and that nodes publish only while somebody subscribes."""
OF_MANY: Final = {TRANSFORMS, "diagnostic_msgs/DiagnosticArray"}
"""Types of topics that several nodes publish."""


class Side(StrEnum):
    """A network."""

    ROS1 = "ros1"
    ROS2 = "ros2"

    @property
    def words(self) -> str:
        """For people."""
        return {Side.ROS1: "ROS 1", Side.ROS2: "ROS 2"}[self]

    @property
    def other(self) -> "Side":
        """The other one."""
        return Side.ROS2 if self is Side.ROS1 else Side.ROS1


class BridgeWay(StrEnum):
    """Where messages are passed on to."""

    TO_ROS1 = "to_ros1"
    TO_ROS2 = "to_ros2"
    BOTH = "both"

    @property
    def sources(self) -> tuple[Side, ...]:
        """The networks that messages come from."""
        return {
            BridgeWay.TO_ROS1: (Side.ROS2,),
            BridgeWay.TO_ROS2: (Side.ROS1,),
            BridgeWay.BOTH: (Side.ROS1, Side.ROS2),
        }[self]


@dataclass(frozen=True, slots=True, kw_only=True)
class BridgedTopic:
    """A topic that is bridged, by full names and short types, such as `geometry_msgs/Twist`.

    The bridge wants all messages in ROS 2 if it is `reliable`; best effort suits every publisher.
    The content `when_lost` takes the place of a latched one that is not true without its publisher.
    The robot subscribes to it if it goes `to_robot`.
    """

    ros1: str
    ros2: str
    ros1_type: str
    ros2_type: str
    way: BridgeWay
    latched: bool = False
    reliable: bool = True
    when_lost: object = None
    to_robot: bool = False

    @property
    def commands(self) -> bool:
        """Whether its messages are velocity commands."""
        return self.ros1_type in TWISTS

    @property
    def on_demand(self) -> bool:
        """Whether the bridge subscribes only while somebody subscribes on the other side."""
        return self.ros1_type in PICTURES and not self.latched

    @property
    def of_many(self) -> bool:
        """Whether publishers on both sides are common."""
        return self.to_robot or self.commands or self.ros1_type in OF_MANY

    def name(self, side: Side) -> str:
        """Return its name on one side."""
        return self.ros1 if side is Side.ROS1 else self.ros2

    def __str__(self) -> str:
        arrow = {BridgeWay.TO_ROS1: "<-", BridgeWay.TO_ROS2: "->", BridgeWay.BOTH: "<->"}[self.way]
        type_name = self.ros1_type
        if self.ros2_type != self.ros1_type:
            type_name += f", {self.ros2_type}"
        latched = ", latched" if self.latched else ""
        return f"ROS 1 {self.ros1} {arrow} ROS 2 {self.ros2} ({type_name}{latched})"


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceRow:
    """A service of the robot that is bridged, by its full names and types on both sides.

    `topic_type` is that of the topic that stands in for it where ROS 2 has no services.
    """

    ros1: str
    ros2: str
    ros1_type: str
    ros2_type: str
    topic_type: str

    def __str__(self) -> str:
        return f"service ROS 1 {self.ros1} ({self.ros1_type}), ROS 2 {self.ros2} ({self.ros2_type})"


@dataclass(frozen=True, slots=True, kw_only=True)
class BridgedRobot:
    """The robot of a bridge, whose node is on `side`; `profile` are its names in ROS 1.

    Its namespaces are such as `/robot1`; names of RosAria are below that of `ros1_node`.
    """

    side: Side
    model: RobotModel
    distro: Distro
    profile: Profile
    namespace: str = "/"
    ros1_namespace: str = "/"
    ros1_node: str = NODE

    def name(self, side: Side, name: str) -> str:
        """Return the full name of a topic or service."""
        if name.startswith("/"):
            return name
        if side is Side.ROS2:
            return f"{self.namespace.rstrip('/')}/{name.removeprefix('~')}"
        space = self.ros1_namespace.rstrip("/")
        return f"{space}/{self.ros1_node}/{name[1:]}" if name[0] == "~" else f"{space}/{name}"


def rows_of(robot: BridgedRobot) -> tuple[BridgedTopic, ...]:
    """Return the topics of a robot that both sides can have."""
    found: dict[tuple[str, str], BridgedTopic] = {}
    for topic in (*topics_of(robot.model, LASERS), *NAVIGATION_TOPICS):
        for row in _rows(robot, topic):
            found.setdefault((row.ros1, row.ros2), row)
    return tuple(found.values())


def services_of(robot: BridgedRobot) -> tuple[ServiceRow, ...]:
    """Return the services of a robot that both sides can have."""
    rows = []
    for service in (*SERVICES, *NAVIGATION_SERVICES):
        (*names,) = service.names(Profile.ROS2)
        rows += [
            ServiceRow(
                ros1=robot.name(Side.ROS1, name),
                ros2=robot.name(Side.ROS2, ros2),
                ros1_type=service.type_name,
                ros2_type=service.type_in(Profile.ROS2),
                topic_type=service.topic_type,
            )
            for name in service.names(robot.profile)
            for ros2 in names
            if service.topic_type is not None
        ]
    return tuple(rows)


def chosen(rows: Sequence[BridgedTopic], only: Sequence[str]) -> tuple[BridgedTopic, ...]:
    """Return the rows of which a name is in `only`, or all where that is empty.

    ConfigError if no row has one of the names.
    """
    wanted = {name.lstrip("/") for name in only}
    known = {row: {row.ros1.lstrip("/"), row.ros2.lstrip("/")} for row in rows}
    if not only:
        return tuple(rows)
    unknown = wanted.difference(*known.values())
    if unknown:
        names = tuple(sorted(set().union(*known.values())))
        name = min(unknown)
        raise ConfigError(f"no row is called {name!r}, {nearest(name, names)}; --list shows them")
    return tuple(row for row, names in known.items() if names & wanted)


def _rows(robot: BridgedRobot, topic: Topic) -> Iterator[BridgedTopic]:
    """Yield the rows of a topic, one for each pair of its names."""
    published = topic.direction is Direction.PUBLISHED
    to_ros2 = (robot.side is Side.ROS1) == published
    names, ros2_type = _ros2_names(robot, topic), topic.type_name
    if topic is STAMPED_COMMANDS:
        if robot.side is Side.ROS2:
            return
        topic, ros1_type = COMMANDS, COMMANDS.type_name
    else:
        ros1_type = topic.type_name
    if ros1_type == BUMPER_STATE[0]:
        ros2_type = BUMPER_STATE[1]
    for ros1 in topic.names(robot.profile):
        for ros2 in names or _own_names(robot, ros1):
            yield BridgedTopic(
                ros1=robot.name(Side.ROS1, ros1),
                ros2=robot.name(Side.ROS2, ros2),
                ros1_type=ros1_type,
                ros2_type=ros2_type,
                way=BridgeWay.TO_ROS2 if to_ros2 else BridgeWay.TO_ROS1,
                latched=topic.latched,
                when_lost=topic.when_lost,
                to_robot=not published,
            )


def _ros2_names(robot: BridgedRobot, topic: Topic) -> tuple[str, ...]:
    if topic in {COMMANDS, STAMPED_COMMANDS}:  # `cmd_vel` is of the distribution's type
        stamped = topic is STAMPED_COMMANDS
        if stamped is robot.distro.stamped_commands:
            return ("cmd_vel",)
        return ("cmd_vel_stamped" if stamped else UNSTAMPED_NAME,)
    if topic.type_name == BUMPER_STATE[0]:
        return ("bumper_state",)
    return topic.names(Profile.ROS2)


def _own_names(robot: BridgedRobot, ros1: str) -> tuple[str, ...]:
    """Return the name in ROS 2 of a topic that only RosAria has, and only where it runs."""
    if robot.side is Side.ROS2 or ros1.startswith("move_base"):
        return ()
    return (ros1.removeprefix("~"),)
