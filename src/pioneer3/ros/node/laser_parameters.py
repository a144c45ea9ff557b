"""Parameters of the laser range finder: the names of urg_node (REP 138) and of hokuyo_node.

The command line may give lasers too. It comes first: the port among the parameters counts where the
command line gives none. It has no settings of scans, so those of the parameters always count. They
are for the first laser, as the topic `scan` is.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees, pi
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.lasers.client import AS_DELIVERED, ScanSettings
from pioneer3.models.lasers import HOKUYO_PORT
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.ros.node.values import RawParameters, flag, number

BELOW: Final = "laser"
"""In the robot's node these parameters are below this name: `~laser/serial_port`."""
MOST_OFFSET: Final = 0.25
"""Bound of `time_offset`, as hokuyo_node has it [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserParameter:
    """A parameter of a laser.

    Attributes:
        name: In REP 138.
        hokuyo: In hokuyo_node, if another.
        note: Its meaning, for people.
        of_port: Whether it says where the laser is.
        of_scans: Whether it is a setting of the scans.
    """

    name: str
    hokuyo: str = ""
    note: str
    of_port: bool = False
    of_scans: bool = False


PARAMETERS: Final = (
    LaserParameter(name="serial_port", hokuyo="port", note="such as /dev/ttyACM0", of_port=True),
    LaserParameter(name="serial_baud", note="accepted; the speed is found"),
    LaserParameter(
        name="ip_address",
        note="of a laser in the network; comes before serial_port",
        of_port=True,
    ),
    LaserParameter(name="ip_port", note=f"{HOKUYO_PORT} unless given", of_port=True),
    LaserParameter(name="frame_id", hokuyo="frameid", note="of the scans; `laser` unless given"),
    LaserParameter(
        name="calibrate_time",
        note="compare the laser's clock with ours; true unless given",
        of_scans=True,
    ),
    LaserParameter(
        name="time_offset", note="added to the times of scans [s], within 0.25", of_scans=True
    ),
    LaserParameter(
        name="publish_intensity", hokuyo="intensity", note="false unless given", of_scans=True
    ),
    LaserParameter(
        name="publish_multiecho", note="all echoes, from lasers that have them", of_scans=True
    ),
    LaserParameter(
        name="angle_min",
        hokuyo="min_ang",
        note="first direction [rad]; all unless given",
        of_scans=True,
    ),
    LaserParameter(
        name="angle_max",
        hokuyo="max_ang",
        note="last direction [rad]; all unless given",
        of_scans=True,
    ),
    LaserParameter(name="cluster", note="readings that become one, 1 to 99", of_scans=True),
    LaserParameter(name="skip", note="scans left out after each one, 0 to 9", of_scans=True),
)
IGNORED: Final = (
    "allow_unsafe_settings",
    "diagnostics_tolerance",
    "diagnostics_window_time",
    "error_limit",
    "get_detailed_status",
    "default_user_latency",
    "min_ang_degrees",
    "max_ang_degrees",
)
"""Parameters of those nodes that have no effect here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserParameters:
    """The parameters of a laser, checked.

    Attributes:
        url: Of its port, or `None` where none is given.
        frame: Of its scans, or `None` where none is given.
        time_offset: Added to the times of scans [s].
        settings: For the scans.
    """

    url: str | None = None
    frame: str | None = None
    time_offset: float = 0.0
    settings: ScanSettings = AS_DELIVERED

    @property
    def ports(self) -> tuple[str, ...]:
        """The port, if one is given."""
        return () if self.url is None else (self.url,)

    def applied_to(self, lasers: Sequence[LaserSpec]) -> tuple[LaserSpec, ...]:
        """Return `lasers`, the first one with the settings of the parameters."""
        first = (
            replace(laser, settings=self.settings, time_offset=self.time_offset)
            for laser in lasers[:1]
        )
        return (*first, *lasers[1:])


def read_laser_parameters(raw: RawParameters) -> LaserParameters:
    """Return the parameters of a laser; the names of hokuyo_node count where REP 138's are missing.

    Raises:
        ConfigError: a value is of the wrong kind or out of range.
    """
    values = _renamed(raw)
    first = number(values, "angle_min", -pi, -pi, pi) if "angle_min" in values else None
    last = number(values, "angle_max", pi, -pi, pi) if "angle_max" in values else None
    if first is not None and last is not None and first >= last:
        raise ConfigError(
            f"~angle_min must be less than ~angle_max, not {degrees(first):.0f} and"
            f" {degrees(last):.0f} degrees"
        )
    return LaserParameters(
        url=_url(values),
        frame=_text(values, "frame_id"),
        time_offset=number(values, "time_offset", 0.0, -MOST_OFFSET, MOST_OFFSET),
        settings=ScanSettings(
            first=first,
            last=last,
            cluster=_whole(values, "cluster", 1, 1, 99),
            skip=_whole(values, "skip", 0, 0, 9),
            intensities=flag(values, "publish_intensity", default=False),
            multi_echo=flag(values, "publish_multiecho", default=False),
            calibrate_time=flag(values, "calibrate_time", default=True),
        ),
    )


def unused_laser_parameters(raw: RawParameters, below: str = "") -> list[str]:
    """Return a sentence for each parameter in `raw`, which lies `below` a name, without effect."""
    place = f"~{below}/" if below else "~"
    known = {name for each in PARAMETERS for name in (each.name, each.hokuyo)}
    return [
        f"parameter {place}{name} of hokuyo_node or urg_node has no effect here"
        if name in IGNORED
        else f"parameter {place}{name} of the laser is unknown"
        for name in sorted(set(raw) - known)
    ]


def overridden_laser_parameters(
    raw: RawParameters, given: Sequence[str], below: str = ""
) -> list[str]:
    """Return a sentence for each parameter in `raw` that is known and does not apply.

    Args:
        raw: The parameters.
        given: Ports of lasers on the command line.
        below: Name that the parameters lie below.

    Raises:
        ConfigError: as :func:`read_laser_parameters` does.
    """
    place = f"~{below}/" if below else "~"
    url = read_laser_parameters(raw).url
    if given:
        ignored = [] if url in given else [each for each in PARAMETERS if each.of_port]
        reason = f"--laser or PIONEER3_LASER gives {' and '.join(given)}"
    else:
        ignored = [each for each in PARAMETERS if each.of_scans] if url is None else []
        reason = f"no laser is given; give it with --laser or {place}serial_port"
    names = {name for each in ignored for name in (each.name, each.hokuyo)}
    return [f"parameter {place}{name} is ignored: {reason}" for name in sorted(names & set(raw))]


def _renamed(raw: RawParameters) -> Mapping[str, object]:
    names = {each.hokuyo: each.name for each in PARAMETERS if each.hokuyo}
    old = {names[name]: value for name, value in raw.items() if name in names}
    return old | {name: value for name, value in raw.items() if name not in names}


def _url(values: RawParameters) -> str | None:
    address = _text(values, "ip_address")
    if address is not None:
        return f"tcp://{address}:{_whole(values, 'ip_port', HOKUYO_PORT, 1, 65535)}"
    return _text(values, "serial_port")


def _text(values: RawParameters, name: str) -> str | None:
    value = values.get(name, "")
    if not isinstance(value, str) or (value and not re.fullmatch(r"\S+", value)):
        raise ConfigError(f"~{name} must be text without spaces, not {value!r}")
    return value.lstrip("/") if name == "frame_id" and value else value or None


def _whole(values: RawParameters, name: str, default: int, low: int, high: int) -> int:
    value = values.get(name, default)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise ConfigError(f"~{name} must be a whole number from {low} to {high}, not {value!r}")
    return value
