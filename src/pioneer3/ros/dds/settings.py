"""Settings of Cyclone DDS, as ROS 2's peers need them.

Domains are one for each process in the C library, with the settings of their first user.
"""

import logging
import os
import threading
from dataclasses import dataclass
from typing import Any, Final
from xml.sax.saxutils import quoteattr

from pioneer3.errors import ConfigError

COMPATIBILITY: Final = (
    "<Compatibility><AllowInvalidTryConstruct>true</AllowInvalidTryConstruct>"
    "<IgnoreTypeInformation>1.15,1.16</IgnoreTypeInformation></Compatibility>"
)
"""Fast DDS 3, in Kilted and Lyrical, describes types in a way that Cyclone DDS refuses: without
this every type with an array would silently get no samples."""
KEYS: Final = "<GenerateKeyhash>true</GenerateKeyhash>"
"""Fast DDS reads from the hash of the key alone which publisher, subscriber or participant is gone:
without it those that leave would stay in its graph, participants for 10 s more."""
LARGEST: Final = 16 * 2**20
"""Longest message that is sent or taken, such as a map of 4096 x 4096 cells [B]: Cyclone DDS drops
longer ones at their first fragment, with a line of log, and would otherwise keep several of any
length in memory."""
LOOPBACK: Final = "127.0.0.1"
SETTINGS: Final = "CYCLONEDDS_URI"
FIRST_PORT: Final = 7400
PORTS: Final = 250
"""Ports of each domain (DDSI-RTPS 9.6.2.1)."""
INDEXES: Final = 99
"""Highest index of a participant on a computer where multicast finds nobody."""
ANNOUNCED: Final = (
    "<SPDPInterval>2s</SPDPInterval><InitialLocatorPruneDelay>inf</InitialLocatorPruneDelay>"
)
"""Without multicast, Cyclone DDS would announce itself to the addresses of its peers for 30 s only:
whoever starts later would never find it."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class DdsOptions:
    """The options of DDS; without `interfaces` and `peers` nothing leaves this computer.

    `interfaces` are names or addresses, `peers` addresses of computers where multicast does not get
    through; `services` says that they run rmw_cyclonedds_cpp, the only one that can call services.
    """

    domain: int = 0
    interfaces: tuple[str, ...] = ()
    peers: tuple[str, ...] = ()
    services: bool = False

    @property
    def stays_here(self) -> bool:
        """Whether nothing leaves this computer."""
        return not self.interfaces and not self.peers

    @property
    def reach(self) -> str:
        """The end of a sentence on where messages go; empty for the interfaces asked for."""
        if has_settings():
            return f", as {SETTINGS} says"
        return ", this computer only" if self.stays_here else ""

    @property
    def ports(self) -> range:
        """The UDP ports of the domain."""
        first = FIRST_PORT + PORTS * self.domain
        return range(first, first + PORTS)

    @property
    def xml(self) -> str:
        """The settings of Cyclone DDS; those in `CYCLONEDDS_URI` come after them, and so first."""
        general = ""
        interfaces = (LOOPBACK,) if self.stays_here else self.interfaces
        if interfaces:
            several = "".join(f"<NetworkInterface {_which(each)}/>" for each in interfaces)
            general = f"<Interfaces>{several}</Interfaces>"
        if self.stays_here:
            general += "<AllowMulticast>false</AllowMulticast>"
        peers = "".join(f"<Peer address={quoteattr(each)}/>" for each in (LOOPBACK, *self.peers))
        own = (
            f"<Domain><General>{general}</General><Discovery>"
            f"<ParticipantIndex>auto</ParticipantIndex>"
            f"<MaxAutoParticipantIndex>{INDEXES}</MaxAutoParticipantIndex>"
            f"<Peers>{peers}</Peers>{ANNOUNCED}</Discovery>"
            f"<Internal>{KEYS}<MaxSampleSize>{LARGEST} B</MaxSampleSize></Internal>"
            f"{COMPATIBILITY}</Domain>"
        )
        return ",".join(filter(None, (own, os.environ.get(SETTINGS, ""))))


def has_settings() -> bool:
    """Return whether somebody has settings of their own, which come before these."""
    return bool(os.environ.get(SETTINGS, "").strip())


def _names_interfaces() -> bool:
    """Return whether such settings may name interfaces: in a file they may have anything."""
    several = os.environ.get(SETTINGS, "").strip()
    named = "networkinterface" in several.lower()
    return named or "file:" in several or several[:1] not in {"", "<"}


def _which(interface: str) -> str:
    """Return the attribute that names a network interface."""
    kind = "address" if interface.replace(".", "").isdigit() or ":" in interface else "name"
    return f"{kind}={quoteattr(interface)}"


def _keep_out(options: DdsOptions) -> None:
    """Let nothing in by interfaces that nobody asked for; warn where that cannot be done.

    Settings of `CYCLONEDDS_URI` that name interfaces are somebody's own choice.
    """
    if has_settings():
        log.warning(
            "%s is set, and its settings come before those of this program: they decide by which"
            " network interfaces the robot can be driven",
            SETTINGS,
        )
    asked = options.stays_here or options.interfaces
    if not asked or _names_interfaces():
        return
    try:
        from pioneer3.ros.dds.sockets import restrict

        restrict(options.ports, options.interfaces)
    except OSError as error:
        log.warning(
            "DDS sends by the chosen interfaces only, but takes what comes in by any (%s):"
            " a firewall must close its UDP ports from %d on",
            error,
            options.ports.start,
        )


class Domains:
    """The domains that this process has joined, each as long as somebody uses it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: dict[int, tuple[Any, int, str]] = {}

    def join(self, options: DdsOptions) -> None:
        """Join a domain; :meth:`leave` must follow.

        Raises:
            ConfigError: the settings are wrong, or others hold for this domain in this process.
        """
        from cyclonedds.core import DDSException
        from cyclonedds.domain import Domain

        with self._lock:
            domain, users, xml = self._known.get(options.domain, (None, 0, options.xml))
            if xml != options.xml:
                raise ConfigError(
                    f"this program is in DDS domain {options.domain} with other options already"
                )
            is_new = domain is None
            if domain is None:
                try:
                    domain = Domain(options.domain, options.xml)
                except DDSException as error:
                    raise ConfigError(
                        f"DDS cannot join domain {options.domain}: {error}; check --interface and"
                        " CYCLONEDDS_URI"
                    ) from error
            self._known[options.domain] = domain, users + 1, xml
        if is_new:
            _keep_out(options)

    def leave(self, options: DdsOptions) -> None:
        """Leave a domain; the last user ends its threads."""
        with self._lock:
            domain, users, xml = self._known[options.domain]
            if users > 1:
                self._known[options.domain] = domain, users - 1, xml
            else:
                del self._known[options.domain]


DOMAINS: Final = Domains()
"""Those of this process: the library keeps them for the whole process, too."""
