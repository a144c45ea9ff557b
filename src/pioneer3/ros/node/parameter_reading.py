"""Reads the parameters of a node as somebody has written them."""

from dataclasses import replace
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.models.description.tree import Frames
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.ros.node.driving_parameters import DrivingSettings
from pioneer3.ros.node.laser_parameters import BELOW, LaserParameters, read_laser_parameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import (
    Foreign,
    Parameter,
    RawParameters,
    full_name,
    read,
    rows_of,
    unused,
)
from pioneer3.ros.node.parameters import BELOW_NAMES, MODEL, NAVIGATION, SIMULATED, NodeParameters

TIMEOUT: Final = {
    Profile.COMPATIBILITY: 0.6,
    Profile.STANDARD: 0.5,
    Profile.BOTH: 0.6,
    Profile.P2OS: 0.6,
    Profile.ROS2: 0.5,
}
"""Silence of cmd_vel after which the robot stops [s]."""
SHORTEST: Final = 0.1
"""No publisher keeps pace with a shorter timeout [s]."""
TF_PREFIX: Final = "tf_prefix"
"""Parameter of tf, of RosAria and p2os, too: the prefix of frames without the slash after it."""
BY_PORT: Final = Foreign("p2os", "write ~port, such as tcp://192.168.0.160:8101")
GAINS: Final = Foreign("p2os", "the robot's own gains count")
FOREIGN: Final = {
    **dict.fromkeys(("debug_aria", "aria_log_filename"), Foreign("RosAria")),
    "publish_aria_lasers": Foreign("RosAria", "the laser is on the topic scan"),
    **dict.fromkeys(("use_tcp", "tcp_remote_host", "tcp_remote_port"), BY_PORT),
    "radio": Foreign("p2os", "write the port of the modem as ~port"),
    "baud_rate": Foreign("p2os", "write ~baud"),
    "pulse": Foreign("p2os", "the node keeps the robot awake by itself"),
    "bumpstall": Foreign("p2os", "a bumper always stops the robot"),
    "joystick": Foreign("p2os", "a joystick at the robot is the robot's own setting"),
    "direct_wheel_vel_control": Foreign("p2os", "the robot's own controller drives its wheels"),
    **dict.fromkeys(("rot_kp", "rot_kv", "rot_ki", "trans_kp", "trans_kv", "trans_ki"), GAINS),
}
"""Parameters of other nodes that have no effect here, where no row has their names."""


def read_parameters(raw: RawParameters, profile: Profile | None = None) -> NodeParameters:
    """Return the parameters of a node; without a profile, one of them tells which names count.

    Raises:
        ConfigError: a value is of the wrong kind or out of bounds.
    """
    if profile is None:
        named = {name: value for name, value in raw.items() if name == "profile"}
        profile = Profile(read(NodeParameters, named, Profile.COMPATIBILITY).profile)
    if isinstance(prefix := raw.get(TF_PREFIX), str):
        raw = {"frame_prefix": f"{prefix.strip('/')}/", **raw}
    given = replace(
        read(NodeParameters, raw, profile),
        profile=profile,
        driving=read(DrivingSettings, raw, profile),
        laser=read_laser_parameters(part_of(raw, BELOW, profile), profile, BELOW),
        navigation=_navigation(raw, profile),
    )
    timeout = given.cmd_vel_timeout
    if timeout and timeout < SHORTEST:
        raise ConfigError(
            f"{full_name('cmd_vel_timeout', profile)} must be {SHORTEST:g} s or more, or 0 for"
            f" never, not {timeout:g}"
        )
    if given.sonar_min_range_m >= given.sonar_max_range_m:
        least, most = (full_name(f"sonar_{each}_range_m", profile) for each in ("min", "max"))
        raise ConfigError(f"{least} must be less than {most}")
    _ = given.initial_pose
    return _completed(given)


def unused_parameters(raw: RawParameters, profile: Profile) -> list[str]:
    """Return a sentence for each parameter in `raw` that changes nothing."""
    named = set(raw) - {MODEL, SIMULATED, *BELOW_NAMES}
    rows = *rows_of(NodeParameters), *rows_of(DrivingSettings)
    sentences = unused(named, rows, profile, foreign=FOREIGN)
    for below in sorted(BELOW_NAMES - {BELOW}):
        part = part_of(raw, below, profile)
        sentences += unused(part, _rows_below(below), profile, below=below, foreign={})
    return sentences


def part_of(raw: RawParameters, below: str, profile: Profile) -> RawParameters:
    """Return the parameters `below` a name; ConfigError if the name is a value itself."""
    part = raw.get(below, {})
    if not isinstance(part, dict):
        row = (rows_of(LaserParameters) if below == BELOW else _rows_below(below))[0]
        name, such = full_name(below, profile), full_name(row.name, profile, below)
        raise ConfigError(f"{name} holds parameters such as {such}, not {part!r}")
    return part


def _rows_below(below: str) -> tuple[Parameter, ...]:
    """Return the settings of navigation `below` a name, without that."""
    return tuple(
        replace(row, name=row.name.partition(".")[2])
        for row in NAVIGATION
        if row.name.partition(".")[0] == below
    )


def _navigation(raw: RawParameters, profile: Profile) -> NavigationSettings:
    values: dict[str, float | str] = {}
    for row in NAVIGATION:
        below, _, name = row.name.partition(".")
        part = part_of(raw, below, profile)
        if name in part:
            value = row.checked(part[name], full_name(name, profile, below))
            assert isinstance(value, float | int)
            values[row.name] = value
    return AS_SHIPPED.with_values(values)


def _completed(given: NodeParameters) -> NodeParameters:
    """Return the parameters with those defaults that depend on the profile and on others."""
    profile, default, footprint = given.profile, Frames(), given.footprint_frame_id
    # /tf of RosAria and p2os has no footprint, and nobody else but /tf_static tells where the
    # robot's frame is in it.
    of_old = profile in {Profile.COMPATIBILITY, Profile.P2OS} and given.publish_tf
    if footprint is None:
        hidden = of_old or not given.publish_description
        footprint = "" if hidden else default.footprint
    if footprint.lstrip("/") == given.base_frame_id.lstrip("/"):
        footprint = ""
    at_base = profile in {Profile.STANDARD, Profile.P2OS, Profile.ROS2}
    of_scans = "laser_frame" if profile is Profile.COMPATIBILITY else default.laser
    timeout = TIMEOUT[profile] if given.cmd_vel_timeout is None else given.cmd_vel_timeout
    return replace(
        given,
        cmd_vel_timeout=timeout,
        footprint_frame_id=footprint,
        bumpers_frame=given.bumpers_frame or (given.base_frame_id if at_base else default.bumpers),
        laser_frame_id=given.laser_frame_id or given.laser.frame_id or of_scans,
    )
