"""The systemd unit that drives a robot from when its computer is switched on. Pure."""

from dataclasses import dataclass
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.fleet.network import FILES
from pioneer3.fleet.ros_graph import master_of
from pioneer3.fleet.spec import Fleet, FleetRobot

STOPPING: Final = 10
"""Time that the program has to stop the robot before it is killed [s]; the robot's own watchdog
stops it 2 s after that."""
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
)
"""These need an administrator's service manager."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SystemdUnit:
    """The unit of one robot, with the path of the Python that has the package.

    It belongs to the system `with_root`, else to the user.
    """

    robot: FleetRobot
    fleet: Fleet
    python: str
    with_root: bool

    @staticmethod
    def check(robot: FleetRobot, fleet: Fleet) -> None:
        """Refuse a robot that no unit can drive.

        Raises:
            ConfigError: Its network of ROS 2 has files, of which the robot needs its own.
        """
        network = fleet.network(robot)
        if robot.ros == "2" and any(getattr(network, key) for key in FILES):
            raise ConfigError(
                f"the network {network.name} has certificates or passwords in files, and"
                f" {robot.name} needs its own: start pioneer3 ros2 there with them; see"
                " how-to/ros2-fleet.md, A robot. --no-service installs the package alone"
            )

    def text(self) -> str:
        """Return the text of the file."""
        wants = ["Wants=network-online.target", "After=network-online.target"]
        who = [f"User={self.robot.user}", "SupplementaryGroups=dialout"]
        does = "bridges" if self.robot.bridge else "drives"
        lines = [
            "# Written by: pioneer3 fleet deploy",
            "[Unit]",
            f"Description=pioneer3 {does} the robot {self.robot.name}",
            *(wants if self.with_root else []),
            "StartLimitIntervalSec=0",
            "",
            "[Service]",
            "Type=exec",
            f"ExecStart={self.command()}",
            *self._environment(),
            *(who if self.with_root else []),
            "Restart=always",
            "RestartSec=2",
            "KillSignal=SIGTERM",
            f"TimeoutStopSec={STOPPING}",
            *_HARDENING,
            *(_HARDENING_WITH_ROOT if self.with_root else []),
            "",
            "[Install]",
            f"WantedBy={'multi-user.target' if self.with_root else 'default.target'}",
        ]
        return "\n".join(lines) + "\n"

    def command(self) -> str:
        """Return the command line that drives the robot, or lets others reach it."""
        robot = self.robot
        if robot.bridge:
            words = [self.python, "-m", "pioneer3", "bridge", "--port", robot.port]
            words += ["--bind", robot.address, "--listen", str(robot.bridge)]
            return " ".join(map(quoted, words))
        program = {"1": "ros1", "2": "ros2"}.get(robot.ros, "run")
        words = [self.python, "-m", "pioneer3", program]
        words += ["--port", robot.port]
        words += ["--laser", robot.laser] if robot.laser else []
        words += ["--camera", robot.camera] if robot.camera else []
        words += [f"__name:={robot.node}"] if robot.ros == "1" else []
        words += self._on_ros2() if robot.ros == "2" else []
        return " ".join(map(quoted, words))

    def _on_ros2(self) -> list[str]:
        """Return the options of the robot's node on ROS 2: it is at its own address."""
        network = self.fleet.network(self.robot)
        space, _, name = self.robot.node.strip("/").rpartition("/")
        words = ["--namespace", space, "--name", name] if space else ["--name", name]
        words += ["--backend", network.backend]
        words += ["--distro", network.distro] if network.distro else []
        words += [] if network.domain is None else ["--domain", str(network.domain)]
        for place in network.connect:
            words += ["--connect", place]
        if not network.connect and network.backend != "rclpy":
            words += ["--interface", self.robot.address]
        return [*words, *(["--dds-services"] if network.dds_services else [])]

    def _environment(self) -> list[str]:
        found = ["PYTHONUNBUFFERED=1"]
        if self.robot.ros == "1":
            found.append(f"ROS_MASTER_URI={master_of(self.fleet)}")
            found.append(f"ROS_IP={self.robot.address}")
        elif self.robot.ros == "2" and self.fleet.network(self.robot).backend == "rclpy":
            found.append("ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET")
        return [f"Environment={quoted(each)}" for each in found]


def quoted(word: str) -> str:
    """Return a word for a command line of systemd (systemd.service(5), COMMAND LINES)."""
    escaped = word.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return escaped if escaped and not set(escaped) & set(" \t'\";") else f'"{escaped}"'
