"""The state of a robot at one instant, and the scans of its lasers. Immutable, in SI units."""

from dataclasses import dataclass, field
from enum import StrEnum
from math import cos, degrees, inf, isfinite, sin

from pioneer3.geometry import ORIGIN, Pose2, Twist2, wrap
from pioneer3.names import html_table


class Charging(StrEnum):
    """States of the charger (protocol.md 4.2)."""

    UNKNOWN = "unknown"
    NONE = "not charging"
    BULK = "bulk"
    OVERCHARGE = "overcharge"
    FLOAT = "float"
    BALANCE = "balance"


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """The identity that the robot sends.

    Attributes:
        name: Given by its owner; most simulators say `MobileSim`.
        family: `Pioneer` for every P2, P3, PeopleBot and AmigoBot.
        model: Parameter-file name in lower case, such as `p3at-sh`.
    """

    name: str
    family: str
    model: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """Pose and velocity measured by the wheels.

    Attributes:
        robot_in_odom: Pose since the first connection [m, rad]; continuous over reconnections.
        robot_in_encoder: Pose in the robot's own counters [m, rad]: position since the session
            began, heading since the robot was switched on.
        left_speed: Left wheel's speed over ground [m/s]; `right_speed` likewise.
    """

    robot_in_odom: Pose2
    twist: Twist2
    left_speed: float
    right_speed: float
    robot_in_encoder: Pose2 = ORIGIN


@dataclass(frozen=True, slots=True, kw_only=True)
class Sonar:
    """Ultrasonic ranges.

    Attributes:
        ranges: Per transducer [m], shape (number of transducers,); index 0 is front left.
            `inf` where nothing echoed, NaN before the first reading.
        fresh: Numbers of the transducers that were read in this report.
    """

    ranges: tuple[float, ...] = ()
    fresh: tuple[int, ...] = ()
    enabled: bool = False

    @property
    def nearest(self) -> float:
        """Shortest range [m]; `inf` when nothing echoed."""
        return min((r for r in self.ranges if r == r), default=float("inf"))  # noqa: PLR0124


