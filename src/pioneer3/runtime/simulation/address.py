"""How hosts write the address of a port."""

import socket

ANY = {"0.0.0.0", "::", ""}
SOMEWHERE = ("192.0.2.1", 9)
"""Kept free for documentation (RFC 5737); nothing is sent there."""


def url_of(host: str, port: int) -> str:
    """Return the URL of a port that listens at `host`.

    Who listens at all addresses of this machine is reached at the one that other machines see.
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
