"""From the topics of one robot back to snapshots of it."""

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import atan2, hypot, inf, isfinite, nan
from threading import Lock
from typing import Any, Final

from pioneer3.geometry import Pose2, Twist2, wrap
from pioneer3.models import RobotModel
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.client.graph import ODOMETRY, RobotTopics
from pioneer3.ros.messages.update import NANO, nanoseconds
from pioneer3.ros.node.middleware import Sender, Topics, Unsubscribe
from pioneer3.state import Battery, Bumpers, Motors, Odometry, Snapshot, Sonar
from pioneer3.tasks import hand_over

RANGE: Final = "sensor_msgs/Range"
TOGETHER: Final = 0.01
"""Messages of one snapshot come over several connections, all within this time [s]."""
ROUNDED: Final = 1e-3
"""Points are in 32 bits: an echo this near to the farthest there is [m] is none."""
RING: Final = 0.32
"""Each transducer fires once in this time [s]: the same distance again is a new one then."""
KNOWN: Final = 1.0
"""The state of the motors, which is latched, comes within this time [s] of the first pose."""
WINDOW: Final = 30.0
"""Over this time [s] the fastest message is the measure of the others."""
OF_CLOCK: Final = 1e9
"""Stamps before 2001 [s] are of a simulator, whose time may pass at any rate, or are none."""


class Delay:
    """How much longer messages take than the fastest of late; clocks may differ. Pure."""

    def __init__(self) -> None:
        self._least: deque[tuple[float, float]] = deque()

    def of(self, measured: float, received: float) -> float:
        """Return the delay [s] of a message, measured by the sender's clock, received by ours."""
        offset = received - measured
        while self._least and self._least[-1][1] >= offset:
            self._least.pop()
        self._least.append((received, offset))
        while self._least[0][0] < received - WINDOW:
            self._least.popleft()
        return offset - self._least[0][1]


def seconds_of(stamp: Any) -> float:
    """Return a stamp of ROS 1 or 2 [s]."""
    return nanoseconds(stamp) / NANO


class SnapshotBuilder:
    """Keeps the newest message of each type; makes a snapshot of them.

    With `motors_on` the motors count as on before a message says so.
    """

    def __init__(self, model: RobotModel, *, motors_on: bool = True) -> None:
        self._model = model
        self._odometry: Odometry | None = None
        self._battery = Battery(voltage=nan)
        self._motors = Motors(enabled=motors_on)
        self._bumpers = Bumpers()
        self._ranges = [nan] * len(model.sonars)
        self._heard_at = [-inf] * len(model.sonars)
        self._fresh: set[int] = set()
        self._sequence = 0

    def pose(self, message: Any) -> None:
        """Take a nav_msgs/Odometry; one that is not finite is left out."""
        place, turned = message.pose.pose.position, message.pose.pose.orientation
        twist = message.twist.twist
        v, w, half = twist.linear.x, twist.angular.z, self._model.true_base / 2
        here = Pose2(place.x, place.y, wrap(2 * atan2(turned.z, turned.w)))
        if all(map(isfinite, (here.x, here.y, here.theta, v, w))):
            self._odometry = Odometry(
                robot_in_odom=here,
                twist=Twist2(v, w),
                left_speed=v - w * half,
                right_speed=v + w * half,
            )

    def sonar_cloud(self, message: Any, now: float) -> None:
        """Take a sensor_msgs/PointCloud with a point for each transducer, as RosAria's."""
        for number, (point, mount) in enumerate(
            zip(message.points, self._model.sonars, strict=False)
        ):
            self.sonar_range(number, hypot(point.x - mount.x, point.y - mount.y), now)

    def sonar_range(self, number: int, metres: float, now: float) -> None:
        """Take the distance that one transducer measured at `now` [m, s]; more than 5 m is none."""
        if number >= len(self._ranges):
            return
        measured = metres if metres < SONAR_MAX - ROUNDED else inf
        if measured != self._ranges[number] or now - self._heard_at[number] >= RING:
            self._fresh.add(number)
            self._ranges[number], self._heard_at[number] = measured, now

    def bumpers(self, message: Any) -> None:
        """Take a rosaria/BumperState."""
        front, rear = map(bool, message.front_bumpers), map(bool, message.rear_bumpers)
        self._bumpers = Bumpers(front=tuple(front), rear=tuple(rear)[::-1])

    def bumper_array(self, message: Any) -> None:
        """Take a std_msgs/UInt8MultiArray of two rows: front and rear, from left to right."""
        pressed = [bool(each) for each in message.data]
        half = len(pressed) // 2
        self._bumpers = Bumpers(front=tuple(pressed[:half]), rear=tuple(pressed[half:])[::-1])

    def motors(self, message: Any) -> None:
        """Take a std_msgs/Bool."""
        self._motors = replace(self._motors, enabled=bool(message.data))

    def emergency_stop(self, message: Any) -> None:
        """Take a std_msgs/Bool: whether the latch or the button of the robot holds it."""
        self._motors = replace(self._motors, stop_button=bool(message.data))

    def voltage(self, volts: float) -> None:
        """Take the battery's voltage [V]."""
        self._battery = Battery(voltage=volts)

    def snapshot(self, now: float) -> Snapshot | None:
        """Return the snapshot at `now` [s, monotonic]; `None` before the first pose."""
        if self._odometry is None:
            return None
        fresh, self._fresh = sorted(self._fresh), set()
        self._sequence += 1
        return Snapshot(
            stamp=now,
            sequence=self._sequence,
            odometry=self._odometry,
            battery=self._battery,
            motors=self._motors,
            sonar=Sonar(ranges=tuple(self._ranges), fresh=tuple(fresh), enabled=bool(fresh)),
            bumpers=self._bumpers,
        )


