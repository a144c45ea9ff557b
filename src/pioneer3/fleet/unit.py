"""The systemd unit that runs pioneer3 from when a robot's computer is switched on. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.fleet.network import FILES
from pioneer3.fleet.ros_graph import master_of
from pioneer3.fleet.spec import Fleet, FleetRobot

SERVICE: Final = "pioneer3"
WITH_ROOT: Final = f"/etc/systemd/system/{SERVICE}.service"
"""The unit of a service that an administrator has installed; else it is the user's own."""
USER_UNIT: Final = f".config/systemd/user/{SERVICE}.service"
"""The unit of a user, below the home."""
WRITTEN_BY: Final = "# Written by: "
"""A unit begins with this, and the command that wrote it."""
STOPPING: Final = 10
"""Time that the program has to stop the robot before it is killed [s]; the robot's own watchdog
stops it 2 s after that."""
WATCHED: Final = 6
"""So long a new version must run before it counts as started [s], and four times the time that the
computer takes to load it."""
_HARDENING: Final = (
    "NoNewPrivileges=yes",
    "LockPersonality=yes",
    "RestrictRealtime=yes",
    "RestrictSUIDSGID=yes",
    "SystemCallArchitectures=native",
    "RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK",
    "UMask=0027",
)
_HARDENING_WITH_ROOT: Final = (
    "PrivateTmp=yes",
    "ProtectSystem=full",
    "ProtectKernelTunables=yes",
    "ProtectKernelModules=yes",
    "ProtectControlGroups=yes",
    "ProtectClock=yes",
    "CapabilityBoundingSet=",
    "DevicePolicy=closed",
    "DeviceAllow=char-ttyUSB rw",
    "DeviceAllow=char-ttyACM rw",
    "DeviceAllow=char-ttyS rw",
    "DeviceAllow=char-ttyAMA rw",
)
"""These need an administrator's service manager."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SystemdUnit:
    """The unit of one robot.

    Attributes:
        command: The words that it runs.
        about: Its purpose, for people.
        written_by: The command that writes it.
        environment: Variables, as `NAME=value`.
        user: The user that the program runs as, in a unit of the system; empty for a unit of the
            user's own.
        folder: The program begins there; empty for the home of the user.
        pauses: When the program is started again; newer versions of systemd know longer pauses.
    """

    command: Sequence[str]
    about: str
    written_by: str
    environment: Sequence[str] = ()
    user: str = ""
    folder: str = ""
    pauses: Sequence[str] = ("RestartSec=2",)

    @property
    def with_root(self) -> bool:
        """Whether it belongs to the system."""
        return bool(self.user)

    def text(self) -> str:
        """Return the text of the file."""
        wants = ["Wants=network-online.target", "After=network-online.target"]
        who = [f"User={self.user}", "SupplementaryGroups=dialout"]
        lines = [
            f"{WRITTEN_BY}{self.written_by}",
            "[Unit]",
            f"Description={self.about}",
            *(wants if self.with_root else []),
            "StartLimitIntervalSec=0",
            "",
            "[Service]",
            "Type=exec",
            f"ExecStart={' '.join(map(quoted, self.command))}",
            *(f"Environment={quoted(each)}" for each in self.environment),
            *([f"WorkingDirectory={self.folder.replace('%', '%%')}"] if self.folder else []),
            *(who if self.with_root else []),
            "Restart=always",
            *self.pauses,
            "KillSignal=SIGTERM",
            f"TimeoutStopSec={STOPPING}",
            *_HARDENING,
            *(_HARDENING_WITH_ROOT if self.with_root else []),
            "",
            "[Install]",
            f"WantedBy={'multi-user.target' if self.with_root else 'default.target'}",
        ]
        return "\n".join(lines) + "\n"


def unit_of(robot: FleetRobot, fleet: Fleet, python: str, *, with_root: bool) -> SystemdUnit:
    """Return the unit of a robot of a fleet, with the path of the Python that has the package.

    It belongs to the system `with_root`, else to the user.
    """
    return SystemdUnit(
        command=[python, "-m", "pioneer3", *_words(robot, fleet)],
        about=f"pioneer3 {'bridges' if robot.bridge else 'drives'} the robot {robot.name}",
        written_by="pioneer3 fleet deploy",
        environment=_environment(robot, fleet),
        user=robot.user if with_root else "",
    )


def check_unit(robot: FleetRobot, fleet: Fleet) -> None:
    """Raise ConfigError for a robot without a unit: its network needs files of the robot's own."""
    network = fleet.network(robot)
    if robot.ros == "2" and any(getattr(network, key) for key in FILES):
        raise ConfigError(
            f"the network {network.name} has certificates or passwords in files, and"
            f" {robot.name} needs its own: start pioneer3 ros2 there with them; see"
            " how-to/ros2-fleet.md, A robot. --no-service installs the package alone"
        )


def _words(robot: FleetRobot, fleet: Fleet) -> list[str]:
    """Return the command that drives the robot, or lets others reach it."""
    if robot.bridge:
        words = ["bridge", "--port", robot.port]
        return [*words, "--bind", robot.address, "--listen", str(robot.bridge)]
    words = [{"1": "ros1", "2": "ros2"}.get(robot.ros, "run"), "--port", robot.port]
    words += ["--laser", robot.laser] if robot.laser else []
    words += ["--camera", robot.camera] if robot.camera else []
    words += [f"__name:={robot.node}"] if robot.ros == "1" else []
    return [*words, *(_on_ros2(robot, fleet) if robot.ros == "2" else [])]


def _on_ros2(robot: FleetRobot, fleet: Fleet) -> list[str]:
    """Return the options of the robot's node on ROS 2: it is at its own address."""
    network = fleet.network(robot)
    space, _, name = robot.node.strip("/").rpartition("/")
    words = ["--namespace", space, "--name", name] if space else ["--name", name]
    words += ["--backend", network.backend]
    words += ["--distro", network.distro] if network.distro else []
    words += [] if network.domain is None else ["--domain", str(network.domain)]
    for place in network.connect:
        words += ["--connect", place]
    if not network.connect and network.backend != "rclpy":
        words += ["--interface", robot.address]
    return [*words, *(["--dds-services"] if network.dds_services else [])]


def _environment(robot: FleetRobot, fleet: Fleet) -> list[str]:
    found = ["PYTHONUNBUFFERED=1"]
    if robot.ros == "1":
        found.append(f"ROS_MASTER_URI={master_of(fleet)}")
        found.append(f"ROS_IP={robot.address}")
    elif robot.ros == "2" and fleet.network(robot).backend == "rclpy":
        found.append("ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET")
    return found


def quoted(word: str) -> str:
    """Return a word for a command line of systemd (systemd.service(5), COMMAND LINES)."""
    escaped = word.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    escaped = escaped.replace("\n", "\\n")
    return escaped if escaped and not set(escaped) & set(" \t'\";") else f'"{escaped}"'
