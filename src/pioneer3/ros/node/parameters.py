"""The node's own parameters, as somebody has written them on the ROS parameter server."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from math import inf, radians
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models.description.tree import Frames
from pioneer3.ros.messages.update import DRIVING, Beam, MessageOptions, NoEcho
from pioneer3.ros.node.laser_parameters import BELOW, LaserParameters, read_laser_parameters
from pioneer3.ros.node.names import Profile, checked_lab_name
from pioneer3.ros.node.parameter_table import BY_NAME, GOAL_SPEED, SHORTEST, names_in
from pioneer3.ros.node.values import (
    RawParameters,
    choice,
    flag,
    frame,
    number,
    numbers,
    place,
    text,
    words,
)

TIMEOUT: Final = {
    Profile.COMPATIBILITY: 0.6,
    Profile.STANDARD: 0.5,
    Profile.BOTH: 0.6,
    Profile.ROS2: 0.5,
}
"""Silence of cmd_vel after which the robot stops [s]."""
LONG: Final = 2.0
"""With a longer timeout [s] a robot drives on for metres when its publisher has crashed."""
FRAMES: Final = {
    Profile.COMPATIBILITY: ("odom_frame", "base_link_frame"),
    Profile.STANDARD: ("odom_frame_id", "base_frame_id"),
    Profile.BOTH: ("odom_frame_id", "base_frame_id"),
    Profile.ROS2: ("odom_frame_id", "base_frame_id"),
}
"""Parameters for the names of the two frames."""
LASER_FRAME: Final = {
    Profile.COMPATIBILITY: "laser_frame",
    Profile.STANDARD: "laser",
    Profile.BOTH: "laser",
    Profile.ROS2: "laser",
}
"""RosAria's name, and today's."""
OF_FRAMES: Final = frozenset(name for pair in FRAMES.values() for name in pair)
MODEL: Final = "robot_model"
SIMULATED: Final = "simulated"
"""Parameters that the node writes itself while it runs: the robot's model, and whether it is a
simulator."""
IGNORED: Final = ("debug_aria", "aria_log_filename", "publish_aria_lasers")
"""Parameters of RosAria that have no effect here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeParameters:
    """The parameters of a node, checked.

    Attributes:
        profile: Which names it uses.
        port: URL of the robot; `None` to look for it.
        model: What the robot really is: a name, or a file; `None` for what it says.
        baud: Serial speed to try first.
        timeout: Silence of cmd_vel after which the robot stops [s]; `inf` for never.
        resumes: Whether a stream of cmd_vel that fell silent goes on by itself.
        lab_name: The robot's name in the lab, such as `p3at_1_113`; `None` elsewhere.
        max_speed: Never to be exceeded [m/s], or `None` for the robot's own.
        max_turn_rate: Never to be exceeded [rad/s], or `None` for the robot's own.
        auto_enable: Whether a fresh command switches the motors on.
        sonar: Whether the sonars ping.
        laser: Of the laser range finder at the computer.
        line_map: To navigate on: a file, or the name of a map that ships; `None` for none.
        start: Where the robot is on it, as :func:`place` reads it; `None` for the map's home.
        stamped: Whether `cmd_vel` is of TwistStamped; `None` for the custom of the distribution.
        sim_time: Whether stamps are those of `/clock`.
        autostart: Whether the node begins by itself.
        map_tf: Whether `/tf` has the odom frame in the map, if there is one.
        goal_speed: On the way to goals at most [m/s].
        camera: URL of the MJPEG stream of the camera; `None` for none.
        camera_view: Its field of view from left to right [rad], if it does not tell that; `None`
            where it is not known.
        options: Of messages.
    """

    profile: Profile = Profile.COMPATIBILITY
    port: str | None = None
    model: str | None = None
    baud: int | None = None
    timeout: float = TIMEOUT[Profile.COMPATIBILITY]
    resumes: bool = True
    lab_name: str | None = None
    max_speed: float | None = None
    max_turn_rate: float | None = None
    auto_enable: bool = True
    sonar: bool = True
    laser: LaserParameters = field(default_factory=LaserParameters)
    line_map: str | None = None
    start: Pose2 | str | None = None
    stamped: bool | None = None
    sim_time: bool = False
    autostart: bool = True
    map_tf: bool = True
    goal_speed: float = GOAL_SPEED
    camera: str | None = None
    camera_view: float | None = None
    options: MessageOptions = field(
        default_factory=lambda: MessageOptions(frames=Frames(footprint="", laser="laser_frame"))
    )


