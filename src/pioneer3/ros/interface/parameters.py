"""The node's own parameters, as somebody has written them on the ROS parameter server."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from math import inf, isfinite, pi
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.description.frames import Frames
from pioneer3.ros.interface.given import Given, choice, flag, frame, number, numbers, words
from pioneer3.ros.interface.lab import checked_lab_name
from pioneer3.ros.interface.topics import Profile
from pioneer3.ros.messages.conventions import DRIVING, Beam, Conventions, NoEcho

TIMEOUT: Final = {Profile.COMPATIBILITY: 0.6, Profile.STANDARD: 0.5, Profile.BOTH: 0.6}
"""Silence of cmd_vel after which the robot stops [s]."""
SHORTEST: Final = 0.1
"""No publisher keeps pace with a shorter timeout [s]."""
LONG: Final = 2.0
"""With a longer timeout [s] a robot drives on for metres when its publisher has crashed."""
FRAMES: Final = {
    Profile.COMPATIBILITY: ("odom_frame", "base_link_frame"),
    Profile.STANDARD: ("odom_frame_id", "base_frame_id"),
    Profile.BOTH: ("odom_frame_id", "base_frame_id"),
}
"""Parameters for the names of the two frames."""
LASER_FRAME: Final = {
    Profile.COMPATIBILITY: "laser_frame",
    Profile.STANDARD: "laser",
    Profile.BOTH: "laser",
}
"""RosAria's name, so that it is in nobody's way, and today's."""
OTHERS: Final = (
    "profile",
    "port",
    "baud",
    "cmd_vel_timeout",
    "lab_name",
    "bumpers_frame",
    "sonar_frame",
    "laser_frame_id",
    "frame_prefix",
    "publish_tf",
    "publish_description",
    "pose_covariance_diagonal",
    "twist_covariance_diagonal",
    "use_sonar",
    "sonar_publish_ranges",
    "sonar_publish_cloud",
    "sonar_frame_prefix",
    "sonar_fov_rad",
    "sonar_min_range_m",
    "sonar_max_range_m",
    "sonar_z_offset_m",
    "sonar_no_echo",
    "wheel_joint_names",
    "auto_enable_motors",
    "max_linear_velocity",
    "max_angular_velocity",
)
MODEL: Final = "robot_model"
SIMULATED: Final = "simulated"
"""What the node writes there itself while it runs: which model it drives, and whether that is a
simulator."""
IGNORED: Final = ("debug_aria", "aria_log_filename", "publish_aria_lasers")
"""What RosAria reads and this node has no use for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameters:
    """How a node is to be.

    Attributes:
        profile: Which names it uses.
        port: URL of the robot; `None` to look for it.
        baud: Serial speed to try first.
        timeout: Silence of cmd_vel after which the robot stops [s]; `inf` for never.
        lab_name: What the lab calls the robot, such as `p3at_1_113`; `None` elsewhere.
        max_speed: Never to be exceeded [m/s], or `None` for the robot's own.
        max_turn_rate: Never to be exceeded [rad/s], or `None` for the robot's own.
        auto_enable: Whether a fresh command switches the motors on.
        sonar: Whether the sonars ping.
        ranges: Whether each transducer has a topic.
        cloud: Whether all echoes have one.
        conventions: How messages are to be.
    """

    profile: Profile = Profile.COMPATIBILITY
    port: str | None = None
    baud: int | None = None
    timeout: float = TIMEOUT[Profile.COMPATIBILITY]
    lab_name: str | None = None
    max_speed: float | None = None
    max_turn_rate: float | None = None
    auto_enable: bool = True
    sonar: bool = True
    ranges: bool = True
    cloud: bool = True
    conventions: Conventions = field(
        default_factory=lambda: Conventions(frames=Frames(laser="laser_frame"))
    )


def read_parameters(given: Given) -> Parameters:
    """Return what `given`, the parameters below the node's name, says.

    Raises:
        ConfigError: a value is of the wrong kind or out of range.
    """
    profile = choice(given, "profile", Profile.COMPATIBILITY)
    return Parameters(
        profile=profile,
        port=_port(given.get("port")),
        baud=_baud(given.get("baud", 0)),
        timeout=_timeout(given.get("cmd_vel_timeout", TIMEOUT[profile])),
        lab_name=checked_lab_name(given["lab_name"]) if given.get("lab_name") else None,
        max_speed=_maximum(given, "max_linear_velocity"),
        max_turn_rate=_maximum(given, "max_angular_velocity"),
        auto_enable=flag(given, "auto_enable_motors", usual=True),
        sonar=flag(given, "use_sonar", usual=True),
        ranges=flag(given, "sonar_publish_ranges", usual=True),
        cloud=flag(given, "sonar_publish_cloud", usual=True),
        conventions=_conventions(given, profile),
    )


def doubts(given: Iterable[str], profile: Profile, others: Iterable[str] = ()) -> list[str]:
    """Return a sentence for each parameter of `given` that changes nothing.

    `others` are known to somebody else.
    """
    known = {*OTHERS, MODEL, SIMULATED, *FRAMES[profile], *others}
    sentences = []
    for name in sorted(set(given) - known):
        if name in IGNORED:
            sentences.append(f"parameter ~{name} of RosAria has no effect here")
        else:
            close = get_close_matches(name, known, 1)
            hint = f"; did you mean ~{close[0]}?" if close else ""
            sentences.append(f"parameter ~{name} is unknown{hint}")
    return sentences


def _conventions(given: Given, profile: Profile) -> Conventions:
    prefix = given.get("frame_prefix", "")
    if not isinstance(prefix, str):
        raise ConfigError(f"~frame_prefix must be text such as robot1/, not {prefix!r}")
    description = flag(given, "publish_description", usual=True)
    beam = Beam(
        field_of_view=number(given, "sonar_fov_rad", Beam().field_of_view, 0.01, pi),
        nearest=number(given, "sonar_min_range_m", Beam().nearest, 0.0, Beam().farthest),
        farthest=number(given, "sonar_max_range_m", Beam().farthest, 0.1, Beam().farthest),
        no_echo=choice(given, "sonar_no_echo", NoEcho.MAX_RANGE),
    )
    if beam.nearest >= beam.farthest:
        raise ConfigError("~sonar_min_range_m must be less than ~sonar_max_range_m")
    high = given.get("sonar_z_offset_m")
    return Conventions(
        frames=_frames(given, profile),
        prefix=prefix.lstrip("/"),
        odometry_in_tree=flag(given, "publish_tf", usual=True),
        description=description,
        wheels_in_tree=description and profile is not Profile.COMPATIBILITY,
        pose_variances=numbers(given, "pose_covariance_diagonal", DRIVING),
        twist_variances=numbers(given, "twist_covariance_diagonal", DRIVING),
        beam=beam,
        sonar_height=None if high is None else number(given, "sonar_z_offset_m", 0, -1, 3),
        wheel_joints=words(given, "wheel_joint_names"),
    )


def _frames(given: Given, profile: Profile) -> Frames:
    odom, base_frame = FRAMES[profile]
    usual = Frames()
    base = frame(given, base_frame, usual.base)
    return Frames(
        odom=frame(given, odom, usual.odom),
        base=base,
        bumpers=frame(
            given, "bumpers_frame", base if profile is Profile.STANDARD else usual.bumpers
        ),
        sonar=frame(given, "sonar_frame", usual.sonar),
        sonar_prefix=frame(given, "sonar_frame_prefix", usual.sonar_prefix),
        laser=frame(given, "laser_frame_id", LASER_FRAME[profile]),
    )


def _maximum(given: Given, name: str) -> float | None:
    return number(given, name, 0.0, 0.001, 10.0) if name in given else None


def _port(value: object) -> str | None:
    """Return a URL; RosAria writes TCP as `host:8101`."""
    if value is None or value in ("", "auto"):
        return None
    if not isinstance(value, str):
        raise ConfigError(f"~port must be text such as /dev/ttyUSB0, not {value!r}")
    return f"tcp://{value}" if re.fullmatch(r"[\w.-]+:\d+", value) else value


def _baud(value: object) -> int | None:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ConfigError(f"~baud must be a whole number, 0 for any, not {value!r}")
    return value or None


def _timeout(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise ConfigError(f"~cmd_vel_timeout must be a number of seconds, not {value!r}")
    if value != 0 and value < SHORTEST:
        raise ConfigError(
            f"~cmd_vel_timeout must be {SHORTEST:g} s or more, or 0 for never, not {value:g}"
        )
    return float(value) or inf