class SnapshotSubscriber:
    """Makes snapshots of the topics of a robot; with `sonar` of those of each transducer, too."""

    def __init__(
        self,
        topics: RobotTopics,
        model: RobotModel,
        take: Callable[[Snapshot], None],
        middleware: Topics,
        *,
        sonar: bool = True,
    ) -> None:
        self._topics = topics
        self._ranges = topics.numbered(RANGE) if sonar else {}
        self._motors = topics.topic("std_msgs/Bool", "motors_state")
        self._builder = SnapshotBuilder(model, motors_on=self._motors is None)
        self._take = take
        self._middleware = middleware
        self._loop = asyncio.get_running_loop()
        self._subscriptions: list[Unsubscribe] = []
        self._delay = Delay()
        self._motors_known = self._motors is None
        self._began_at = inf
        self._lock = Lock()
        self._open = True

    def open(self) -> None:
        """Subscribe, in a thread."""
        build, clock = self._builder, self._loop.time
        self._subscribe(self._topics.pose, ODOMETRY, self._begin)
        for type_name, ending, receive in (
            ("sensor_msgs/PointCloud", "sonar", lambda m: build.sonar_cloud(m, clock())),
            ("rosaria/BumperState", "", build.bumpers),
            ("std_msgs/UInt8MultiArray", "bumper_state", build.bumper_array),
            ("std_msgs/Bool", "motors_state", self._take_motors),
            ("std_msgs/Bool", "emergency_stop", build.emergency_stop),
            ("std_msgs/Float64", "battery_voltage", lambda m: build.voltage(m.data)),
            ("sensor_msgs/BatteryState", "", lambda m: build.voltage(m.voltage)),
        ):
            if name := self._topics.topic(type_name, ending):
                self._subscribe(name, type_name, receive)
        for number, name in self._ranges.items():
            self._subscribe(name, RANGE, partial(self._range, number))

    def close(self) -> None:
        """Subscribe no more, in a thread; also while :meth:`open` is at work in another one."""
        with self._lock:
            self._open = False
        for unsubscribe in self._subscriptions:
            unsubscribe()

    def _subscribe(self, name: str, type_name: str, take: Callable[[Any], None]) -> None:
        def receive(message: Any, _: Sender) -> None:
            hand_over(self._loop, take, message)

        with self._lock:
            if self._open:
                subscription = self._middleware.subscribe(name, type_name, receive, queue=1)
                self._subscriptions.append(subscription)

    def _range(self, number: int, message: Any) -> None:
        metres = inf if message.range >= message.max_range else message.range
        self._builder.sonar_range(number, metres, self._loop.time())

    def _take_motors(self, message: Any) -> None:
        self._motors_known = True
        self._builder.motors(message)

    def _begin(self, message: Any) -> None:
        now = self._loop.time()
        self._began_at = min(self._began_at, now)
        self._builder.pose(message)
        stamp = seconds_of(message.header.stamp)
        measured = now - (self._delay.of(stamp, now) if stamp > OF_CLOCK else 0.0)
        self._loop.call_later(TOGETHER, self._end, measured)

    def _end(self, measured: float) -> None:
        late = self._loop.time() - self._began_at > KNOWN
        if not (self._open and (self._motors_known or late)):
            return
        if (snapshot := self._builder.snapshot(measured)) is not None:
            self._take(snapshot)
