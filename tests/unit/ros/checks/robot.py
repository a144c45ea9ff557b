"""A node of somebody else's: all right at first, and wrong in whichever way a test wants it."""

import asyncio
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from pioneer3.ros.checks.check import check
from pioneer3.ros.checks.facts import CheckReport, CheckRow
from pioneer3.ros.checks.listening import TopicListener
from pioneer3.ros.node.services import SERVICES
from pioneer3.ros.ros2.backend import LATCHED, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.remapping import Remapping
from pioneer3.ros.ros2.types import MessageTypes
from tests.unit.ros.ros2.memory import MemoryBackend, MemoryEndpoint, MemoryNetwork

TYPES = MessageTypes(distro_of("jazzy"))
NODE = NodeName("base", "/robot1")
CHECK = NodeName("check")
NANO = 1_000_000_000
START = 1_700_000_000 * NANO
URDF = "<robot name='x'><link name='base_link'/><link name='laser'/></robot>"

Change = Callable[[Any], object]
"""Changes a message before it is sent; returns False to send nothing."""


def now() -> int:
    """Return the time of the virtual clock as ROS time [ns]."""
    return START + round(asyncio.get_running_loop().time() * NANO)


def stamp(message: Any, moment: int) -> None:
    message.sec, message.nanosec = divmod(moment, NANO)


def odometry(message: Any) -> None:
    message.header.frame_id, message.child_frame_id = "odom", "base_link"
    message.pose.pose.orientation.w = 1.0
    message.pose.covariance[::7] = message.twist.covariance[::7] = 0.1


def transform(parent: str, child: str) -> Any:
    made = TYPES.make("geometry_msgs/TransformStamped")
    made.header.frame_id, made.child_frame_id = parent, child
    made.transform.rotation.w = 1.0
    stamp(made.header.stamp, now())
    return made


def pose(message: Any) -> None:
    message.transforms = [transform("odom", "base_link")]


def fixed(message: Any) -> None:
    message.transforms = [
        transform("base_link", name) for name in ("laser", "imu_link", "sonar_0", "sonar_1")
    ]


def joints(message: Any) -> None:
    message.name, message.position = ["left", "right"], np.zeros(2)


def battery(message: Any) -> None:
    message.voltage, message.percentage = 12.5, 0.8
    message.current = message.charge = message.capacity = message.temperature = float("nan")


def description(message: Any) -> None:
    message.data = URDF


def scan(message: Any) -> None:
    message.header.frame_id = "laser"
    message.angle_min, message.angle_max, message.angle_increment = -1.0, 1.0, 0.5
    message.range_min, message.range_max = 0.1, 8.0
    message.ranges = np.array([1.0, np.inf, -np.inf, np.nan, 2.0], np.float32)


def sonar(number: int) -> Callable[[Any], None]:
    def fill(message: Any) -> None:
        message.header.frame_id = f"sonar_{number}"
        message.field_of_view, message.min_range, message.max_range = 0.5, 0.15, 5.0
        message.range = 2.0

    return fill


def imu(message: Any) -> None:
    message.header.frame_id = "imu_link"
    message.orientation_covariance[0] = -1.0


def cloud(message: Any) -> None:
    message.header.frame_id = "base_link"
    message.is_dense = True
    for place, name in enumerate("xyz"):
        part = TYPES.make("sensor_msgs/PointField")
        part.name, part.offset, part.datatype, part.count = name, 4 * place, 7, 1
        message.fields.append(part)
    message.height, message.width, message.point_step, message.row_step = 1, 2, 12, 24
    message.data = np.frombuffer(np.ones(6, np.float32).tobytes(), np.uint8)


def diagnostics(message: Any) -> None:
    status = TYPES.make("diagnostic_msgs/DiagnosticStatus")
    status.name = "Link"
    message.status = [status]


@dataclass(frozen=True)
class Sent:
    """A topic of the pretended robot."""

    type_name: str
    fill: Callable[[Any], None] = lambda message: None
    qos: Qos = field(default_factory=Qos)
    every: int = 1
    """Ticks of 0.1 s between two messages; 0 for a single one."""


TOPICS: Mapping[str, Sent] = {
    "/robot1/odom": Sent("nav_msgs/Odometry", odometry),
    "/robot1/tf": Sent("tf2_msgs/TFMessage", pose),
    "/robot1/tf_static": Sent("tf2_msgs/TFMessage", fixed, LATCHED, 0),
    "/robot1/robot_description": Sent("std_msgs/String", description, LATCHED, 0),
    "/robot1/joint_states": Sent("sensor_msgs/JointState", joints),
    "/robot1/battery_state": Sent("sensor_msgs/BatteryState", battery, every=10),
    "/robot1/motors_state": Sent("std_msgs/Bool", qos=LATCHED, every=0),
    "/robot1/emergency_stop": Sent("std_msgs/Bool", qos=LATCHED),
    "/robot1/scan": Sent("sensor_msgs/LaserScan", scan),
    "/robot1/imu/data_raw": Sent("sensor_msgs/Imu", imu),
    "/robot1/sonar/points": Sent("sensor_msgs/PointCloud2", cloud),
    "/robot1/sonar/range_0": Sent("sensor_msgs/Range", sonar(0), every=3),
    "/robot1/sonar/range_1": Sent("sensor_msgs/Range", sonar(1), every=3),
    "/diagnostics": Sent("diagnostic_msgs/DiagnosticArray", diagnostics, every=10),
}


