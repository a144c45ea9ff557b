"""Addresses of this computer and of others, and their form in URLs."""

import socket
from ipaddress import ip_address
from typing import Final

ANY: Final = {"0.0.0.0", "::", ""}
"""All addresses of this computer."""
SOMEWHERE: Final = "192.0.2.1"
"""An address that no computer has (RFC 5737)."""
ANY_PORT: Final = 9
"""Nothing is sent there."""


def bracketed(host: str) -> str:
    """Return `host` as it stands in a URL: an address of IPv6 in brackets."""
    return f"[{host}]" if ":" in host else host


def url_of(host: str, port: int) -> str:
    """Return the URL of a port that listens at `host`.

    A port at all addresses of this machine is reached at the one that other machines see.
    """
    return f"tcp://{bracketed(machine_address() if host in ANY else host)}:{port}"


def is_loopback(host: str) -> bool:
    """Whether a host name or an address means this computer to itself."""
    try:
        address = ip_address(host)
    except ValueError:
        return host.lower() == "localhost"
    return bool((getattr(address, "ipv4_mapped", None) or address).is_loopback)


def is_address(host: str) -> bool:
    """Whether a host is given by an IP address, and not by its name."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


def is_own(address: str) -> bool:
    """Whether this computer has an IP address."""
    family = socket.AF_INET6 if ip_address(address).version == 6 else socket.AF_INET
    with socket.socket(family, socket.SOCK_DGRAM) as tried:
        try:
            tried.bind((address, 0))
        except OSError:
            return False
    return True


def address_towards(host: str) -> str:
    """Return this computer's address on the way to another one; nothing is sent.

    Raises:
        OSError: No network leads there, or it is no address.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_DGRAM) as probe:
        probe.connect((host, ANY_PORT))  # only asks which way packets would take
        return str(probe.getsockname()[0])


def machine_address() -> str:
    """Return this machine's address in the network, or its name without one."""
    try:
        return address_towards(SOMEWHERE)
    except OSError:
        return socket.gethostname()
