"""Keys in place of passwords: makes one, installs it on robots, tries it, knows their hosts."""

import asyncio
import base64
import hashlib
import hmac
import os
import secrets
import shlex
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, Protocol

from pioneer3.errors import ConfigError, LoginError
from pioneer3.fleet.run import Done, Outcome, on_each, output_of
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.ssh import (
    KEY_NAMES,
    LOGIN,
    Login,
    accepts_passwords,
    asyncssh_module,
    connect,
    fingerprint,
    known_hosts_file,
    offered_host_key,
    ssh_folder,
)
from pioneer3.fleet.ssh_settings import settings_for

HASHED: Final = "|1|"
"""A line with a hashed name begins with this (sshd(8), SSH_KNOWN_HOSTS FILE FORMAT)."""
_SALT: Final = 20


def remember(path: Path, names: Sequence[str], public_key: str) -> None:
    """Add a host key to the file `path` of known hosts, for some names and addresses.

    The file is made where it is missing; the key is in OpenSSH's format, without a host name.
    """
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    old = path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""
    key = " ".join(public_key.split()[:2])
    names = tuple(dict.fromkeys(names))
    if hashes_names(old):
        new = "".join(f"{hashed(name)} {key}\n" for name in names)
    else:
        new = f"{','.join(names)} {key}\n"
    gap = "\n" if old and not old.endswith("\n") else ""
    descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        file.write(gap + new)


def hashed(name: str, salt: bytes | None = None) -> str:
    """Return a host name as `ssh-keygen -H` writes it."""
    salt = secrets.token_bytes(_SALT) if salt is None else salt
    digest = hmac.new(salt, name.encode(), hashlib.sha1).digest()
    return HASHED + "|".join(base64.b64encode(part).decode() for part in (salt, digest))


def hashes_names(old: str) -> bool:
    """Return whether names are hashed: as the last line is, else as `ssh` is set up to."""
    lines = [line for line in old.splitlines() if line.strip() and not line.startswith(("#", "@"))]
    if lines:
        return lines[-1].startswith(HASHED)
    ssh = shutil.which("ssh")
    if ssh is None:
        return False
    told = subprocess.run(
        [ssh, "-G", "localhost"], capture_output=True, text=True, timeout=10, check=False
    )
    return "hashknownhosts yes" in told.stdout.lower().splitlines()


WITHOUT_PASSWORDS: Final = (
    "printf 'PasswordAuthentication no\\nKbdInteractiveAuthentication no\\n' | "
    "sudo tee /etc/ssh/sshd_config.d/10-keys-only.conf && sudo sshd -t && "
    "sudo systemctl reload ssh"
)
"""Switches passwords off, on systems since 2020; older ones have it in /etc/ssh/sshd_config."""
_INSTALL: Final = (
    "umask 077; cd && mkdir -p .ssh && touch .ssh/authorized_keys && "
    "{{ grep -qxF {key} .ssh/authorized_keys || "
    '{{ test -z "$(tail -c 1 .ssh/authorized_keys)" || echo; echo {key}; }} '
    ">>.ssh/authorized_keys; }} && chmod go-w . .ssh .ssh/authorized_keys"
)


class Asker(Protocol):
    """Asks the person at the terminal."""

    async def accepts_host_key(self, robot: FleetRobot, fingerprint: str) -> bool:
        """Return whether a computer with this host key is the robot's."""
        ...

    async def password(self, robots: Sequence[FleetRobot]) -> str:
        """Return the password of the users there."""
        ...


def public_key() -> str | None:
    """Return the user's public key, from `~/.ssh`; `None` if there is none."""
    for name in KEY_NAMES:
        path = ssh_folder() / f"{name}.pub"
        if path.is_file():
            return path.read_text(encoding="utf-8").strip()
    return None


