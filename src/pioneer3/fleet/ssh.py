"""Logging in on a robot's computer over ssh, and the meaning of failures.

Host keys are always checked, against the files that `ssh` uses; its settings count, too. Keys come
from the agent and from the usual files in `~/.ssh`; passwords only where a caller asks for one.
"""

import asyncio
import errno
import os
import socket
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import HostError, LoginError
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.ssh_settings import SSH_PORT, SshSettings, settings_for

if TYPE_CHECKING:
    import asyncssh

PATIENCE: Final = 20.0
"""Time to log in [s]: ten round trips over a slow wireless network, some of them lost."""
SYSTEM_KNOWN_HOSTS: Final = Path("/etc/ssh/ssh_known_hosts")
KEY_NAMES: Final = ("id_ed25519", "id_ecdsa", "id_rsa", "id_ed25519_sk", "id_ecdsa_sk")
"""The usual names of keys in `~/.ssh`, in the order of preference."""
_NETWORK: Final = {
    errno.ECONNREFUSED: "{address} refuses ssh: no ssh server runs there; on it run: "
    "sudo apt-get install -y openssh-server",
    errno.EHOSTUNREACH: "no computer at {address}: it is off, out of reach, or has another "
    "address now",
    errno.ENETUNREACH: "this computer is in no network that leads to {address}: connect it",
    errno.ETIMEDOUT: "no answer from {address}: it is off, or out of reach",
}
"""Failures of a connection, in words."""
_HANGING_UP: Final = {errno.ECONNRESET, errno.EPIPE}
_CLOSING: Final = 1.0
"""Longest wait for the end of a connection [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Login:
    """How to log in: with a password in place of keys where it is not `None`; it is never stored.

    The patience is the longest time to log in, and after such a silence a connection is lost [s].
    """

    patience: float = PATIENCE
    password: str | None = None


LOGIN: Final = Login()


def ssh_folder() -> Path:
    """Return the user's folder of keys and known hosts."""
    return Path.home() / ".ssh"


def known_hosts_file() -> Path:
    """Return the user's list of host keys, which may not be there yet."""
    return ssh_folder() / "known_hosts"


def asyncssh_module() -> Any:
    """Import asyncssh; HostError says how to get it if it is not installed."""
    try:
        import asyncssh
    except ImportError:
        raise HostError(how_to_get("fleet")) from None
    return asyncssh


@asynccontextmanager
async def connect(
    robot: FleetRobot, login: Login = LOGIN
) -> "AsyncIterator[asyncssh.SSHClientConnection]":
    """Log in on the computer of `robot` for the block.

    Raises:
        HostError: It cannot be reached, or does not let us in; or the connection was lost.
    """
    ssh = asyncssh_module()
    attempt = _Attempt(robot, login)
    try:
        connection = await attempt.connected()
    except (OSError, ssh.Error, ValueError) as error:
        raise attempt.explained(error) from error
    try:
        yield connection
    except HostError:
        raise
    except (ssh.DisconnectError, ssh.ChannelOpenError, ConnectionError) as error:
        raise HostError(
            f"the connection to {robot.address} was lost: it is switched off, out of reach, or "
            f"was silent for {login.patience:g} s"
        ) from error
    finally:
        connection.close()
        try:
            async with asyncio.timeout(_CLOSING):
                await connection.wait_closed()
        except (TimeoutError, OSError, ssh.Error):
            connection.abort()


async def offered_host_key(robot: FleetRobot, login: Login = LOGIN) -> str | None:
    """Return the host key that `robot`'s computer shows, if it is not known yet, else `None`.

    It is a line in OpenSSH's format, without a host name. Nothing but the key is exchanged. Raises
    HostError if it cannot be reached, or has another key than before.
    """
    ssh = asyncssh_module()
    attempt = _Attempt(robot, login)
    try:
        connection = await attempt.connected()
    except ssh.HostKeyNotVerifiable as error:
        if attempt.known or attempt.offered is None:
            raise attempt.explained(error) from error
        return str(attempt.offered.export_public_key().decode().strip())
    except ssh.PermissionDenied:
        return None  # the key was accepted before
    except (OSError, ssh.Error, ValueError) as error:
        raise attempt.explained(error) from error
    connection.close()
    await connection.wait_closed()
    return None


