"""The contents of a fleet file: robots, their computers, the operator's, groups; frozen."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Final

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.fleet.network import LABEL, FleetNetwork, Name, network_of
from pioneer3.links.urls import split_host, split_url
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.tables import FieldForm, nearest

ALL: Final = "all"
"""The name of the group of all robots."""
USER: Final = "pioneer"
DEVICE: Final = "/dev/ttyUSB0"

Host = Annotated[
    str,
    Meta(
        pattern=rf"\A{LABEL}(\.{LABEL})*\Z",
        max_length=253,
        extra={"expected": "a host name such as p3at-1 or p3at-1.local"},
    ),
]
User = Annotated[
    str,
    Meta(
        pattern=r"\A[A-Za-z_][A-Za-z0-9_.-]{0,31}\Z",
        extra={"expected": "the name of a user such as pioneer"},
    ),
]
Bridge = Annotated[
    int, Meta(ge=0, le=65535, extra={"expected": "a TCP port such as 8101, or 0 for no bridge"})
]
Ros = Annotated[str, Meta(pattern=r"\A[12]?\Z", extra={"expected": '"1" or "2", or "" for none'})]
Node = Annotated[
    str,
    Meta(
        pattern=r"\A/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*\Z",
        extra={"expected": "the name of a ROS node such as RosAria_p3at_1 or p3at_1/pioneer3"},
    ),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetRobot:
    """A robot and its on-board computer.

    Attributes:
        name: Of the robot, a host name without a domain.
        address: IP address of its computer.
        host: Name of its computer in the network.
        port: The robot's port: a device of its computer, or an address that others reach.
        bridge: TCP port at which its computer lets others reach the device; 0 for none.
        user: The account on its computer.
        model: Name of a robot model, or the path of its file; empty for what the robot says.
        laser: Its laser, as `--laser` takes it; empty for none.
        camera: Its camera, as `--camera` takes it; empty for none. One at `127.0.0.1` or
            `localhost` is on its computer: from elsewhere it is looked for at `address`.
        ros: Version of ROS on its computer, `1` or `2`; empty for none.
        network: Name of its network of ROS 2; empty for the first `[[network]]`.
        node: Name of the ROS node that drives it, in ROS 2 with its namespace.
        navigation: Settings of its navigation, such as `navigation.planner.margin = 0.05`, in SI.
        note: For people.
        line: In the file; 0 for a robot that is in none.
    """

    name: Name
    address: str
    host: Host = ""
    port: str = DEVICE
    bridge: Bridge = 0
    user: User = USER
    model: str = ""
    laser: str = ""
    camera: str = ""
    ros: Ros = ""
    network: str = ""
    node: Node = ""
    navigation: NavigationSettings = AS_SHIPPED
    note: str = ""
    line: Annotated[int, FieldForm()] = field(default=0, compare=False)

    @property
    def is_device(self) -> bool:
        """Whether the robot's port is a device of its computer; ConfigError if it is no port."""
        return split_url(self.port)[0] != "tcp"

    @property
    def endpoint(self) -> tuple[str, int] | None:
        """Host and TCP port at which others reach the robot; `None` for a device alone."""
        if self.is_device:
            return (self.address, self.bridge) if self.bridge else None
        return split_host(f"tcp:{split_url(self.port)[1]}")


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorComputer:
    """The computer from which the fleet is worked on.

    Attributes:
        name: Its host name; empty if it is not given.
        address: Its IP address; empty if it is not given.
        user: The account there; empty for that of the person at the terminal.
    """

    name: Name = ""
    address: str = ""
    user: User = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Defaults:
    """Fields of all robots that do not give their own."""

    user: User = USER
    port: str = DEVICE
    bridge: Bridge = 0
    model: str = ""
    laser: str = ""
    camera: str = ""
    ros: Ros = ""
    network: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fleet:
    """All that a fleet file says, in its order; each robot has the defaults already."""

    path: Path
    operator: OperatorComputer = OperatorComputer()
    defaults: Defaults = Defaults()
    networks: tuple[FleetNetwork, ...] = ()
    robots: tuple[FleetRobot, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def addresses(self) -> Mapping[str, str]:
        """The address of each computer, by its names in lower case."""
        known = {name.lower(): r.address for r in self.robots for name in (r.name, r.host)}
        if self.operator.name and self.operator.address:
            known[self.operator.name.lower()] = self.operator.address
        return MappingProxyType(known)

    def network(self, robot: FleetRobot) -> FleetNetwork:
        """Return the network of ROS 2 that a robot is on."""
        return network_of(self.networks, robot.network)

    def select(self, names: Iterable[str]) -> tuple[FleetRobot, ...]:
        """Return robots by their names, those of groups, or `all`; each once, in the file's order.

        Raises:
            ConfigError: There is no such robot or group.
        """
        groups = {ALL: tuple(robot.name for robot in self.robots), **self.groups}
        chosen = [groups[name] if name in groups else (self.robot(name).name,) for name in names]
        wanted = {name for group in chosen for name in group}
        return tuple(robot for robot in self.robots if robot.name in wanted)

    def robot(self, name: str) -> FleetRobot:
        """Return one robot by its name; ConfigError, with the nearest name, if there is none."""
        for robot in self.robots:
            if robot.name == name:
                return robot
        if name == ALL or name in self.groups:
            raise ConfigError(f"{self.path}: {name} is a group; one robot is needed here")
        known = (*(robot.name for robot in self.robots), *self.groups)
        if not known:
            raise ConfigError(f"{self.path}: it has no robot yet; add one as [[robot]]")
        raise ConfigError(f"{self.path}: no robot {name!r}, {nearest(name, known)}")


def usual(robot: FleetRobot, defaults: Defaults) -> Mapping[str, Any]:
    """Return the values of keys that a robot with this name, port and ROS need not give.

    A node of ROS has the device to itself, and a port of the network needs no bridge.
    """
    try:
        bridged = robot.is_device and not robot.ros
    except ConfigError:  # the port is checked later
        bridged = False
    return {
        **asdict(defaults),
        "host": robot.name,
        "bridge": defaults.bridge if bridged else 0,
        "node": usual_node(robot.name, robot.ros),
        "navigation": AS_SHIPPED,
    }


def usual_node(name: str, ros: str) -> str:
    """Return the usual name of a robot's ROS node.

    In ROS 1 that of the lab: `RosAria_p3at_1` of `p3at-1`; in ROS 2 `p3at_1/pioneer3`.
    """
    part = name.replace("-", "_")
    return f"{part}/pioneer3" if ros == "2" else f"RosAria_{part}"
