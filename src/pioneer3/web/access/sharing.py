"""Letting others in: the certificate they meet, the addresses they are told."""

import socket
from collections.abc import Iterator
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.web.access import certificate
from pioneer3.web.access.access import Access
from pioneer3.web.access.addresses import lan_addresses
from pioneer3.web.access.certificate import Certificate
from pioneer3.web.access.invitations import TERM
from pioneer3.web.access.names import is_loopback
from pioneer3.web.access.role import Role


def certificate_for(host: str, cert: Path | None, key: Path | None) -> Certificate | None:
    """Return what to serve https with at `host`: the owner's, or one of ours where others come.

    Raises:
        ConfigError: the owner's is incomplete or wrong, or ours cannot be kept.
    """
    if cert is not None and key is not None:
        return certificate.owners(cert, key)
    if cert is not None or key is not None:
        raise ConfigError("--cert and --key belong together: the certificate and its private key")
    if is_loopback(host):
        return None
    name = socket.gethostname().lower()
    names = [name, f"{name}.local", "localhost", "127.0.0.1", *lan_addresses(host)]
    return certificate.own(certificate.state_folder(), list(dict.fromkeys(names)))


def others_urls(host: str, http: int, https: int | None, *, trusted: bool) -> tuple[str, ...]:
    """Return where others find the page, the best first: https where it is `trusted`.

    Args:
        host: What the server listens on.
        http: Its TCP port.
        https: The port for TLS, `None` without.
        trusted: Whether browsers know the certificate.
    """
    if is_loopback(host):
        return ()
    hosts = [f"[{a}]" if ":" in a else a for a in lan_addresses(host)]
    plain = [f"http://{a}:{http}" for a in hosts]
    secure = [f"https://{a}:{https}" for a in hosts] if https else []
    return (*secure, *plain) if trusted else (*plain, *secure)


def invitation_lines(access: Access) -> Iterator[str]:
    """Yield what lets a driver in and a viewer: a QR code and two addresses, each good once."""
    from pioneer3.web.access.invite import pairing_url, terminal_lines  # noqa: PLC0415

    driver, viewer = (
        pairing_url(access.urls[0], access.invitations.invite(role), role)
        for role in (Role.DRIVER, Role.VIEWER)
    )
    yield from terminal_lines(driver)
    yield f"Scan this to drive, or open {driver}"
    yield f"To watch only: {viewer}"
    yield f"Each is good once, for {TERM / 60:.0f} minutes."
