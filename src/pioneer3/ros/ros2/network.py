"""The choice of a backend, and its options, from the command line and ROS 2's own variables."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.backend import Backend, NodeName
from pioneer3.ros.ros2.distros import DEFAULT, Distro, distro_of, distros

if TYPE_CHECKING:
    from pioneer3.ros.ros2.types import MessageTypes
    from pioneer3.ros.zenoh.settings import ZenohOptions

HIGHEST_DOMAIN: Final = 232


class BackendName(StrEnum):
    """The backends; `auto` takes the one that has most of ROS 2 on this computer."""

    AUTO = "auto"
    RCLPY = "rclpy"
    DDS = "dds"
    ZENOH = "zenoh"


KEEPERS: Final = {
    **dict.fromkeys(("interface", "peer", "dds_services"), BackendName.DDS),
    **dict.fromkeys(("connect", "listen", "zenoh_config", "ca"), BackendName.ZENOH),
    **dict.fromkeys(("certificate", "key", "credentials"), BackendName.ZENOH),
}
"""The backend that keeps an option of a network."""
OF_RCLPY: Final = {
    "interface": "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET lets all computers around reach it",
    "peer": "ROS_STATIC_PEERS names the computers that reach it, such as 10.0.0.1;10.0.0.2",
    "dds_services": "services work there without it",
}
"""Remedies where rclpy has something else."""
OF_ITS_ZENOH: Final = "ZENOH_SESSION_CONFIG_URI names the settings of rmw_zenoh_cpp"


@dataclass(frozen=True, slots=True, kw_only=True)
class Network:
    """Where a node is: its backend, and the options of `DdsOptions` and `ZenohOptions`.

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
    """

    backend: BackendName = BackendName.AUTO
    distro: str | None = None
    domain: int | None = None
    interface: tuple[str, ...] = ()
    peer: tuple[str, ...] = ()
    dds_services: bool = False
    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    zenoh_config: Path | None = None
    ca: Path | None = None
    certificate: Path | None = None
    key: Path | None = None
    credentials: Path | None = None

    def distro_here(self) -> Distro:
        """Return the distribution; ConfigError if there is none of that name."""
        if self.distro is not None:
            return distro_of(self.distro)
        installed = os.environ.get("ROS_DISTRO", "")
        return distros().get(installed) or distro_of(DEFAULT)

    def domain_here(self) -> int:
        """Return the domain's number, or that of `ROS_DOMAIN_ID`; ConfigError if it is none."""
        text = os.environ.get("ROS_DOMAIN_ID", "") or "0"
        try:
            number = int(text) if self.domain is None else self.domain
        except ValueError:
            raise ConfigError(f"ROS_DOMAIN_ID must be a number, not {text!r}") from None
        if not 0 <= number <= HIGHEST_DOMAIN:
            raise ConfigError(f"domains have numbers from 0 to {HIGHEST_DOMAIN}, not {number}")
        return number

    def zenoh_options(self, domain: int) -> "ZenohOptions":
        """Return the options of Zenoh."""
        from pioneer3.ros.zenoh.settings import ZenohOptions

        default = ZenohOptions()
        return ZenohOptions(
            domain=domain,
            connect=self.connect or default.connect,
            listen=self.listen or default.listen,
            config=self.zenoh_config,
            ca=self.ca,
            certificate=self.certificate,
            key=self.key,
            credentials=self.credentials,
        )

    def router_options(self) -> "ZenohOptions":
        """Return the options of a Zenoh router."""
        from pioneer3.ros.zenoh.settings import DEFAULT as ROUTER

        return replace(
            self.zenoh_options(ROUTER.domain),
            mode=ROUTER.mode,
            connect=self.connect,
            listen=self.listen or ROUTER.listen,
        )

    def check(self, chosen: BackendName) -> None:
        """Raise ConfigError, with a remedy, for an option that the chosen backend does not keep."""
        for field, backend in KEEPERS.items():
            if backend is not chosen and getattr(self, field):
                remedy = f"take --backend {backend}"
                if chosen is BackendName.RCLPY:
                    remedy = f"{OF_RCLPY.get(field, OF_ITS_ZENOH)}; or {remedy}"
                word = field.replace("_", "-")
                raise ConfigError(f"{chosen} has no --{word}: {remedy}")

    def obstacle(self) -> str:
        """Return the reason why the ROS 2 installed here does not serve; empty for none."""
        if self.backend is not BackendName.AUTO or find_spec("rclpy") is None:
            return ""
        from pioneer3.ros.rclpy.backend import obstacle

        return obstacle(self.distro_here().name)

    def chosen(self, environment: Mapping[str, str] = os.environ) -> BackendName:
        """Return the backend to take; ConfigError if none is installed."""
        if self.backend is not BackendName.AUTO:
            return self.backend
        if find_spec("rclpy") is not None and not self.obstacle():
            return BackendName.RCLPY
        given = {keeper for field, keeper in KEEPERS.items() if getattr(self, field)}
        of_ros = environment.get("RMW_IMPLEMENTATION")
        asks_zenoh = BackendName.ZENOH in given or of_ros == "rmw_zenoh_cpp"
        order = [("cyclonedds", BackendName.DDS), ("zenoh", BackendName.ZENOH)]
        for library, backend in reversed(order) if asks_zenoh else order:
            if find_spec(library) is not None:
                return backend
        advice = how_to_get("zenoh")
        raise ConfigError(f"neither ROS 2 nor a library that speaks it is here: {advice}")


def open_backend(network: Network, node: NodeName, types: "MessageTypes") -> Backend:
    """Join the network as `node`; ConfigError for an option, or without the library."""
    domain, chosen = network.domain_here(), network.chosen()
    network.check(chosen)
    match chosen:
        case BackendName.RCLPY:
            from pioneer3.ros.rclpy.backend import RclpyBackend

            return RclpyBackend(node, types, domain)
        case BackendName.ZENOH:
            from pioneer3.ros.zenoh.backend import ZenohBackend

            return ZenohBackend(node, types, network.zenoh_options(domain))
        case _:
            from pioneer3.ros.dds.backend import DdsBackend
            from pioneer3.ros.dds.settings import DdsOptions

            options = DdsOptions(
                domain=domain,
                interfaces=network.interface,
                peers=network.peer,
                services=network.dds_services,
            )
            return DdsBackend(node, types, options)
