"""The options that the commands of ROS 2 have in common: their network, and ROS 2's own."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
from cyclopts import Parameter

from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.ros.ros2.network import Network
    from pioneer3.ros.ros2.start import NodeOptions

Several = Parameter(negative=())


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkOptions:
    """The network.

    Attributes:
        backend: auto, rclpy, dds or zenoh; auto takes ROS 2's own where it is installed.
        distro: Of the others: humble, jazzy, kilted or lyrical; without it that of ROS_DISTRO.
        domain: Number of the domain; without it that of ROS_DOMAIN_ID, else 0.
        interface: Network interface for DDS, such as wlan0; without one nothing leaves this
            computer.
        peer: Address of a computer for DDS, where multicast does not get through.
        dds_services: The others run rmw_cyclonedds_cpp: offer services over DDS.
        connect: Zenoh router, such as tcp/robot1:7447 or tls/fleet.example.org:7447.
        listen: Where Zenoh listens, such as tcp/0.0.0.0:7447.
        zenoh_config: File with further settings of Zenoh.
        ca: File with the certificates to trust for TLS.
        certificate: File with the certificate of this program.
        key: File with its private key, for its owner only.
        credentials: File with a line user:password for Zenoh, for its owner only.
        ros_args: ROS 2's own arguments, after all others: -r FROM:=TO, -p NAME:=VALUE,
            --params-file FILE.
    """

    backend: str = "auto"
    distro: str | None = None
    domain: int | None = None
    interface: Annotated[tuple[str, ...], Several] = ()
    peer: Annotated[tuple[str, ...], Several] = ()
    dds_services: Annotated[bool, Several] = False
    connect: Annotated[tuple[str, ...], Several] = ()
    listen: Annotated[tuple[str, ...], Several] = ()
    zenoh_config: Path | None = None
    ca: Path | None = None
    certificate: Path | None = None
    key: Path | None = None
    credentials: Path | None = None
    ros_args: str = ""

    def node(self, name: str, namespace: str = "/") -> "NodeOptions":
        """Return the options of a node on this network."""
        from pioneer3.ros.ros2.start import NodeOptions

        return NodeOptions(
            name=name,
            namespace=namespace,
            network=self.network,
            arguments=ros_words(self.ros_args),
        )

    @property
    def network(self) -> "Network":
        """The network that they mean.

        Raises:
            ConfigError: there is no such backend.
        """
        from pioneer3.ros.ros2.network import BackendName, Network

        try:
            backend = BackendName(self.backend)
        except ValueError:
            raise ConfigError(
                f"--backend is one of {', '.join(BackendName)}, not {self.backend!r}"
            ) from None
        return Network(
            backend=backend,
            distro=self.distro,
            domain=self.domain,
            interfaces=self.interface,
            dds_peers=self.peer,
            dds_services=self.dds_services,
            connect=self.connect,
            listen=self.listen,
            zenoh_config=self.zenoh_config,
            ca=self.ca,
            certificate=self.certificate,
            key=self.key,
            credentials=self.credentials,
        )


ANYWHERE = NetworkOptions()


def ros_words(text: str) -> tuple[str, ...]:
    """Return the words that `gather_ros_arguments` has put into one."""
    return tuple(msgspec.json.decode(text, type=list[str])) if text.startswith("[") else ()