async def accepts_passwords(robot: FleetRobot, login: Login = LOGIN) -> bool:
    """Return whether a robot's computer would let people in with a password.

    Raises:
        HostError: It cannot be reached, or its host key is wrong.
    """
    ssh = asyncssh_module()
    attempt = _Attempt(robot, login, keys=False)
    try:
        connection = await attempt.connected()
    except ssh.PermissionDenied:
        return attempt.offers_passwords
    except (OSError, ssh.Error, ValueError) as error:
        raise attempt.explained(error) from error
    connection.close()  # that user needs no password at all
    await connection.wait_closed()
    return True


def fingerprint(public_key: str) -> str:
    """Return the fingerprint of a public key, as `ssh-keygen -l` shows it."""
    return str(asyncssh_module().import_public_key(public_key).get_fingerprint())


class _Attempt:
    """One attempt to log in, and the facts for its error."""

    def __init__(self, robot: FleetRobot, login: Login, *, keys: bool = True) -> None:
        self.robot, self.login = robot, login
        self.reached = self.offers_passwords = False
        self._with_keys = keys and login.password is None
        self.offered: asyncssh.SSHKey | None = None
        self.settings = SshSettings()
        self.known: Sequence[asyncssh.SSHKey] = ()

    async def connected(self) -> "asyncssh.SSHClientConnection":
        """Log in; raise OSError or asyncssh.Error if network or computer do not let us."""
        login, with_keys = self.login, self._with_keys
        async with asyncio.timeout(login.patience):
            self.settings = settings = await settings_for(self.robot.name)
            matched = _known_keys(self.robot, settings)
            self.known = (*matched[0], *matched[1])
            connection: asyncssh.SSHClientConnection = await asyncssh_module().connect(
                self.robot.address,
                settings.port,
                tunnel=settings.jump or None,
                username=self.robot.user,
                client_factory=self.client(),
                known_hosts=matched,
                config=None,
                client_keys=_client_keys(settings) if with_keys else None,
                agent_path=() if with_keys else None,
                password=login.password,
                preferred_auth="publickey" if with_keys else "password,keyboard-interactive",
                login_timeout=None,  # the block around it has the only one
                keepalive_interval=login.patience / 2,
                keepalive_count_max=1,
            )
        return connection

    def client(self) -> "type[asyncssh.SSHClient]":
        """Return the class whose objects notice how far the attempt comes."""
        attempt = self

        class Client(asyncssh_module().SSHClient):  # type: ignore[misc]
            def connection_made(self, conn: object) -> None:
                attempt.reached = True

            def validate_host_public_key(
                self, host: str, addr: str, port: int, key: "asyncssh.SSHKey"
            ) -> bool:
                attempt.offered = key
                return False

            def password_auth_requested(self) -> None:
                attempt.offers_passwords = True

            def kbdint_auth_requested(self) -> None:
                attempt.offers_passwords = True

        return Client

    def explained(self, error: Exception) -> HostError:
        """Return the error in words, with the next step."""
        if isinstance(error, HostError):
            return error
        refused = isinstance(error, asyncssh_module().PermissionDenied)
        return (LoginError if refused else HostError)(self._words(error))

    def _words(self, error: Exception) -> str:
        ssh = asyncssh_module()
        match error:
            case ssh.HostKeyNotVerifiable() | ssh.KeyExchangeFailed() if self.known:
                words = self._changed_key()
            case ssh.HostKeyNotVerifiable():
                words = "its host key is not known here yet; to compare and keep it run: "
                words += f"pioneer3 fleet key {self.robot.name}"
            case ssh.PermissionDenied():
                words = self._refused()
            case ssh.KeyExchangeFailed():
                words = f"its ssh and ours have no method in common: {error}"
            case ssh.DisconnectError() if self.reached:
                words = self._hung_up()
            case TimeoutError():
                words = self._silent()
            case OSError():
                words = self._not_reached(error)
            case _:
                words = f"{type(error).__name__}: {error}"
        return words

    def _silent(self) -> str:
        address, seconds = self.robot.address, self.login.patience
        if self.reached:
            return (
                f"{address} accepts the connection, then says nothing for {seconds:g} s: the "
                "computer hangs, or is overloaded; restart it"
            )
        return (
            f"no answer from {address} for {seconds:g} s: it is off, out of reach, or a "
            f"firewall drops ssh (port {self.settings.port}){self._way}"
        )

    def _not_reached(self, error: OSError) -> str:
        if error.errno in _HANGING_UP:
            return self._hung_up()
        words = _NETWORK.get(error.errno or 0, f"{{address}}: {error.strerror or error}")
        return words.replace("{address}", self.robot.address) + self._way

    @property
    def _way(self) -> str:
        """How `~/.ssh/config` leads there, if not by the usual way."""
        found = [f"port {self.settings.port}"] if self.settings.port != SSH_PORT else []
        found += [f"by way of {self.settings.jump}"] if self.settings.jump else []
        return f" ({', '.join(found)}, as ~/.ssh/config says)" if found else ""

    def _hung_up(self) -> str:
        return (
            f"{self.robot.address} hung up before the login: it has too many logins at once, bans "
            "this computer's address, or that is no ssh server"
        )

    def _changed_key(self) -> str:
        shown = f" ({self.offered.get_fingerprint()})" if self.offered is not None else ""
        robot = self.robot
        names = self.settings.names_of(robot.host, robot.address)
        forget = "; ".join(f"ssh-keygen -R '{name}'" for name in names)
        return (
            f"another host key than before{shown}: its system was installed anew, or ANOTHER "
            f"COMPUTER answers at {robot.address}. If you know why, forget the old key: "
            f"{forget}; then: pioneer3 fleet key {robot.name}"
        )

    def _refused(self) -> str:
        who = f"{self.robot.user}@{self.robot.address}"
        todo = f"pioneer3 fleet key {self.robot.name}"
        if self.login.password is not None:
            return f"{who}: wrong password, or logins with one are switched off there"
        if plain_keys() or _agent_answers():
            return f"{who} does not accept your key; to install it run: {todo}"
        if locked := next(iter(_keys()), None):
            return (
                f"your key {locked} has a passphrase, and no agent holds it; run: ssh-add {locked}"
            )
        return f"you have no ssh key; to make one and install it run: {todo}"


