"""A small certificate authority (X.509) of our own."""

import os
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from ipaddress import IPv4Address, IPv6Address, ip_address, ip_network
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from pioneer3.web.access.hosts import parsed

AUTHORITY_YEARS = 10
DAYS = 397
"""iOS takes 825 days from an authority that its user trusts, 398 from the others."""
PRIVATE_NETWORKS = (
    *("10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16", "169.254.0.0/16", "100.64.0.0/10"),
    *("127.0.0.0/8", "fc00::/7", "fe80::/10", "::1/128"),
)
"""Networks that do not exist on the internet."""


@dataclass(frozen=True, slots=True)
class CertificateAuthority:
    """Signs certificates."""

    certificate: x509.Certificate
    key: ec.EllipticCurvePrivateKey


def load_or_make(folder: Path, names: Sequence[str]) -> CertificateAuthority:
    """Return the authority kept in `folder`; the first time, or when it has expired, a new one.

    A new one may sign for the addresses among `names` as well: some laboratories have public ones.
    """
    chain, key = folder / "ca.pem", folder / "ca.key"
    if chain.exists() and key.exists():
        known = x509.load_pem_x509_certificate(chain.read_bytes())
        secret = serialization.load_pem_private_key(key.read_bytes(), None)
        lasts = known.not_valid_after_utc - datetime.now(UTC)
        if isinstance(secret, ec.EllipticCurvePrivateKey) and lasts > timedelta(days=DAYS):
            return CertificateAuthority(known, secret)
    made = _make([address for name in names if (address := parsed(name)) is not None])
    write_private(key, _pem(made.key))
    chain.write_bytes(made.certificate.public_bytes(serialization.Encoding.PEM))
    return made


def sign(authority: CertificateAuthority, names: Sequence[str], chain: Path, key: Path) -> None:
    """Write a certificate for `names`, host names and addresses, and its key."""
    secret = ec.generate_private_key(ec.SECP256R1())
    builder = _builder(_name(names[0]), authority.certificate.subject, secret, timedelta(days=DAYS))
    usage = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH])
    issuer = x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key())
    certificate = (
        builder.add_extension(x509.SubjectAlternativeName(list(map(_general, names))), False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), True)
        .add_extension(usage, False)
        .add_extension(issuer, False)
        .sign(authority.key, hashes.SHA256())
    )
    write_private(key, _pem(secret))
    chain.write_bytes(certificate.public_bytes(serialization.Encoding.PEM))


def may_sign(authority: x509.Certificate, name: str) -> bool:
    """Whether the authority may sign for `name`; one wrong name makes a certificate invalid."""
    constraints = authority.extensions.get_extension_for_class(x509.NameConstraints).value
    allowed = [each.value for each in constraints.permitted_subtrees or ()]
    address = parsed(name)
    if address is not None:
        return any(not isinstance(each, str) and address in each for each in allowed)
    return any(isinstance(each, str) and f".{name}".endswith(f".{each}") for each in allowed)


def names_in(certificate: x509.Certificate) -> set[str]:
    """Return the host names and addresses that a certificate is for."""
    names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    return {str(name.value) for name in names}


def write_private(path: Path, data: bytes) -> None:
    """Write a file that no other user can read at any time."""
    draft = path.with_name(f".{path.name}.new")
    draft.unlink(missing_ok=True)
    with os.fdopen(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(data)
    draft.replace(path)


def _make(addresses: Sequence[IPv4Address | IPv6Address]) -> CertificateAuthority:
    secret = ec.generate_private_key(ec.SECP256R1())
    host = socket.gethostname()
    name = _name(f"pioneer3 on {host}"[:64])
    own = [x509.DNSName(each) for each in ("localhost", "local", host.lower())]
    networks = [x509.IPAddress(ip_network(each)) for each in (*PRIVATE_NETWORKS, *addresses)]
    certificate = (
        _builder(name, name, secret, timedelta(days=365 * AUTHORITY_YEARS))
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), True)
        .add_extension(x509.NameConstraints([*own, *networks], None), True)
        .add_extension(
            x509.KeyUsage(
                digital_signature=False,
                content_commitment=False,
                key_encipherment=False,
                data_encipherment=False,
                key_agreement=False,
                key_cert_sign=True,
                crl_sign=True,
                encipher_only=False,
                decipher_only=False,
            ),
            True,
        )
        .sign(secret, hashes.SHA256())
    )
    return CertificateAuthority(certificate, secret)


def _builder(
    subject: x509.Name, issuer: x509.Name, secret: ec.EllipticCurvePrivateKey, lasts: timedelta
) -> x509.CertificateBuilder:
    now = datetime.now(UTC)
    key = secret.public_key()
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + lasts)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key), False)
    )


def _name(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _general(name: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ip_address(name))
    except ValueError:
        return x509.DNSName(name)


def _pem(secret: ec.EllipticCurvePrivateKey) -> bytes:
    return secret.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