@dataclass
class Network:
    """A pretended robot and whoever else is there; tests add to it.

    Attributes:
        topics: Of the robot, by full name.
        changes: Of its messages, by full name.
        commands: Type of `cmd_vel`.
        services: By name, with their types.
    """

    memory: MemoryNetwork = field(default_factory=MemoryNetwork)
    topics: dict[str, Sent] = field(default_factory=lambda: dict(TOPICS))
    changes: dict[str, Change] = field(default_factory=dict)
    commands: str = "geometry_msgs/Twist"
    services: dict[str, str] = field(
        default_factory=lambda: {
            f"/robot1/{each.standard}": "std_srvs/SetBool"
            if each.standard == "sonar/enable"
            else "std_srvs/Trigger"
            for each in SERVICES
        }
    )

    def change(self, name: str, change: Change) -> None:
        """Change all messages of a topic of the robot."""
        self.changes[f"/robot1/{name}" if not name.startswith("/") else name] = change

    def publisher(
        self, name: str, type_name: str, node: str = "other", qos: Qos | None = None
    ) -> MemoryEndpoint:
        """Return a publisher of another node."""
        other = MemoryBackend(self.memory, NodeName(node))
        return other.advertise(name, TYPES.message_type(type_name), qos or Qos())

    def subscriber(self, name: str, type_name: str, qos: Qos | None = None) -> MemoryEndpoint:
        """Return a subscriber of another node."""
        other = MemoryBackend(self.memory, NodeName("other"))
        kind = TYPES.message_type(type_name)
        return other.subscribe(name, kind, qos or Qos(), lambda cdr, gid: None, lambda gid: None)

    def again(self, name: str, **parts: Any) -> None:
        """Change a topic of the robot itself: its type, its quality of service, its rate."""
        full = f"/robot1/{name}"
        self.topics[full] = replace(self.topics[full], **parts)

    async def checked(
        self,
        seconds: float = 4.0,
        *,
        rules: tuple[Remapping, ...] = (),
        transducers: int | None = None,
    ) -> CheckReport:
        """Let the robot run, and return the report of it."""
        with _at_once():
            robot = MemoryBackend(self.memory, NODE)
            writers = {
                name: robot.advertise(name, TYPES.message_type(sent.type_name), sent.qos)
                for name, sent in self.topics.items()
            }
            for name in ("cmd_vel", "cmd_vel_stamped"):
                kind = self.commands if name == "cmd_vel" else "geometry_msgs/TwistStamped"
                type_ = TYPES.message_type(kind)
                full = f"/robot1/{name}"
                robot.subscribe(full, type_, Qos(), lambda cdr, gid: None, lambda gid: None)
            for name, kind in self.services.items():
                robot.serve(name, TYPES.service_type(kind), bytes)
            running = asyncio.ensure_future(self._run(writers))
            await asyncio.sleep(0.25)
            own = MemoryBackend(self.memory, CHECK)
            listener = TopicListener(
                own,
                CHECK,
                TYPES,
                NODE,
                rules=rules,
                transducers=transducers,
                wall=now,
            )
            await listener.listen(seconds, lambda line: None)
            running.cancel()
            robot.close()
            own.close()
            return check(listener.facts())

    async def _run(self, writers: Mapping[str, MemoryEndpoint]) -> None:
        tick = 0
        while True:
            for name, writer in writers.items():
                sent = self.topics[name]
                if (tick % sent.every == 0) if sent.every else (tick == 0):
                    message = TYPES.make(sent.type_name)
                    if hasattr(message, "header"):
                        stamp(message.header.stamp, now())
                    sent.fill(message)
                    if self.changes.get(name, lambda it: True)(message) is not False:
                        writer.write(TYPES.encode(message))
            tick += 1
            await asyncio.sleep(0.1)


def row(report: CheckReport, name: str) -> CheckRow:
    """Return the row of a topic or service of the robot."""
    full = name if name.startswith("/") else f"/robot1/{name}"
    (found,) = (each for each in report.rows if each.name == full)
    return found


@contextmanager
def _at_once() -> Iterator[None]:
    async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
        """Stand in for `asyncio.to_thread`: virtual time does not wait for other threads."""
        return function(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio, "to_thread", at_once)
        yield
