"""The user's list of host keys: adding to it as `ssh` does, with hashed names where it hashes."""

import base64
import hashlib
import hmac
import os
import secrets
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Final

HASHED: Final = "|1|"
"""A line with a hashed name begins with this (sshd(8), SSH_KNOWN_HOSTS FILE FORMAT)."""
_SALT: Final = 20


def remember(path: Path, names: Sequence[str], public_key: str) -> None:
    """Add a host key to the file `path` of known hosts; it is made where it is missing.

    Args:
        path: Of the file.
        names: Host names and addresses that the key is for.
        public_key: In OpenSSH's format, without a host name.
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