@dataclass(frozen=True, slots=True, kw_only=True)
class Battery:
    """The battery and its charger.

    Attributes:
        voltage: [V].
        charge: 0 to 1, or `None` where the robot does not send it.
        low: Whether the voltage is below the alarm level of the robot's own configuration.
    """

    voltage: float
    charge: float | None = None
    charging: Charging = Charging.UNKNOWN
    low: bool = False

    @property
    def words(self) -> str:
        """Voltage, charge and charger for people."""
        parts = [f"{self.voltage:.1f} V"]
        if self.charge is not None:
            parts.append(f"{self.charge:.0%}")
        if self.low:
            parts.append("LOW")
        if self.charging not in {Charging.UNKNOWN, Charging.NONE}:
            parts.append(f"charging ({self.charging})")
        return ", ".join(parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motors:
    """Power of the motors, blocked wheels, motion as the firmware tells it, the red button."""

    enabled: bool = False
    left_stalled: bool = False
    right_stalled: bool = False
    moving: bool = False
    stop_button: bool = False

    @property
    def stalled(self) -> bool:
        """Whether either side is blocked."""
        return self.left_stalled or self.right_stalled


@dataclass(frozen=True, slots=True, kw_only=True)
class Bumpers:
    """Contact by segment; front from left to right, rear from right to left (protocol.md 4.7)."""

    front: tuple[bool, ...] = ()
    rear: tuple[bool, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """Digital lines (bits, 1 is high), compass and thermometer of the controller.

    Attributes:
        analog: Voltage of the selected port, `analog_port` [V].
        compass: Heading as the robot sends it [rad], or `None` without a compass.
        temperature: Motor temperature [degrees Celsius], or `None` without a sensor.
    """

    digital_in: int = 0
    digital_out: int = 0
    analog: float = 0.0
    analog_port: int = 0
    compass: float | None = None
    temperature: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Words:
    """The bit fields as on the wire, for people who look for single bits (protocol.md 4.4).

    All of 16 bits, `flags3` of 32 (MTX only); `None` where the robot does not send them. `stalls`
    has left stall and rear bumpers in the low byte, right and front in the high one.
    """

    flags: int = 0
    stalls: int = 0
    faults: int | None = None
    flags3: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkQuality:
    """Quality of the reception.

    Attributes:
        reports: Reports received in this session.
        bad_checksums: Frames dropped because of a wrong checksum.
        bytes_skipped: Bytes that belonged to no frame.
        rate: Reports per second, over the last second [1/s]; 0 after the first one.
        sessions: Number of sessions with the robot, including this one.
    """

    reports: int = 0
    bad_checksums: int = 0
    bytes_skipped: int = 0
    rate: float = 0.0
    sessions: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot:
    """A coherent set of everything the robot reports.

    Attributes:
        stamp: Time at which its first byte arrived [s, monotonic].
        sequence: Number of the report, over all sessions.
        faults: Names of the fault flags that are set.
    """

    stamp: float
    sequence: int
    odometry: Odometry
    battery: Battery
    motors: Motors
    sonar: Sonar = field(default_factory=Sonar)
    bumpers: Bumpers = field(default_factory=Bumpers)
    inputs: Inputs = field(default_factory=Inputs)
    link: LinkQuality = field(default_factory=LinkQuality)
    faults: tuple[str, ...] = ()
    words: Words = field(default_factory=Words)

    @property
    def alarms(self) -> tuple[str, ...]:
        """Names of all that needs somebody, in capitals."""
        up = {
            "STOP BUTTON": self.motors.stop_button,
            "STALLED": self.motors.stalled,
            "BUMPED": any((*self.bumpers.front, *self.bumpers.rear)),
        }
        return (*(name for name in up if up[name]), *(fault.upper() for fault in self.faults))

    @property
    def readings(self) -> dict[str, str]:
        """The main readings for people, with their units, by their names."""
        pose, twist = self.odometry.robot_in_odom, self.odometry.twist
        nearest = self.sonar.nearest
        return {
            "x": f"{pose.x:+z.3f} m",
            "y": f"{pose.y:+z.3f} m",
            "heading": f"{degrees(pose.theta):+z.1f} deg",
            "speed": f"{twist.v:+z.3f} m/s",
            "turn": f"{degrees(twist.w):+z.1f} deg/s",
            "battery": self.battery.words,
            "motors": "on" if self.motors.enabled else "off",
            "nearest": f"{nearest:.2f} m" if isfinite(nearest) else "- m",
        }

    def _repr_html_(self) -> str:
        """Return the readings as a notebook shows them."""
        ranges = " ".join(f"{each:.2f}" if isfinite(each) else "-" for each in self.sonar.ranges)
        rows = self.readings | {"sonar [m]": ranges or "-"}
        return html_table(rows | ({"alarms": ", ".join(self.alarms)} if self.alarms else {}))


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """One scan of a laser range finder.

    Attributes:
        stamp: Time of the first reading [s, monotonic]; of the simulator's laser in the robot's
            own stream, the time at which it began to arrive.
        robot_in_odom: Pose of the robot at the first reading [m, rad].
        angles: Of the readings, ascending, counter-clockwise in the laser's frame, seen from above
            [rad], shape (N,).
        ranges: [m], shape (N,), as in REP 117: `inf` where nothing echoed, `-inf` where something
            is too near, NaN where there is no valid reading.
        reflectances: In the laser's own unit, shape (N,); empty where the laser measures none.
        beam_time: From one reading to the next [s]; negative for a laser upside down, which
            measures the last reading first; 0 where all are measured at once.
        period: From one scan to the next [s]; 0 where it is not known.
        near: Shortest range that the laser measures [m]; `far` is the longest.
        echoes: All echoes of each reading [m], the nearest first, shape (N, 1 to 3); empty where
            the laser tells only one.
        last_in_odom: Pose of the robot at the last reading [m, rad]; `None` where it stood still or
            nothing is known of its motion.
    """

    stamp: float
    sequence: int
    robot_in_odom: Pose2
    sensor_in_robot: Pose2
    angles: tuple[float, ...]
    ranges: tuple[float, ...]
    reflectances: tuple[int, ...] = ()
    laser: str = "laser"
    beam_time: float = 0.0
    period: float = 0.0
    near: float = 0.0
    far: float = inf
    echoes: tuple[tuple[float, ...], ...] = ()
    last_in_odom: Pose2 | None = None

    @property
    def sensor_in_odom(self) -> Pose2:
        """Pose of the laser at the first reading [m, rad]."""
        return self.robot_in_odom @ self.sensor_in_robot

    def points_in_odom(self) -> list[tuple[float, float]]:
        """Return the points that echoed [m], each seen from where the robot was at its time."""
        begin = self.sensor_in_odom
        readings, steps = zip(self.angles, self.ranges, strict=True), len(self.angles) - 1
        if self.last_in_odom is None or not steps:
            x, y, theta = begin.x, begin.y, begin.theta
            return [
                (x + r * cos(theta + a), y + r * sin(theta + a)) for a, r in readings if isfinite(r)
            ]
        end = self.last_in_odom @ self.sensor_in_robot
        dx, dy = (end.x - begin.x) / steps, (end.y - begin.y) / steps
        turn = wrap(end.theta - begin.theta) / steps
        return [
            (
                begin.x + i * dx + r * cos(begin.theta + i * turn + a),
                begin.y + i * dy + r * sin(begin.theta + i * turn + a),
            )
            for i, (a, r) in enumerate(readings)
            if isfinite(r)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A picture of a camera, as it came; `sequence` counts from 1 on.

    Attributes:
        stamp: When it was here [s, monotonic].
        view: Angle from its left edge to its right one [rad]; `None` where the camera does not tell
            it.
    """

    stamp: float
    sequence: int
    jpeg: bytes = field(repr=False)
    view: float | None = None
