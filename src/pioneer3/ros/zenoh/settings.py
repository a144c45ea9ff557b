"""Settings of a Zenoh session: endpoints, TLS and login, secrets in files only; a router."""

import asyncio
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.ros.zenoh.config_file import ConfigFile, read_config

if TYPE_CHECKING:
    import zenoh

ROUTER: Final = "tcp/localhost:7447"
"""Where the router of a computer is."""
FIX: Final = "start one with `ros2 run rmw_zenoh_cpp rmw_zenohd`, or with `pioneer3 ros2 router`"
LEASE_MS: Final = 10_000
"""Silence after which the other end is taken for gone."""
ONE_SIDE: Final[Mapping[str, object]] = {"peer": {"to_router": "always", "to_peer": "greater-zid"}}
"""One of two peers that learn of each other connects, as with rmw_zenoh_cpp. Where both did at once
and had to log in, neither got through at times, and the router did not forward between them."""
COMMON: Final[Mapping[str, object]] = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": True,
    "scouting/gossip/autoconnect_strategy": ONE_SIDE,
    "timestamping/enabled": True,  # caches of publishers need stamps
    "transport/shared_memory/enabled": False,
    "transport/link/tx/lease": LEASE_MS,
    "routing/router/peers_failover_brokering": True,
    "connect/exit_on_failure": False,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohOptions:
    """How to take part in a Zenoh network.

    Attributes:
        domain: ROS domain.
        connect: Endpoints to connect to, such as `tls/robot.example.org:7447`.
        listen: Endpoints to listen on; port 0 is any.
        mode: `peer`, `client` or `router`.
        config: Configuration file of Zenoh (JSON5), as `ZENOH_SESSION_CONFIG_URI` names one. It
            wins over mode and endpoints; a setting that it does not have is as without a file,
            so that nothing listens on the network because a line is missing.
        ca: Certificates (PEM) of the authorities that the other end's certificate is checked by;
            with `certificate` and `key`, both ends must show a certificate.
        certificate: Own certificate (PEM).
        key: Its private key (PEM), readable by its owner only.
        credentials: File with a line `user:password`, readable by its owner only; of a router with
            a line for each user who may connect, the first for itself.
    """

    domain: int = 0
    connect: tuple[str, ...] = (ROUTER,)
    listen: tuple[str, ...] = ("tcp/localhost:0",)
    mode: str = "peer"
    config: Path | None = None
    ca: Path | None = None
    certificate: Path | None = None
    key: Path | None = None
    credentials: Path | None = None


def load_zenoh() -> None:
    """Import Zenoh; ConfigError if it is not installed."""
    try:
        import_module("zenoh.ext")
    except ImportError as error:
        advice = how_to_get("zenoh")
        raise ConfigError(f"ROS 2 over Zenoh needs eclipse-zenoh: {advice}") from error


def session_config(options: ZenohOptions) -> "zenoh.Config":
    """Return the configuration of a session; ConfigError for settings or files that are wrong."""
    import zenoh

    settings = {**_security(options), **_login(options.credentials)}
    config, file = zenoh.Config(), ConfigFile({})
    if options.config is not None:
        config, file = _from_file(options.config)
    mode = json.loads(str(config.get_json("mode"))) or options.mode
    own = {
        **COMMON,
        "mode": mode,
        "connect/endpoints": options.connect,
        "listen/endpoints": options.listen if mode != "client" else (),
        # a client would wait for a router for ever, a peer goes on without
        "connect/timeout_ms": 0 if mode == "client" else -1,
    }
    settings |= {name: value for name, value in own.items() if not file.has(name)}
    for name, value in settings.items():
        try:
            config.insert_json5(name, json.dumps(value))
        except zenoh.ZError:  # its text has the value, which may be a secret
            raise ConfigError(f"Zenoh takes no such value of {name}") from None
    return config