async def agent_key() -> str | None:
    """Return the first public key that the user's agent holds; `None` if there is none."""
    ssh = asyncssh_module()
    try:
        async with ssh.connect_agent() as agent:
            keys = await agent.get_keys()
    except (OSError, ValueError, ssh.Error):
        return None
    if not keys:
        return None
    exported = ssh.import_public_key(
        b" ".join((keys[0].algorithm, base64.b64encode(keys[0].public_data)))
    ).export_public_key()
    return str(exported.decode().strip())


def make_key(*, passphrase: bool) -> Path:
    """Make the user a key; `ssh-keygen` asks for the passphrase on the terminal.

    Raises:
        ConfigError: There is no `ssh-keygen`, or the person gave up.
    """
    program = shutil.which("ssh-keygen")
    if program is None:
        raise ConfigError("no ssh-keygen here; run: sudo apt-get install -y openssh-client")
    ssh_folder().mkdir(mode=0o700, parents=True, exist_ok=True)
    path = ssh_folder() / KEY_NAMES[0]
    words = [program, "-q", "-t", "ed25519", "-f", str(path)]
    done = subprocess.run(words if passphrase else [*words, "-N", ""], check=False)
    if done.returncode != 0 or not path.is_file():
        raise ConfigError(f"{path}: no key was made")
    return path


async def install_key(
    robots: Iterable[FleetRobot], key: str, asker: Asker, *, login: Login = LOGIN
) -> tuple[Outcome, ...]:
    """Let the owner of `key` log in on all computers, and try that.

    Host keys that are not known yet are asked about, one after the other, and remembered. The
    password is asked for once, only if a computer does not accept the public `key` already.
    """
    robots = tuple(robots)
    offered: dict[str, str | None] = {}
    refused: set[str] = set()

    async def look(robot: FleetRobot) -> Done:
        offered[robot.name] = await offered_host_key(robot, login)
        return Done()

    async def try_key(robot: FleetRobot) -> Done:
        try:
            return await _tried(robot, login, "the key was installed before")
        except LoginError:
            refused.add(robot.name)
            raise

    outcomes = {each.robot: each for each in await on_each(robots, look)}
    for robot in robots:
        new_key = offered.get(robot.name)
        if new_key is not None and not await _introduced(robot, new_key, asker):
            why = "its host key was not accepted; nothing was installed"
            outcomes[robot.name] = replace(outcomes[robot.name], ok=False, why=why)
    reached = [robot for robot in robots if outcomes[robot.name].ok]
    outcomes |= {each.robot: each for each in await on_each(reached, try_key)}
    to_install = [robot for robot in robots if robot.name in refused]
    if to_install:
        with_password = replace(login, password=await asker.password(to_install))

        async def install(robot: FleetRobot) -> Done:
            async with connect(robot, with_password) as connection:
                await output_of(connection, _INSTALL.format(key=shlex.quote(key)))
            return await _tried(robot, login, "the key is installed, and works")

        outcomes |= {each.robot: each for each in await on_each(to_install, install)}
    return tuple(outcomes[robot.name] for robot in robots)


async def with_passwords(robots: Iterable[FleetRobot], *, login: Login = LOGIN) -> tuple[str, ...]:
    """Return the names of robots whose computers let people in with a password."""
    found: list[str] = []

    async def ask(robot: FleetRobot) -> Done:
        if await accepts_passwords(robot, login):
            found.append(robot.name)
        return Done()

    robots = tuple(robots)
    await on_each(robots, ask)
    return tuple(robot.name for robot in robots if robot.name in found)


async def _introduced(robot: FleetRobot, key: str, asker: Asker) -> bool:
    """Ask about a host key, and remember it if it is accepted."""
    if not await asker.accepts_host_key(robot, fingerprint(key)):
        return False
    settings = await settings_for(robot.name)
    names = settings.names_of(robot.host, robot.name, robot.address)
    await asyncio.to_thread(remember, known_hosts_file(), names, key)
    return True


async def _tried(robot: FleetRobot, login: Login, said: str) -> Done:
    """Log in with the key; raises as :func:`connect` and :func:`output_of` do."""
    async with connect(robot, login) as connection:
        await output_of(connection, "true")
    return Done(said=said)
