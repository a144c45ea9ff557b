"""Which names and addresses are ours, and which requests come from our own page."""

import re
import socket
from collections.abc import Mapping
from ipaddress import IPv4Address, IPv6Address, ip_address

LOCAL_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})
FORWARDED = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-real-ip", "via")
_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:[0-9]{1,5})?", re.IGNORECASE | re.ASCII)


def host_name(host: str | None) -> str:
    """Return the name in a Host header such as `localhost:8080`, empty if that is malformed."""
    matched = _HOST.fullmatch(host or "")
    return matched[1].strip("[]").lower() if matched else ""


def is_ours(host: str | None, names: frozenset[str]) -> bool:
    """Whether `host`, a header such as `localhost:8080`, is a name this server goes by.

    So is every number: a name is what DNS rebinding needs.
    """
    name = host_name(host)
    return bool(name) and (name in names or parsed(name) is not None)


def own_names(host: str) -> frozenset[str]:
    """Return the names this machine goes by when it listens at `host`."""
    if is_loopback(host):
        return LOCAL_NAMES | {host.lower()}
    name = socket.gethostname().lower()
    return LOCAL_NAMES | {host.lower(), name, f"{name}.local"}


def is_loopback(name: str) -> bool:
    """Whether only this machine can have said or can reach `name`, a name or an address."""
    address = parsed(name)
    return name.lower() == "localhost" or (address is not None and address.is_loopback)


def is_from_here(peer: str, headers: Mapping[str, str]) -> bool:
    """Whether a request comes from this very machine: not through a proxy, not by another name."""
    return (
        is_loopback(peer)
        and is_loopback(host_name(headers.get("host")))
        and not any(name in headers for name in FORWARDED)
    )


def is_own_origin(headers: Mapping[str, str]) -> bool:
    """Whether a request comes from our own page, or from no page at all, such as a script.

    Browsers name the origin of every request that could change something and of every WebSocket;
    other pages may lead here by a link, but load nothing.
    """
    origin, host = headers.get("origin"), headers.get("host")
    if origin is not None:
        return origin in {f"http://{host}", f"https://{host}"}
    site, mode = headers.get("sec-fetch-site", "none"), headers.get("sec-fetch-mode")
    return site in {"none", "same-origin"} or mode == "navigate"


def parsed(text: str) -> IPv4Address | IPv6Address | None:
    """Return `text` as an address, an IPv4 one in IPv6 clothing as what it is, or `None`."""
    try:
        address = ip_address(text)
    except ValueError:
        return None
    return getattr(address, "ipv4_mapped", None) or address
