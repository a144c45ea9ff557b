"""Names and addresses of this machine, and requests that come from it or from its own pages."""

import re
import socket
from collections.abc import Iterator, Mapping
from contextlib import suppress
from ipaddress import IPv4Address, IPv6Address, ip_address

from pioneer3.links.hosts import ANY, SOMEWHERE, address_towards, bracketed, is_loopback

LOCAL_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})
FORWARDED = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-real-ip", "via")
_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:[0-9]{1,5})?", re.IGNORECASE | re.ASCII)


def host_name(host: str | None) -> str:
    """Return the name in a Host header such as `localhost:8080`, empty if that is malformed."""
    matched = _HOST.fullmatch(host or "")
    return matched[1].strip("[]").lower() if matched else ""


def is_ours(host: str | None, names: frozenset[str]) -> bool:
    """Whether `host`, a header such as `localhost:8080`, is a name of this server.

    Every address counts as one: DNS rebinding needs a name.
    """
    name = host_name(host)
    return bool(name) and (name in names or parsed(name) is not None)


def own_names(host: str) -> frozenset[str]:
    """Return the names of this machine when it listens at `host`."""
    if is_loopback(host):
        return LOCAL_NAMES | {host.lower()}
    name = socket.gethostname().lower()
    return LOCAL_NAMES | {host.lower(), name, f"{name}.local"}


def is_from_here(peer: str, headers: Mapping[str, str]) -> bool:
    """Whether a request comes from this machine: not through a proxy, not by another name."""
    return (
        is_loopback(peer)
        and is_loopback(host_name(headers.get("host")))
        and not any(name in headers for name in FORWARDED)
    )


def is_own_origin(headers: Mapping[str, str]) -> bool:
    """Whether a request comes from our own page, or from no page, such as a script.

    Browsers name the origin of every request that could change something and of every WebSocket;
    other pages may lead here by a link, but load nothing.
    """
    origin, host = headers.get("origin"), headers.get("host")
    if origin is not None:
        return origin in {f"http://{host}", f"https://{host}"}
    site, mode = headers.get("sec-fetch-site", "none"), headers.get("sec-fetch-mode")
    return site in {"none", "same-origin"} or mode == "navigate"


def parsed(text: str) -> IPv4Address | IPv6Address | None:
    """Return `text` as an address, an IPv4 address that is mapped into IPv6 as IPv4, or `None`."""
    try:
        address = ip_address(text)
    except ValueError:
        return None
    return getattr(address, "ipv4_mapped", None) or address


def lan_addresses(host: str) -> list[str]:
    """Return the addresses at which a server on `host` is found, the best first.

    For `0.0.0.0`, those of all interfaces: the network of the robots often has no default route.
    """
    if host not in ANY:
        return [host]
    found = map(ip_address, dict.fromkeys([*_routes(), *_of_interfaces()]))
    return [
        str(address)
        for address in sorted(found, key=lambda address: address.is_link_local)
        if not address.is_loopback
        and (address.version == 4 or (host == "::" and not address.is_link_local))
    ]


def _of_interfaces() -> list[str]:
    """Return the addresses of all network interfaces of this machine."""
    import ifaddr

    numbers = (number.ip for adapter in ifaddr.get_adapters() for number in adapter.ips)
    return [number if isinstance(number, str) else number[0] for number in numbers]


def _routes() -> Iterator[str]:
    """Yield the addresses that this machine would send from."""
    for somewhere in (SOMEWHERE, "2001:db8::1"):
        with suppress(OSError):
            yield address_towards(somewhere)


def others_urls(host: str, http: int, https: int | None, *, trusted: bool) -> tuple[str, ...]:
    """Return the addresses of the page for other machines, the best first.

    The server listens on `host`, at a TCP port without TLS and one with it, `None` for none; https
    comes first if browsers trust the certificate.
    """
    if is_loopback(host):
        return ()
    hosts = list(map(bracketed, lan_addresses(host)))
    plain = [f"http://{a}:{http}" for a in hosts]
    secure = [f"https://{a}:{https}" for a in hosts] if https else []
    return (*secure, *plain) if trusted else (*plain, *secure)
