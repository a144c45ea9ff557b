"""Parameters of the laser range finder: the names of urg_node (REP 138), and other drivers'.

The command line may give lasers too. It comes first: the port among the parameters counts where the
command line gives none. It has no settings of scans, so those of the parameters always count. They
are for the first laser, as the topic `scan` is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi, radians
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.lasers.client import ScanSettings
from pioneer3.models.lasers import HOKUYO_PORT, LASERS
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import (
    Effect,
    Foreign,
    Parameter,
    RawParameters,
    full_name,
    read,
    rows_of,
    unused,
)

BELOW: Final = "laser"
"""In the robot's node these parameters are below this name: `~laser/serial_port`."""
SICK_PORT: Final = LASERS["lms-111"].tcp_ports[0]
"""TCP port of lasers that drivers of SICK's lasers name by `host` or `hostname`."""
SICK_HOSTS: Final = ("host", "hostname")
"""Names of the address of a laser in LMS1xx, and in sick_tim and sick_scan."""
URG, SICKTOOLBOX = "hokuyo_node or urg_node", "sicktoolbox_wrapper"
FOREIGN: Final = {
    **dict.fromkeys(
        (
            "allow_unsafe_settings",
            "diagnostics_tolerance",
            "diagnostics_window_time",
            "error_limit",
            "get_detailed_status",
            "default_user_latency",
        ),
        Foreign(URG),
    ),
    "min_ang_degrees": Foreign(URG, "write ~angle_min in radians"),
    "max_ang_degrees": Foreign(URG, "write ~angle_max in radians"),
    "connect_delay": Foreign(SICKTOOLBOX, "the laser is looked for until it answers"),
    "units": Foreign(SICKTOOLBOX, "scans are in metres"),
    **dict.fromkeys(
        (
            "desired_frequency",
            "min_frequency",
            "max_frequency",
            "frequency_tolerance",
            "window_size",
            "min_acceptable_delay",
            "max_acceptable_delay",
            "hardware_id",
        ),
        Foreign(SICKTOOLBOX),
    ),
    "start_angle": Foreign(f"sickld of {SICKTOOLBOX}", "write ~angle_min in radians"),
    "stop_angle": Foreign(f"sickld of {SICKTOOLBOX}", "write ~angle_max in radians"),
    "scan_rate": Foreign(f"sickld of {SICKTOOLBOX}", "write ~skip for fewer scans"),
    "publish_min_range_as_inf": Foreign("LMS1xx", "nothing in range is inf, as in REP 117"),
}
"""Parameters of other drivers that have no effect here."""


word = partial(Parameter, pattern=r"\S*", form="text without spaces")
of_scans = partial(Parameter, acts=Effect.ON_SCANS)
direction = partial(of_scans, low=-pi, high=pi, unit="rad", otherwise="all")


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserParameters:
    """The parameters of a laser; :func:`read_laser_parameters` reads and checks them."""

    serial_port: str = word("such as /dev/ttyACM0", acts=Effect.ON_PORT, aliases=("port",)).field(
        ""
    )
    serial_baud: int | None = Parameter(
        "accepted; the speed is found", otherwise="what the laser has", aliases=("baud",)
    ).field(None)
    ip_address: str = word(
        "of a laser in the network; comes before serial_port. By another name it is a SICK's, at"
        f" {SICK_PORT} or at `port`",
        acts=Effect.ON_PORT,
        aliases=SICK_HOSTS,
    ).field("")
    ip_port: int = Parameter(
        "of a laser in the network", low=1, high=65535, acts=Effect.ON_PORT
    ).field(HOKUYO_PORT)
    frame_id: str = word(
        "of the scans", otherwise="`laser`", aliases=("frameid", "laser_frame_id")
    ).field("")
    calibrate_time: bool = of_scans("compare the laser's clock with ours").field(True)
    time_offset: float = of_scans(
        "added to the times of scans", low=-0.25, high=0.25, unit="s"
    ).field(0.0)
    publish_intensity: bool = of_scans("the strength of each echo", aliases=("intensity",)).field(
        False
    )
    publish_multiecho: bool = of_scans("all echoes, from lasers that have them").field(False)
    angle_min: float | None = direction("first direction", aliases=("min_ang",)).field(None)
    angle_max: float | None = direction("last direction", aliases=("max_ang",)).field(None)
    angle: float = of_scans(
        "field of view around straight ahead, where `angle_min` and `angle_max` are not given; 0"
        " is the whole one",
        low=0.0,
        high=360.0,
        unit="degrees",
    ).field(0.0)
    resolution: float = of_scans(
        "from one reading to the next, or what comes nearest; 0 is the laser's own",
        low=0.0,
        high=10.0,
        unit="degrees",
    ).field(0.0)
    inverted: bool = of_scans(
        "whether the laser hangs head down: its scans are mirrored, to be seen from above"
    ).field(False)
    cluster: int = of_scans("readings that become one", low=1, high=99).field(1)
    skip: int = of_scans("scans left out after each one", low=0, high=9).field(0)

    @property
    def ports(self) -> tuple[str, ...]:
        """URL of the port, if one is given."""
        if self.ip_address:
            return (f"tcp://{self.ip_address}:{self.ip_port}",)
        return (self.serial_port,) if self.serial_port else ()

    @property
    def settings(self) -> ScanSettings:
        """Settings of the scans."""
        half = radians(self.angle) / 2 or None
        first = -half if self.angle_min is None and half else self.angle_min
        last = half if self.angle_max is None else self.angle_max
        if self.inverted:
            first, last = (None if end is None else -end for end in (last, first))
        return ScanSettings(
            first=first,
            last=last,
            step=radians(self.resolution) or None,
            cluster=self.cluster,
            skip=self.skip,
            intensities=self.publish_intensity,
            multi_echo=self.publish_multiecho,
            calibrate_time=self.calibrate_time,
        )

    def applied_to(self, lasers: Sequence[LaserSpec]) -> tuple[LaserSpec, ...]:
        """Return `lasers`, the first one with the settings of the parameters."""
        first = (
            replace(
                laser, settings=self.settings, time_offset=self.time_offset, inverted=self.inverted
            )
            for laser in lasers[:1]
        )
        return (*first, *lasers[1:])


