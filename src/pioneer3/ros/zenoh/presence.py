"""Whether there is a router, and the reason if there is none."""

import logging
import socket
import ssl
from collections.abc import Sequence
from dataclasses import replace
from threading import Event, Thread
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from pioneer3.ros.zenoh.settings import FIX, ZenohOptions, session_config, shown

if TYPE_CHECKING:
    import zenoh

PERIOD: Final = 1.0
"""Between two looks [s]."""
PATIENCE: Final = 2.0
"""An end that takes longer to answer is not there [s]."""
HELLO: Final = b"\x01\x09\x02\x01"
"""First message of a session: kind, version of the protocol, a client, its identity of one byte."""
log = logging.getLogger(__name__)


class RouterWatch:
    """Logs when there is no router at `endpoints`, and when there is one again."""

    def __init__(
        self, session: "zenoh.Session", options: ZenohOptions, endpoints: Sequence[str]
    ) -> None:
        self._session = session
        self._options = options
        self._endpoints = endpoints
        self._over = Event()
        self._thread = Thread(target=self._run, name="zenoh-router", daemon=True)
        if endpoints:
            self._thread.start()

    def close(self) -> None:
        """Look no more."""
        self._over.set()

    def _run(self) -> None:
        told = ""
        while not self._over.is_set():
            if connected(self._session):
                if told:
                    log.warning("a router of Zenoh is there now")
                told = ""
            else:
                sentence = self._sentence()
                if sentence != told and not self._over.is_set():
                    log.warning("%s", sentence)
                    told = sentence
            self._over.wait(PERIOD)

    def _sentence(self) -> str:
        if found := refusal(self._options, self._endpoints):
            return found
        places = ", ".join(map(shown, self._endpoints))
        return f"no router of Zenoh at {places}: {FIX}; this node goes on as soon as there is one"


def connected(session: "zenoh.Session") -> bool:
    """Return whether a session has a router, or anybody else."""
    import zenoh

    try:
        return bool(session.info.routers_zid() or session.info.peers_zid())
    except zenoh.ZError:  # closed
        return False


def refusal(options: ZenohOptions, endpoints: Sequence[str]) -> str:
    """Return the reason why an end that answers does not let us in; empty if there is none."""
    for endpoint in endpoints:
        protocol, _, place = shown(endpoint).partition("?")[0].partition("/")
        if protocol not in {"tcp", "tls"}:
            continue
        if found := _refusal_of(options, protocol, place):
            return f"{shown(endpoint)}: {found}"
    return ""


def _refusal_of(options: ZenohOptions, protocol: str, place: str) -> str:
    where = urlsplit(f"//{place}")
    host, port = where.hostname or "", where.port or 0
    try:
        with (
            socket.create_connection((host, port), PATIENCE) as plain,
            _wrapped(options, plain, host) if protocol == "tls" else plain as link,
        ):
            answers = _answers(link)
    except ssl.SSLCertVerificationError as error:
        fix = f"it is not by an authority of {options.ca}" if options.ca else "give its `ca`"
        return f"its certificate is not trusted ({error.verify_message}): {fix}"
    except ssl.SSLError as error:
        return "" if "ALERT" not in str(error.reason) else _advice(options, protocol)
    except OSError:
        return ""
    if not answers or _lets_in(options, f"{protocol}/{place}"):
        return ""
    return _advice(options, protocol)


def _wrapped(options: ZenohOptions, link: socket.socket, host: str) -> socket.socket:
    context = ssl.create_default_context(cafile=options.ca)
    if options.certificate is not None and options.key is not None:
        context.load_cert_chain(options.certificate, options.key)
    return context.wrap_socket(link, server_hostname=host)


def _answers(link: socket.socket) -> bool:
    """Return whether a router is at the other end, not only something that forwards to it."""
    link.sendall(len(HELLO).to_bytes(2, "little") + HELLO)
    return bool(link.recv(1))


def _lets_in(options: ZenohOptions, endpoint: str) -> bool:
    """Return whether a session for a try is let in."""
    import zenoh

    config = session_config(replace(options, config=None, mode="client", connect=(endpoint,)))
    config.insert_json5("connect/exit_on_failure", "true")
    try:
        zenoh.open(config).close()
    except zenoh.ZError:
        return False
    return True


def _advice(options: ZenohOptions, protocol: str) -> str:
    if options.credentials is not None:
        return f"it refuses user or password of {options.credentials}"
    if protocol == "tls":
        return "it lets nobody in without a certificate of its authority, or without a login"
    return "it lets nobody in without a user and a password (`credentials`)"
