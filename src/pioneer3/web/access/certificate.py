"""The certificate for https: the owner's, or one that is made here and kept for this user alone.

A certificate authority is made on first use, which phones can be told to trust, and a certificate
signed by it for the present addresses. The authority may sign for private networks and our own
names only, so that its key, if it is stolen, is of no use against the rest of the world.
"""

import socket
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.errors import ConfigError
from pioneer3.links.hosts import is_loopback
from pioneer3.text import state_folder
from pioneer3.web.access.hosts import lan_addresses

if TYPE_CHECKING:
    from cryptography import x509

RENEW_BEFORE = timedelta(days=30)


@dataclass(frozen=True, slots=True)
class Certificate:
    """Files in PEM: a certificate, its private key, and the authority that signed one of ours."""

    chain: Path
    key: Path
    authority: Path | None = None


def owners(chain: Path, key: Path) -> Certificate:
    """Return the owner's certificate; ConfigError if its files do not fit, or cannot be read."""
    import ssl

    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(chain, key, password="")
    except (OSError, ssl.SSLError) as error:
        raise ConfigError(f"--cert {chain} --key {key}: {error.strerror or error}") from None
    return Certificate(chain, key)


def own(folder: Path, names: Sequence[str]) -> Certificate:
    """Return a certificate for `names`, host names and addresses; a new one when that is necessary.

    Names that the authority may not sign for are left out: public addresses that it was not made
    with, and the host's own if it has been renamed.

    Raises:
        ConfigError: the folder cannot be written to.
    """
    from pioneer3.web.access import certificate_authority

    certificate = Certificate(folder / "server.pem", folder / "server.key", folder / "ca.pem")
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        made = certificate_authority.load_or_make(folder, names)
        ours = [name for name in names if certificate_authority.may_sign(made.certificate, name)]
        if not _is_good(certificate, made.certificate, ours):
            certificate_authority.sign(made, ours, certificate.chain, certificate.key)
    except (OSError, ValueError) as error:
        raise ConfigError(f"{folder}: cannot keep the certificate there: {error}") from None
    return certificate


def digest(path: Path) -> str:
    """Return the fingerprint of a certificate, as phones and browsers show it."""
    from ssl import PEM_cert_to_DER_cert

    return sha256(PEM_cert_to_DER_cert(path.read_text())).digest().hex(":").upper()


def _is_good(known: Certificate, authority: "x509.Certificate", names: Sequence[str]) -> bool:
    """Whether a certificate that was made before is still good."""
    from cryptography import x509

    from pioneer3.web.access.certificate_authority import names_in

    try:
        certificate = x509.load_pem_x509_certificate(known.chain.read_bytes())
        if known.key.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            return False  # others may read it
        certificate.verify_directly_issued_by(authority)
        owners(known.chain, known.key)
    except Exception:
        return False
    lasts = certificate.not_valid_after_utc - datetime.now(UTC) > RENEW_BEFORE
    return lasts and set(names) <= names_in(certificate)


def certificate_for(host: str, cert: Path | None, key: Path | None) -> Certificate | None:
    """Return the certificate for https at `host`: the owner's, or ours where others can connect.

    Raises:
        ConfigError: the owner's is incomplete or wrong, or ours cannot be kept.
    """
    if cert is not None and key is not None:
        return owners(cert, key)
    if cert is not None or key is not None:
        raise ConfigError("--cert and --key belong together: the certificate and its private key")
    if is_loopback(host):
        return None
    name = socket.gethostname().lower()
    names = [name, f"{name}.local", "localhost", "127.0.0.1", *lan_addresses(host)]
    return own(state_folder() / "tls", list(dict.fromkeys(names)))
