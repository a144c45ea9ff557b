"""A network of ROS 2 in a fleet file: its keys, and the checks of them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Final

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.tables import Source, nearest

OF_DDS: Final = ("interface", "peer", "dds_services")
OF_ZENOH: Final = ("connect", "zenoh_config", "ca", "certificate", "key", "credentials")
FILES: Final = ("zenoh_config", "ca", "certificate", "key", "credentials")
FOREIGN: Final = {"dds": OF_ZENOH, "zenoh": OF_DDS, "rclpy": (*OF_DDS, *OF_ZENOH)}
"""Keys that a backend does not know."""


LABEL: Final = r"[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?"
"""A host name without a domain (RFC 1123, 2.1)."""
Name = Annotated[
    str,
    Meta(
        pattern=rf"\A{LABEL}\Z",
        extra={"expected": "a host name: letters, digits and - between them, such as p3at-1"},
    ),
]
Backend = Annotated[
    str,
    Meta(
        pattern=r"\A(auto|rclpy|dds|zenoh)\Z",
        extra={"expected": '"dds", "zenoh", "rclpy" or "auto"'},
    ),
]
Distro = Annotated[
    str,
    Meta(
        pattern=r"\A(humble|jazzy|kilted|lyrical)?\Z",
        extra={"expected": '"humble", "jazzy", "kilted" or "lyrical"'},
    ),
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


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetNetwork:
    """A network of ROS 2, as this computer joins it.

    Secrets are in files of their own: none of them is a value of these keys.

    Attributes:
        name: That robots give as their `network`.
        backend: `dds`, `zenoh`, `rclpy`, or `auto` for the one that has most of ROS 2 here.
        distro: Distribution of the others: `humble`, `jazzy`, `kilted` or `lyrical`; empty for
            that of `ROS_DISTRO`.
        domain: Number of the domain; without it that of `ROS_DOMAIN_ID`, else 0.
        interface: Network interfaces for DDS, such as `wlan0`; without any, and without peers,
            nothing leaves this computer.
        peer: Addresses of computers for DDS, where multicast does not get through.
        dds_services: Whether the others run rmw_cyclonedds_cpp: services work over DDS.
        connect: Zenoh routers, such as `tls/fleet.example.org:7447`.
        zenoh_config: File with further settings of Zenoh.
        ca: File with the certificates to trust for TLS.
        certificate: File with the certificate of this computer.
        key: File with its private key, readable by its owner only.
        credentials: File with a line `user:password` for Zenoh, readable by its owner only.
    """

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

    def file(self, key: str, folder: Path) -> Path | None:
        """Return the path of a file, which is relative to `folder`; `None` if it is not given."""
        path = str(getattr(self, key))
        return folder / Path(path).expanduser() if path else None


def check_networks(source: Source, networks: Sequence[FleetNetwork]) -> None:
    """Raise ConfigError for two networks of one name, or keys that do not go together."""
    for index, network in enumerate(networks):
        place = f"network[{index}]"
        names = [other.name for other in networks[:index]]
        if network.name in names:
            problem = f"{network.name} is network[{names.index(network.name)}]'s already"
            raise source.wrong(f"{place}.name", problem)
        for key, problem in _problems(network):
            raise source.wrong(f"{place}.{key}", problem)


def network_of(networks: Iterable[FleetNetwork], name: str) -> FleetNetwork:
    """Return the network of this name; the first one if the name is empty.

    A file without any means the network of this computer's own variables. Raises ConfigError if
    there is no such network.
    """
    known = list(networks)
    found = (
        [each for each in known if each.name == name] if name else [*known, FleetNetwork(name="")]
    )
    if not found:
        raise ConfigError(f"no network {name!r}, {nearest(name, tuple(n.name for n in known))}")
    return found[0]


def _problems(network: FleetNetwork) -> Iterator[tuple[str, str]]:
    """Yield keys with their problems."""
    given = {
        each.name
        for each in fields(FleetNetwork)
        if getattr(network, each.name) not in {None, *EMPTY}
    }
    for key in FOREIGN.get(network.backend, ()):
        if key in given:
            yield key, f"the backend {network.backend} has no use for it; leave it out"
    for one, other in (("certificate", "key"), ("key", "certificate")):
        if one in given and other not in given:
            yield one, "a certificate and its key belong together: give both, or none"
    for index, place in enumerate(network.connect):
        if "#" in place:  # Zenoh takes keys and passwords there
            yield f"connect[{index}]", "settings of an endpoint belong in files, not after a #"


EMPTY: Final[tuple[object, ...]] = ("", False, ())
"""Values of keys that are not given."""