def endpoints_of(config: "zenoh.Config") -> tuple[str, ...]:
    """Return the endpoints that a session connects to."""
    found = json.loads(str(config.get_json("connect/endpoints")))
    if isinstance(found, dict):
        mode = json.loads(str(config.get_json("mode")))
        found = found.get(mode or "peer") or []
    urls = (each if isinstance(each, str) else each["url"] for each in found)
    return tuple(urls)


def shown(endpoint: str) -> str:
    """Return an endpoint without its options, which may be secrets."""
    return endpoint.partition("#")[0]


def check_private(path: Path) -> None:
    """Check that a file with a secret exists and only its owner reads it; else ConfigError."""
    check_there(path)
    if os.name != "nt" and path.stat().st_mode & 0o077:
        raise ConfigError(f"{path} holds a secret, and others may read it: chmod 600 {path}")


def check_there(path: Path) -> None:
    """Check that a file can be read; else ConfigError."""
    try:
        path.open("rb").close()
    except OSError as error:
        raise ConfigError(f"{path} cannot be read: {error.strerror}") from error


def read_login(path: Path) -> tuple[str, str]:
    """Return user and password of the first line of a private file; ConfigError if it has none."""
    check_private(path)
    line = path.read_text(encoding="utf-8").strip().partition("\n")[0].strip()
    user, colon, password = line.partition(":")
    if not (user and colon and password):
        raise ConfigError(f"{path} has no line of the form user:password")
    return user, password


def _from_file(path: Path) -> "tuple[zenoh.Config, ConfigFile]":
    import zenoh

    check_there(path)
    try:
        config, file = zenoh.Config.from_file(path), read_config(path)
    except (zenoh.ZError, ValueError):  # its text may have lines of the file
        raise ConfigError(f"{path} is no configuration file of Zenoh (JSON5)") from None
    if file.holds_secrets:
        check_private(path)
    for secret in file.secret_files:
        check_private(secret)
    return config, file


def _security(options: ZenohOptions) -> dict[str, object]:
    """Return the settings of TLS."""
    if (options.certificate is None) != (options.key is None):
        raise ConfigError("a certificate and its key belong together: give both, or none")
    found: dict[str, object] = {}
    if options.ca is not None:
        check_there(options.ca)
        found["root_ca_certificate"] = str(options.ca)
    if options.certificate is not None and options.key is not None:
        check_there(options.certificate)
        check_private(options.key)
        for side in ("listen", "connect"):
            found[f"{side}_certificate"] = str(options.certificate)
            found[f"{side}_private_key"] = str(options.key)
        found["enable_mtls"] = options.ca is not None
    return {f"transport/link/tls/{name}": value for name, value in found.items()}


def _login(path: Path | None) -> dict[str, object]:
    """Return the settings of a login, with which others may connect to this end as well."""
    if path is None:
        return {}
    user, password = read_login(path)
    values = {"user": user, "password": password, "dictionary_file": str(path)}
    return {"transport/auth/usrpwd": values}


DEFAULT: Final = ZenohOptions(mode="router", connect=(), listen=(ROUTER,))
"""A router for the programs of this computer."""


async def serve_router(
    options: ZenohOptions = DEFAULT, tell: Callable[[str], None] = lambda line: None
) -> None:
    """Run a router until cancelled, and `tell` so; ConfigError for a setting or a taken port."""
    load_zenoh()
    import zenoh

    config = session_config(options)
    try:
        session = await asyncio.to_thread(zenoh.open, config)
    except zenoh.ZError as error:
        ports = ", ".join(map(shown, options.listen))
        raise ConfigError(
            f"no router on {ports}: {reason(error)}; if another one runs there, that one will do"
        ) from None
    try:
        tell(f"Zenoh router on {', '.join(map(shown, options.listen))}")
        await asyncio.get_running_loop().create_future()
    finally:
        await asyncio.to_thread(session.close)


def reason(error: Exception) -> str:
    """Return the first sentence of an error of Zenoh, without places in its source."""
    return str(error).partition(" at /")[0].strip()
