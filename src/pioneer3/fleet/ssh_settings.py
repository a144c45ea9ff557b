"""Settings of `ssh` for a robot's computer, from `~/.ssh/config`, as `ssh` itself reads them.

The fleet file has its address and its user; all that the file does not have counts from there.
"""

import asyncio
import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Final

SSH_PORT: Final = 22
_BRACKETS: Final = re.compile(r"\[([^\]:]*)\]")
"""ssh puts every address in brackets; asyncssh wants a name or an address of IPv4 without them."""
_NONE: Final = "none"
"""The word of ssh for no value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SshSettings:
    """How `ssh NAME` reaches a computer, with files of private keys.

    Computers lead there as `ProxyJump` has them, empty for none, and its host key is known by an
    `alias` as `HostKeyAlias` has it, empty for its own name.
    """

    port: int = SSH_PORT
    jump: str = ""
    alias: str = ""
    keys: tuple[Path, ...] = ()

    def names_of(self, *usual: str) -> tuple[str, ...]:
        """Return the names in the list of known hosts, for the names of the computer."""
        if self.alias:
            return (self.alias,)
        names = dict.fromkeys(usual)
        return tuple(names if self.port == SSH_PORT else (f"[{n}]:{self.port}" for n in names))


async def settings_for(name: str) -> SshSettings:
    """Return the settings for a host name; the usual ones without a file or without `ssh`."""
    ssh = shutil.which("ssh")
    if ssh is None or not (Path.home() / ".ssh/config").is_file():
        return SshSettings()
    process = await asyncio.create_subprocess_exec(
        *(ssh, "-G", name),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
    )
    try:
        said, _ = await process.communicate()
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    return parsed(said.decode(errors="replace"))


def parsed(said: str) -> SshSettings:
    """Return the settings in the output of `ssh -G`."""
    values: dict[str, list[str]] = {}
    for line in said.splitlines():
        key, _, value = line.partition(" ")
        values.setdefault(key, []).append(value.strip())

    def one(key: str) -> str:
        value = values.get(key, [""])[0]
        return "" if value == _NONE else value

    port = one("port")
    return SshSettings(
        port=int(port) if port.isdecimal() else SSH_PORT,
        jump=_BRACKETS.sub(r"\1", one("proxyjump")),
        alias=one("hostkeyalias"),
        keys=tuple(Path(key).expanduser() for key in values.get("identityfile", [])),
    )