def plain_keys() -> tuple[Path, ...]:
    """Return the user's keys that have no passphrase."""
    return tuple(path for path in _keys() if not _is_locked(path))


def _keys() -> tuple[Path, ...]:
    paths = (ssh_folder() / name for name in KEY_NAMES)
    return tuple(path for path in paths if path.is_file())


def _is_locked(path: Path) -> bool:
    ssh = asyncssh_module()
    try:
        ssh.read_private_key(path)
    except (ssh.KeyEncryptionError, ssh.KeyImportError, OSError):
        return True
    return False


def _agent_answers() -> bool:
    """Whether an agent is there; its keys have been tried then."""
    name = os.environ.get("SSH_AUTH_SOCK")
    if not name:
        return False
    with socket.socket(socket.AF_UNIX) as agent:
        agent.settimeout(1.0)
        try:
            agent.connect(name)
            agent.sendall(b"\0\0\0\1\x0b")  # its identities: the answer's last number is how many
            answer = agent.recv(9)
        except OSError:
            return False
    return answer[4:5] == b"\x0c" and answer[5:9] != b"\0\0\0\0"


def _client_keys(settings: SshSettings) -> tuple[str, ...]:
    """Return the files of keys to try besides the agent's; empty for the usual ones."""
    usual = {ssh_folder() / name for name in KEY_NAMES}
    own = [key for key in settings.keys if key.is_file() and not _is_locked(key)]
    return () if set(own) <= usual else tuple(map(str, own))


def _known_keys(robot: FleetRobot, settings: SshSettings) -> tuple[list[Any], ...]:
    """Return the host keys to trust, authorities, revoked keys, and lists for X.509, empty.

    HostError tells of a wrong file of known hosts.
    """
    ssh = asyncssh_module()
    data = b"\n".join(
        path.read_bytes() for path in (known_hosts_file(), SYSTEM_KNOWN_HOSTS) if path.is_file()
    )
    try:
        hosts = ssh.import_known_hosts(data.decode(errors="replace"))
    except ValueError as error:
        raise HostError(f"{known_hosts_file()}: {error}; mend or remove that line") from None
    found: tuple[list[Any], ...] = tuple([] for _ in range(7))
    usual = settings.port == SSH_PORT or settings.alias
    names = (settings.alias,) if settings.alias else dict.fromkeys((robot.host, robot.name))
    for name in names:
        address = "" if settings.alias else robot.address
        matched = hosts.match(name, address, None if usual else settings.port)
        for keys, more in zip(found, matched, strict=False):
            keys.extend(key for key in more if key not in keys)
    return found