def read_laser_parameters(
    raw: RawParameters, profile: Profile = Profile.STANDARD, below: str = ""
) -> LaserParameters:
    """Return the parameters of a laser; names of other drivers count where REP 138's are missing.

    Raises:
        ConfigError: a value is of the wrong kind or out of bounds.
    """
    found = read(LaserParameters, _with_port_of_sick(raw), profile, below)
    first, last = found.angle_min, found.angle_max
    if first is not None and last is not None and first >= last:
        least, most = (full_name(name, profile, below) for name in ("angle_min", "angle_max"))
        raise ConfigError(f"{least} must be less than {most}, not {first:.2f} and {last:.2f} rad")
    return found


def _with_port_of_sick(raw: RawParameters) -> RawParameters:
    """Return parameters with `ip_port` where the address is written as for SICK's lasers."""
    if not raw.keys() & set(SICK_HOSTS) or "ip_address" in raw:
        return raw
    port = raw.get("port", SICK_PORT)
    number = int(port) if isinstance(port, str) and port.isdecimal() else port
    return {"ip_port": number} | {name: value for name, value in raw.items() if name != "port"}


def unused_laser_parameters(
    raw: RawParameters, profile: Profile = Profile.STANDARD, below: str = ""
) -> list[str]:
    """Return a sentence for each parameter in `raw`, which lies `below` a name, without effect."""
    return unused(raw, rows_of(LaserParameters), profile, below=below, foreign=FOREIGN)


def overridden_laser_parameters(
    raw: RawParameters, given: Sequence[str], profile: Profile = Profile.STANDARD, below: str = ""
) -> list[str]:
    """Return a sentence for each parameter in `raw` that is known and does not apply.

    Ports of lasers are `given` on the command line. Parameters with their defaults, as `ros2 param
    dump` writes them, are fine.

    Raises:
        ConfigError: as :func:`read_laser_parameters` does.
    """
    ports = read_laser_parameters(raw, profile, below).ports
    acts = Effect.ON_PORT if given else Effect.ON_SCANS
    if given:
        applies, reason = bool(set(ports) & set(given)), " and ".join(given)
        reason = f"--laser or PIONEER3_LASER gives {reason}"
    else:
        applies, place = bool(ports), full_name("serial_port", profile, below)
        reason = f"no laser is given; give it with --laser or {place}"
    names = {
        name
        for row in rows_of(LaserParameters)
        for name in row.names(profile)
        if row.acts is acts and name in raw and raw[name] != row.default and not applies
    }
    return [
        f"parameter {full_name(name, profile, below)} is ignored: {reason}"
        for name in sorted(names)
    ]
