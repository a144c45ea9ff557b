"""Certificates: made once, kept private, made anew when they must be."""

import ssl
import stat
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding

from pioneer3.errors import ConfigError
from pioneer3.web.access import certificate
from pioneer3.web.access.certificate import Certificate, certificate_for, own, owners
from pioneer3.web.access.certificate_authority import DAYS, load_or_make, names_in, sign

NAMES = ["lab-pc", "lab-pc.local", "192.168.0.7"]


def read(path: Path) -> x509.Certificate:
    return x509.load_pem_x509_certificate(path.read_bytes())


def connects(made: Certificate, name: str) -> bool:
    """Whether who trusts the authority trusts this server under `name`."""
    server = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    client = ssl.create_default_context(cafile=str(made.authority))
    server.load_cert_chain(made.chain, made.key)
    to_client, to_server = ssl.MemoryBIO(), ssl.MemoryBIO()
    ends = (
        client.wrap_bio(to_client, to_server, server_hostname=name),
        server.wrap_bio(to_server, to_client, server_side=True),
    )
    for _ in range(4):
        for end in ends:
            try:
                end.do_handshake()
            except ssl.SSLWantReadError:
                continue
            except ssl.SSLError:
                return False
    return ends[0].cipher() is not None


@pytest.fixture(scope="module", autouse=True)
def _at_lab_pc() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("socket.gethostname", lambda: "lab-pc")
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    return own(tmp_path_factory.mktemp("tls"), NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_who_trusts_the_authority_trusts_the_server_under_its_names(
    made: Certificate, name: str
) -> None:
    assert connects(made, name)


@pytest.mark.parametrize("name", ["other.local", "192.168.0.8"])
def test_and_under_no_other(made: Certificate, name: str) -> None:
    assert not connects(made, name)


def test_keys_are_for_their_owner_alone(made: Certificate) -> None:
    for path in (made.key, made.key.with_name("ca.key")):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert made.authority is not None
    assert b"PRIVATE" not in made.chain.read_bytes() + made.authority.read_bytes()


def test_it_lasts_no_longer_than_phones_accept(made: Certificate) -> None:
    chain = read(made.chain)
    assert chain.not_valid_after_utc - chain.not_valid_before_utc <= timedelta(days=398)
    assert names_in(chain) == set(NAMES)


@pytest.mark.parametrize("name", ["bank.example", "8.8.8.8"])
def test_the_authority_cannot_vouch_for_the_rest_of_the_world(tmp_path: Path, name: str) -> None:
    made = own(tmp_path, NAMES)
    sign(load_or_make(tmp_path, NAMES), [name], made.chain, made.key)
    assert names_in(read(made.chain)) == {name}
    assert not connects(made, name)


def test_so_such_names_are_left_out(tmp_path: Path) -> None:
    own(tmp_path, NAMES)
    made = own(tmp_path, [*NAMES, "8.8.8.8", "lab-pc.example", "localx"])
    assert names_in(read(made.chain)) == set(NAMES)
    assert connects(made, "lab-pc")


def test_a_public_address_is_vouched_for_from_the_beginning(tmp_path: Path) -> None:
    made = own(tmp_path, [*NAMES, "198.51.100.7"])
    assert connects(made, "198.51.100.7")
    assert not connects(own(tmp_path, [*NAMES, "198.51.100.8"]), "198.51.100.8")


def test_it_is_kept_and_the_authority_survives_new_addresses(tmp_path: Path) -> None:
    first = own(tmp_path, NAMES)
    chain, authority = first.chain.read_bytes(), (tmp_path / "ca.pem").read_bytes()
    assert own(tmp_path, NAMES[:2]).chain.read_bytes() == chain
    moved = own(tmp_path, ["lab-pc", "10.0.0.4"])
    assert moved.chain.read_bytes() != chain
    assert (tmp_path / "ca.pem").read_bytes() == authority
    assert connects(moved, "10.0.0.4")


@pytest.mark.parametrize("file", ["server.pem", "server.key"])
def test_a_broken_or_missing_file_is_made_anew(tmp_path: Path, file: str) -> None:
    own(tmp_path, NAMES)
    (tmp_path / file).unlink()
    assert connects(own(tmp_path, NAMES), "lab-pc")
    (tmp_path / file).write_text("spoiled")
    assert connects(own(tmp_path, NAMES), "lab-pc")


def test_a_key_that_others_can_read_is_made_anew(tmp_path: Path) -> None:
    made = own(tmp_path, NAMES)
    before = made.key.read_bytes()
    made.key.chmod(0o644)
    own(tmp_path, NAMES)
    assert made.key.read_bytes() != before
    assert stat.S_IMODE(made.key.stat().st_mode) == 0o600


def test_one_that_ends_soon_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = own(tmp_path, NAMES).chain.read_bytes()

    class Later(datetime):
        @classmethod
        def now(cls, tz: object = None) -> "Later":
            return cls.fromtimestamp(datetime.now(UTC).timestamp() + (DAYS - 29) * 86400, UTC)

    monkeypatch.setattr(certificate, "datetime", Later)
    assert own(tmp_path, NAMES).chain.read_bytes() != before


def test_a_folder_that_cannot_be_written_is_explained(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="cannot keep the certificate there"):
        own(tmp_path / "file" / "tls", NAMES)


def test_the_owners_is_taken_as_it_is(made: Certificate) -> None:
    assert owners(made.chain, made.key) == Certificate(made.chain, made.key)
    assert certificate_for("0.0.0.0", made.chain, made.key) == Certificate(made.chain, made.key)


def test_what_is_wrong_with_the_owners_is_said(made: Certificate, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="No such file"):
        owners(tmp_path / "none.pem", made.key)
    with pytest.raises(ConfigError, match="--cert"):
        owners(made.chain, made.key.with_name("ca.key"))
    with pytest.raises(ConfigError, match="belong together"):
        certificate_for("0.0.0.0", made.chain, None)


def test_this_machine_alone_needs_none() -> None:
    assert certificate_for("127.0.0.1", None, None) is None


def test_the_fingerprint_is_that_of_the_certificate(made: Certificate) -> None:
    der = read(made.chain).public_bytes(Encoding.DER)
    shown = certificate.digest(made.chain)
    assert len(shown.split(":")) == 32
    assert bytes.fromhex(shown.replace(":", "")) == sha256(der).digest()
