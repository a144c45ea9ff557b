"""The tables of a fleet file, as msgspec reads and checks them."""

from typing import Annotated, Literal, Self

from msgspec import Meta, Struct, convert, field
from msgspec.structs import asdict

from pioneer3.errors import ConfigError
from pioneer3.fleet.network import Network
from pioneer3.fleet.spec import Defaults, Fleet, Operator, Robot, is_device, usual_node

LABEL = r"[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?"
"""A host name without a domain (RFC 1123, 2.1)."""

Name = Annotated[
    str,
    Meta(
        pattern=rf"\A{LABEL}\Z",
        extra={"expected": "a host name: letters, digits and - between them, such as p3at-1"},
    ),
]
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
    int,
    Meta(ge=0, le=65535, extra={"expected": "a TCP port such as 8101, or 0 for no bridge"}),
]
Ros = Annotated[Literal["", "1", "2"], Meta(extra={"expected": '"1" or "2", or "" for none'})]
Backend = Annotated[
    Literal["auto", "rclpy", "dds", "zenoh"],
    Meta(extra={"expected": '"dds", "zenoh", "rclpy" or "auto"'}),
]
Distro = Annotated[
    Literal["", "humble", "jazzy", "kilted", "lyrical"],
    Meta(extra={"expected": '"humble", "jazzy", "kilted" or "lyrical"'}),
]
Domain = Annotated[
    int, Meta(ge=0, le=232, extra={"expected": "the number of a domain, from 0 to 232"})
]
Endpoint = Annotated[
    str,
    Meta(
        pattern=r"\A[a-z]+/\S+:[0-9]+\S*\Z",
        extra={"expected": "a Zenoh router such as tls/fleet.example.org:7447"},
    ),
]
Node = Annotated[
    str,
    Meta(
        pattern=r"\A/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*\Z",
        extra={"expected": "the name of a ROS node such as RosAria_p3at_1 or p3at_1/pioneer3"},
    ),
]


class Table(Struct, forbid_unknown_fields=True, omit_defaults=True):
    """Any table: unknown keys are refused, defaults are not written."""


class OperatorTable(Table):
    """`[operator]`."""

    name: Name | None = None
    address: str | None = None
    user: User | None = None

    def operator(self) -> Operator:
        """Return the operator's computer."""
        return Operator(name=self.name or "", address=self.address or "", user=self.user or "")

    @classmethod
    def of(cls, operator: Operator) -> Self:
        """Return the table of the operator's computer."""
        return cls(
            name=operator.name or None, address=operator.address or None, user=operator.user or None
        )


class DefaultsTable(Table):
    """`[defaults]`."""

    user: User = Defaults().user
    port: str = Defaults().port
    bridge: Bridge = Defaults().bridge
    model: str = Defaults().model
    laser: str = Defaults().laser
    camera: str = Defaults().camera
    ros: Ros = ""
    network: str = ""

    def defaults(self) -> Defaults:
        """Return the defaults."""
        return Defaults(
            user=self.user,
            port=self.port,
            bridge=self.bridge,
            model=self.model,
            laser=self.laser,
            camera=self.camera,
            ros=self.ros,
            network=self.network,
        )

    @classmethod
    def of(cls, defaults: Defaults) -> Self:
        """Return the table of the defaults."""
        return cls(
            user=defaults.user,
            port=defaults.port,
            bridge=defaults.bridge,
            model=defaults.model,
            laser=defaults.laser,
            camera=defaults.camera,
            ros=_ros(defaults.ros),
            network=defaults.network,
        )


class NetworkTable(Table):
    """`[[network]]`."""

    name: Name
    backend: Backend = "auto"
    distro: Distro = ""
    domain: Domain | None = None
    interface: tuple[str, ...] = ()
    peer: tuple[str, ...] = ()
    dds_services: bool = False
    connect: tuple[Endpoint, ...] = ()
    zenoh_config: str = ""
    ca: str = ""
    certificate: str = ""
    key: str = ""
    credentials: str = ""

    def network(self) -> Network:
        """Return the network."""
        return Network(**asdict(self))

    @classmethod
    def of(cls, network: Network) -> Self:
        """Return the table of a network."""
        return convert(network, cls, from_attributes=True)


