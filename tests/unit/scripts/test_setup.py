"""`scripts/setup` behind a proxy that puts in its own certificate, and without a network."""

import os
import shutil
import ssl
import subprocess
import threading
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from http.server import HTTPServer, SimpleHTTPRequestHandler
from ipaddress import ip_address
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

SETUP = Path(__file__).parents[3] / "scripts/setup"
UNTRUSTED = """\
error: Request failed after 3 retries in 6.4s
  cause: Failed to fetch: https://pypi.org/simple/uvicorn/
  cause: error sending request for url (https://pypi.org/simple/uvicorn/)
  cause: client error (Connect)
  cause: invalid peer certificate: UnknownIssuer
"""
"""What uv 0.13 says where a proxy's authority is not trusted."""
OFFLINE = """\
error: Failed to fetch: https://pypi.org/simple/uvicorn/
  cause: error sending request for url (https://pypi.org/simple/uvicorn/)
  cause: client error (Connect)
  cause: dns error
  cause: failed to lookup address information: Temporary failure in name resolution
"""
FULL = "error: failed to write to the archive\n  cause: No space left on device (os error 28)\n"
UV = """\
#!/bin/sh
case "$1" in
  --version) echo "uv 0.0.0" ;;
  --help) echo "{option}" ;;
  *) env | grep -E "^(UV|PIP)_" >"$SEEN"; cat >&2 "$SAYS"; exit 2 ;;
esac
"""


