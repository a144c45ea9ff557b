"""Message types of ROS 1 Noetic: definitions and codec of rosbags."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import md5
from typing import Any, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.ros.definitions import DEFINITIONS, file_of
from pioneer3.ros.encoding import ROS1, encoder
from pioneer3.ros.typestore import MessageStore, full_name

LACKING: Final = {
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "move_base_msgs/MoveBaseGoal": "geometry_msgs/PoseStamped target_pose",
    "move_base_msgs/MoveBaseFeedback": "geometry_msgs/PoseStamped base_position",
    "move_base_msgs/MoveBaseResult": "",
    "move_base_msgs/MoveBaseActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\n"
    "MoveBaseGoal goal",
    "move_base_msgs/MoveBaseActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\n"
    "MoveBaseFeedback feedback",
    "move_base_msgs/MoveBaseActionResult": "Header header\nactionlib_msgs/GoalStatus status\n"
    "MoveBaseResult result",
}
"""Definitions of types of ROS 1 itself that rosbags lacks."""
SERVICES: Final = {
    "std_srvs/Empty": ("", ""),
    "std_srvs/Trigger": ("", "bool success\nstring message"),
    "std_srvs/SetBool": ("bool data", "bool success\nstring message"),
    "nav_msgs/GetMap": ("", "nav_msgs/OccupancyGrid map"),
    "nav_msgs/GetPlan": (
        "geometry_msgs/PoseStamped start\ngeometry_msgs/PoseStamped goal\nfloat32 tolerance",
        "nav_msgs/Path plan",
    ),
    "dynamic_reconfigure/Reconfigure": (
        "dynamic_reconfigure/Config config",
        "dynamic_reconfigure/Config config",
    ),
    "roscpp/GetLoggers": ("", "roscpp/Logger[] loggers"),
    "roscpp/SetLoggerLevel": ("string logger\nstring level", ""),
}
"""Request and response of services."""
REQUEST, RESPONSE = "Request", "Response"
NAMED: Final = re.compile(r"^(\w+/\w+)(?:\[\d*\])?", re.MULTILINE)
"""The type of a field that is no base type."""


@dataclass(frozen=True, slots=True)
class Definition:
    """The definition of a type such as `nav_msgs/Odometry`, as connections state it.

    Two nodes must have the same checksum of it without comments; the text is with the types in it.
    A stamped type begins with a header, which begins with a number.
    """

    name: str
    md5sum: str
    text: str = ""
    is_stamped: bool = False


class Ros1Types(MessageStore):
    """The types of ROS 1; ConfigError without rosbags."""

    def __init__(self) -> None:
        try:
            from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        except ImportError as error:
            advice = how_to_get("ros1")
            raise ConfigError(f"ROS 1 needs rosbags: {advice}") from error
        super().__init__(get_typestore(Stores.ROS1_NOETIC))
        parts = {
            f"{name}{part}": text
            for name, texts in SERVICES.items()
            for part, text in zip((REQUEST, RESPONSE), texts, strict=True)
        }
        further = LACKING | parts | {name: file_of(name) for name in DEFINITIONS}
        for name, text in further.items():
            self._store.register(get_types_from_msg(text, full_name(name)))
        self._encoders: dict[str, Callable[[Any], bytes]] = {}

    def definition(self, name: str) -> Definition:
        """Return the definition of a type such as `nav_msgs/Odometry`; ConfigError for none."""
        full = full_name(name)
        if full not in self._store.fielddefs:
            raise ConfigError(f"no definition of ROS 1's message type {name} is here")
        text, md5sum = self._store.generate_msgdef(full, ros_version=1)
        first = self.fields[full][1][:1]
        is_stamped = any(what == "std_msgs/msg/Header" for _, (_, what) in first)
        return Definition(full.replace("/msg/", "/"), md5sum, text, is_stamped)

    def service_definition(self, name: str) -> Definition:
        """Return the definition of a service of :data:`SERVICES`; its text is stated nowhere."""
        text = "".join(
            NAMED.sub(lambda found: self.definition(found[1]).md5sum, part)
            for part in SERVICES[name]
        )
        return Definition(name, md5(text.encode(), usedforsecurity=False).hexdigest())

    def encode(self, message: Any) -> bytes:
        """Return the serialized form; lists of numbers may stand for arrays."""
        name = message.__msgtype__
        if name not in self._encoders:
            self._encoders[name] = encoder(name, self._store.fielddefs, ROS1)
        return self._encoders[name](message)

    def decode(self, data: bytes, name: str) -> Any:
        """Return the message of a type such as `nav_msgs/Odometry`; ValueError for other bytes."""
        from rosbags.serde import SerdeError

        try:
            return self._store.deserialize_ros1(data, full_name(name))
        except (SerdeError, AssertionError, IndexError) as error:
            raise ValueError(str(error)) from error