class RobotTable(Table):
    """`[[robot]]`."""

    name: Name
    address: str
    host: Host | None = None
    port: str | None = None
    bridge: Bridge | None = None
    user: User | None = None
    model: str | None = None
    laser: str | None = None
    camera: str | None = None
    ros: Ros | None = None
    network: str | None = None
    node: Node | None = None
    note: str = ""

    def robot(self, defaults: Defaults, line: int) -> Robot:
        """Return the robot with the defaults for keys that the table does not give."""
        port = defaults.port if self.port is None else self.port
        ros = defaults.ros if self.ros is None else self.ros
        usual = usual_bridge(defaults, port, ros)
        return Robot(
            name=self.name,
            host=self.name if self.host is None else self.host,
            address=self.address,
            port=port,
            bridge=usual if self.bridge is None else self.bridge,
            user=defaults.user if self.user is None else self.user,
            model=defaults.model if self.model is None else self.model,
            laser=defaults.laser if self.laser is None else self.laser,
            camera=defaults.camera if self.camera is None else self.camera,
            ros=ros,
            network=defaults.network if self.network is None else self.network,
            node=usual_node(self.name, ros) if self.node is None else self.node,
            note=self.note,
            line=line,
        )

    @classmethod
    def of(cls, robot: Robot, defaults: Defaults) -> Self:
        """Return the table of a robot, without its defaults."""
        usual = usual_node(robot.name, robot.ros)
        bridge = usual_bridge(defaults, robot.port, robot.ros)
        return cls(
            name=robot.name,
            address=robot.address,
            host=None if robot.host == robot.name else robot.host,
            port=None if robot.port == defaults.port else robot.port,
            bridge=None if robot.bridge == bridge else robot.bridge,
            user=None if robot.user == defaults.user else robot.user,
            model=None if robot.model == defaults.model else robot.model,
            laser=None if robot.laser == defaults.laser else robot.laser,
            camera=None if robot.camera == defaults.camera else robot.camera,
            ros=None if robot.ros == defaults.ros else _ros(robot.ros),
            network=None if robot.network == defaults.network else robot.network,
            node=None if robot.node == usual else robot.node,
            note=robot.note,
        )


class FileTable(Table):
    """All tables of a fleet file; :mod:`pioneer3.fleet.checks` checks the groups."""

    operator: OperatorTable | None = None
    defaults: DefaultsTable | None = None
    network: tuple[NetworkTable, ...] = ()
    robot: tuple[RobotTable, ...] = ()
    groups: dict[str, object] = field(default_factory=dict)

    @classmethod
    def of(cls, fleet: Fleet) -> Self:
        """Return the tables of a fleet."""
        return cls(
            operator=None if fleet.operator == Operator() else OperatorTable.of(fleet.operator),
            defaults=None if fleet.defaults == Defaults() else DefaultsTable.of(fleet.defaults),
            network=tuple(map(NetworkTable.of, fleet.networks)),
            robot=tuple(RobotTable.of(robot, fleet.defaults) for robot in fleet.robots),
            groups={name: list(members) for name, members in fleet.groups.items()},
        )


def usual_bridge(defaults: Defaults, port: str, ros: str) -> int:
    """Return the bridge of a robot that gives none of its own.

    A node of ROS has the device to itself, and a port of the network needs no bridge.
    """
    return defaults.bridge if defaults.bridge and not ros and _may_be_device(port) else 0


def _may_be_device(port: str) -> bool:
    """Return whether a port, which is checked later, is a device."""
    try:
        return is_device(port)
    except ConfigError:
        return False


def _ros(version: str) -> Literal["", "1", "2"]:
    match version:
        case "" | "1" | "2":
            return version
    raise ValueError(f"no version of ROS: {version!r}")
