"""Under which addresses others find this machine."""

import socket
from contextlib import suppress

PROBES = ((socket.AF_INET, "192.0.2.1"), (socket.AF_INET6, "2001:db8::1"))
"""Addresses for documentation: asking for the way to them sends nothing."""


def lan_addresses(host: str) -> list[str]:
    """Return the addresses at which a server on `host` is found, the best first.

    For `0.0.0.0`, those of this machine that others can reach.
    """
    if host not in {"0.0.0.0", "::", ""}:
        return [host]
    found = list(filter(None, (_towards(family, probe) for family, probe in PROBES)))
    with suppress(OSError):
        known = socket.getaddrinfo(socket.gethostname(), None, type=socket.SOCK_STREAM)
        found += [str(entry[4][0]) for entry in known]
    wanted = found if host == "::" else [a for a in found if ":" not in a]
    return [a for a in dict.fromkeys(wanted) if not a.startswith(("127.", "::1", "fe80"))]


def _towards(family: socket.AddressFamily, probe: str) -> str | None:
    """Return the address that this machine would send from."""
    with suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as one:
        one.connect((probe, 9))
        return str(one.getsockname()[0])
    return None