class Clone:
    """A copy of the project with nothing but its set-up, and a home of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "scripts").mkdir()
        (folder / "bin").mkdir()
        shutil.copy(SETUP, folder / "scripts/setup")
        for name in ("pyproject.toml", "uv.lock", "bundle.pem"):
            (folder / name).write_text("something\n")

    def put_uv(self, says: str, option: str = "--system-certs") -> None:
        """Put a uv in the way that fails with these words."""
        (self.folder / "says").write_text(says)
        uv = self.folder / "bin/uv"
        uv.write_text(UV.format(option=option))
        uv.chmod(0o755)

    def set_up(self, **variables: str) -> str:
        """Run the script, which must fail; return what it told."""
        set_here = ("UV_", "PIP_", "SSL_", "REQUESTS_", "CURL_")
        clean = {k: v for k, v in os.environ.items() if not k.startswith(set_here)}
        done = subprocess.run(
            ["bash", self.folder / "scripts/setup"],
            env={
                **clean,
                "HOME": str(self.folder),
                "PATH": f"{self.folder / 'bin'}:/usr/local/bin:/usr/bin:/bin",
                "SAYS": str(self.folder / "says"),
                "SEEN": str(self.folder / "seen"),
                "PIP_CONFIG_FILE": os.devnull,
                **variables,
            },
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        assert done.returncode == 1
        return done.stderr

    @property
    def seen(self) -> set[str]:
        """What uv found in its environment."""
        return set((self.folder / "seen").read_text().splitlines())


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


def test_a_certificate_that_is_not_trusted_is_told_and_is_no_missing_network(clone: Clone) -> None:
    clone.put_uv(UNTRUSTED)
    told = clone.set_up()
    assert "invalid peer certificate: UnknownIssuer" in told
    assert "the server's certificate is not trusted here" in told
    assert "update-ca-certificates" in told
    assert "no network" not in told


@pytest.mark.parametrize(
    ("words", "advice"),
    [(OFFLINE, "no network: the set-up loads packages"), (FULL, "the lines above say where")],
)
def test_the_words_of_the_failure_come_before_what_they_mean(
    words: str, advice: str, clone: Clone
) -> None:
    clone.put_uv(words)
    told = clone.set_up()
    assert words in told
    assert advice in told.partition(words)[2]


def test_uv_and_pip_trust_what_this_system_trusts(clone: Clone) -> None:
    clone.put_uv(UNTRUSTED)
    bundle = str(clone.folder / "bundle.pem")
    clone.set_up(SSL_CERT_FILE=bundle)
    assert {"UV_SYSTEM_CERTS=true", f"PIP_CERT={bundle}"} <= clone.seen
    assert "UV_NATIVE_TLS=true" not in clone.seen  # uv would complain of it


def test_an_old_uv_is_told_in_its_own_words(clone: Clone) -> None:
    clone.put_uv(UNTRUSTED, option="--native-tls")
    clone.set_up(SSL_CERT_FILE=str(clone.folder / "bundle.pem"))
    assert "UV_NATIVE_TLS=true" in clone.seen


def test_what_a_person_has_set_stays(clone: Clone) -> None:
    clone.put_uv(UNTRUSTED)
    clone.set_up(
        SSL_CERT_FILE=str(clone.folder / "bundle.pem"), UV_SYSTEM_CERTS="false", PIP_CERT="mine"
    )
    assert {"UV_SYSTEM_CERTS=false", "PIP_CERT=mine"} <= clone.seen


@pytest.fixture
def index(tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """Serve an empty package index over TLS; yield its address and the authority that signed it."""
    folder = tmp_path / "index"
    (folder / "simple").mkdir(parents=True)
    pem = folder / "key.pem"
    authority = _certified(pem)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(pem)

    class Quiet(SimpleHTTPRequestHandler):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments, directory=str(folder))  # type: ignore[arg-type]

        def log_message(self, *_: object) -> None:
            pass

    class Server(HTTPServer):
        def handle_error(self, *_: object) -> None:
            """A client that does not trust us hangs up."""

    server = Server(("127.0.0.1", 0), Quiet)
    server.socket = context.wrap_socket(server.socket, server_side=True)
    serving = threading.Thread(target=server.serve_forever)
    serving.start()
    yield f"https://127.0.0.1:{server.server_port}/simple", authority
    server.shutdown()
    serving.join()
    server.server_close()


def _certified(pem: Path) -> Path:
    """Write a key and its certificate for this computer to `pem`; return who signed it."""
    ours, theirs = (ec.generate_private_key(ec.SECP256R1()) for _ in range(2))
    authority = _signed("a proxy", theirs.public_key(), theirs, ca=True)
    certificate = _signed("this computer", ours.public_key(), theirs, ca=False)
    private = ours.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    pem.write_bytes(private + certificate.public_bytes(serialization.Encoding.PEM))
    file = pem.with_name("authority.pem")
    file.write_bytes(authority.public_bytes(serialization.Encoding.PEM))
    return file


def _signed(
    name: str, key: ec.EllipticCurvePublicKey, by: ec.EllipticCurvePrivateKey, *, ca: bool
) -> x509.Certificate:
    def called(name: str) -> x509.Name:
        return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])

    now = datetime.now(UTC)
    here = x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))])
    return (
        x509.CertificateBuilder()
        .subject_name(called(name))
        .issuer_name(called("a proxy"))
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=1))
        .add_extension(here, critical=False)
        .add_extension(x509.BasicConstraints(ca=ca, path_length=None), critical=True)
        .sign(by, hashes.SHA256())
    )


@pytest.mark.realtime
@pytest.mark.thorough
@pytest.mark.parametrize("trusted", [False, True])
def test_pip_which_brings_uv_says_the_same_of_a_real_server(
    clone: Clone, index: tuple[str, Path], *, trusted: bool
) -> None:
    url, authority = index
    known = {"SSL_CERT_FILE": str(authority)} if trusted else {}
    told = clone.set_up(PIP_INDEX_URL=url, PIP_RETRIES="0", PIP_NO_CACHE_DIR="1", **known)
    assert ("the server's certificate is not trusted here" in told) is not trusted
    assert ("CERTIFICATE_VERIFY_FAILED" in told) is not trusted
    assert "No matching distribution found for uv" in told
    assert "no network" not in told