def read_parameters(raw: RawParameters, profile: Profile | None = None) -> NodeParameters:
    """Return the parameters of a node.

    Args:
        raw: As somebody has written them.
        profile: Which names count; `None` where a parameter says so.

    Raises:
        ConfigError: a value is of the wrong kind or out of range.
    """
    profile = _profile(raw) if profile is None else profile
    return NodeParameters(
        profile=profile,
        port=_port(raw.get("port")),
        model=text(raw, "model"),
        baud=_baud(raw),
        timeout=_timeout(raw, profile),
        resumes=flag(raw, "resume_cmd_vel", default=True),
        lab_name=checked_lab_name(raw["lab_name"]) if raw.get("lab_name") else None,
        max_speed=_maximum(raw, "max_linear_velocity"),
        max_turn_rate=_maximum(raw, "max_angular_velocity"),
        auto_enable=flag(raw, "auto_enable_motors", default=True),
        sonar=flag(raw, "use_sonar", default=True),
        laser=read_laser_parameters(laser_part(raw)),
        line_map=text(raw, "map"),
        start=place(told) if (told := text(raw, "start")) else None,
        map_tf=flag(raw, "tf_broadcast", default=True),
        stamped=flag(raw, "enable_stamped_cmd_vel", default=False)
        if "enable_stamped_cmd_vel" in raw
        else None,
        sim_time=flag(raw, "use_sim_time", default=False),
        autostart=flag(raw, "autostart", default=True),
        goal_speed=_number(raw, "goal_speed"),
        camera=text(raw, "camera_url"),
        camera_view=radians(_number(raw, "camera_view_deg")) or None,
        options=_options(raw, profile),
    )


def unused_parameters(
    raw: Iterable[str], profile: Profile, others: Iterable[str] = ()
) -> list[str]:
    """Return a sentence for each parameter in `raw` that changes nothing.

    `others` are known elsewhere.
    """
    known = {*names_in(profile) - OF_FRAMES, MODEL, SIMULATED, *FRAMES[profile], *others}
    sentences = []
    for name in sorted(set(raw) - known):
        if name in IGNORED:
            sentences.append(f"parameter ~{name} of RosAria has no effect here")
        else:
            close = get_close_matches(name, known, 1)
            hint = f"; did you mean ~{close[0]}?" if close else ""
            sentences.append(f"parameter ~{name} is unknown{hint}")
    return sentences


def laser_part(raw: RawParameters) -> RawParameters:
    """Return the parameters below `~laser`.

    Raises:
        ConfigError: `~laser` is a value itself.
    """
    part = raw.get(BELOW, {})
    if not isinstance(part, dict):
        raise ConfigError(f"~{BELOW} holds parameters such as ~{BELOW}/serial_port, not {part!r}")
    return part


