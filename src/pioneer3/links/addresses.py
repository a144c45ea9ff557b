"""Addresses at which a port of this computer is reached."""

import socket
from typing import Final

ANY: Final = {"0.0.0.0", "::", ""}
"""All addresses of this computer."""
SOMEWHERE: Final = ("192.0.2.1", 9)
"""Kept free for documentation (RFC 5737); nothing is sent there."""


def url_of(host: str, port: int) -> str:
    """Return the URL of a port that listens at `host`.

    A port at all addresses of this machine is reached at the one that other machines see.
    """
    reached = machine_address() if host in ANY else host
    return f"tcp://[{reached}]:{port}" if ":" in reached else f"tcp://{reached}:{port}"


def machine_address() -> str:
    """Return this machine's address in the network, or its name without one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(SOMEWHERE)  # only asks which way packets would take
        except OSError:
            return socket.gethostname()
        address: str = probe.getsockname()[0]
        return address