def _options(raw: RawParameters, profile: Profile) -> MessageOptions:
    prefix = raw.get("frame_prefix", "")
    if not isinstance(prefix, str):
        raise ConfigError(f"~frame_prefix must be text such as robot1/, not {prefix!r}")
    description = flag(raw, "publish_description", default=True)
    beam = Beam(
        field_of_view=_number(raw, "sonar_fov_rad"),
        nearest=_number(raw, "sonar_min_range_m"),
        farthest=_number(raw, "sonar_max_range_m"),
        no_echo=choice(raw, "sonar_no_echo", NoEcho.MAX_RANGE),
    )
    if beam.nearest >= beam.farthest:
        raise ConfigError("~sonar_min_range_m must be less than ~sonar_max_range_m")
    high = raw.get("sonar_z_offset_m")
    return MessageOptions(
        frames=_frames(raw, profile),
        prefix=prefix.lstrip("/"),
        odometry_tf=flag(raw, "publish_tf", default=True),
        ranges=flag(raw, "sonar_publish_ranges", default=True),
        cloud=flag(raw, "sonar_publish_cloud", default=True),
        description=description,
        wheels_tf=description and profile is not Profile.COMPATIBILITY,
        pose_variances=numbers(raw, "pose_covariance_diagonal", DRIVING),
        twist_variances=numbers(raw, "twist_covariance_diagonal", DRIVING),
        beam=beam,
        sonar_height=None if high is None else _number(raw, "sonar_z_offset_m"),
        wheel_joints=words(raw, "wheel_joint_names"),
        map_frame=frame(raw, "global_frame_id", MessageOptions().map_frame),
        tolerance=_number(raw, "transform_tolerance"),
    )


def _frames(raw: RawParameters, profile: Profile) -> Frames:
    laser = read_laser_parameters(laser_part(raw)).frame or LASER_FRAME[profile]
    odom, base_frame = FRAMES[profile]
    default = Frames()
    base = frame(raw, base_frame, default.base)
    return Frames(
        odom=frame(raw, odom, default.odom),
        base=base,
        footprint=_footprint(raw, profile),
        bumpers=frame(
            raw,
            "bumpers_frame",
            base if profile in {Profile.STANDARD, Profile.ROS2} else default.bumpers,
        ),
        sonar=frame(raw, "sonar_frame", default.sonar),
        sonar_prefix=frame(raw, "sonar_frame_prefix", default.sonar_prefix),
        laser=frame(raw, "laser_frame_id", laser),
    )


def _footprint(raw: RawParameters, profile: Profile) -> str:
    """Return the frame between those of odometry and the robot; empty for none.

    RosAria's `/tf` has none, and nobody else but `/tf_static` tells where the robot's frame is in
    it.
    """
    name = "footprint_frame_id"
    if name in raw:
        return frame(raw, name, "") if raw[name] else ""
    of_rosaria = profile is Profile.COMPATIBILITY and flag(raw, "publish_tf", default=True)
    described = flag(raw, "publish_description", default=True)
    return "" if of_rosaria or not described else Frames().footprint


def _profile(raw: RawParameters) -> Profile:
    choices = BY_NAME["profile"].choices
    value = raw.get("profile", Profile.COMPATIBILITY)
    if value not in choices:
        raise ConfigError(f"~profile must be {' or '.join(choices)}, not {value!r}")
    return Profile(str(value))


def _maximum(raw: RawParameters, name: str) -> float | None:
    return _number(raw, name) if name in raw else None


def _number(raw: RawParameters, name: str, otherwise: float = 0.0) -> float:
    """Return a number within the bounds that the table has."""
    row = BY_NAME[name]
    assert row.low is not None
    assert row.high is not None
    default = row.default if isinstance(row.default, int | float) else otherwise
    return number(raw, name, default, row.low, row.high)


def _port(value: object) -> str | None:
    """Return a URL; RosAria writes TCP as `host:8101`."""
    if value is None or value in ("", "auto"):
        return None
    if not isinstance(value, str):
        raise ConfigError(f"~port must be text such as /dev/ttyUSB0, not {value!r}")
    return f"tcp://{value}" if re.fullmatch(r"[\w.-]+:\d+", value) else value


def _baud(raw: RawParameters) -> int | None:
    if not isinstance(raw.get("baud", 0), int):
        raise ConfigError(f"~baud must be a whole number, not {raw['baud']!r}")
    return int(_number(raw, "baud")) or None


def _timeout(raw: RawParameters, profile: Profile) -> float:
    value = _number(raw, "cmd_vel_timeout", TIMEOUT[profile])
    if value != 0 and value < SHORTEST:
        raise ConfigError(
            f"~cmd_vel_timeout must be {SHORTEST:g} s or more, or 0 for never, not {value:g}"
        )
    return value or inf
