"""The service manager of an on-board computer: the real systemd of its user, and a real journal.

`systemd --user` asks for three things that namespaces do not have: the folder by which it knows
that systemd booted the system, a control group of its own, and the user's folder in `/run`.
"""

import os
import shutil
import subprocess
import time
import uuid
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Final

from tests.fleet.lab import PATIENCE, USER, USER_NUMBER, OnBoard

SYSTEMD: Final = Path("/lib/systemd/systemd")
JOURNAL: Final = Path("/lib/systemd/systemd-journald")
GROUPS: Final = Path("/sys/fs/cgroup")
USERS: Final = f"user.slice/user-{USER_NUMBER}.slice/user@{USER_NUMBER}.service"
"""The journal knows the units of a user by this path of control groups."""
RUNTIME: Final = f"/run/user/{USER_NUMBER}"
_PREPARE: Final = f"""\
set -e
mkdir -p /run/systemd/system /run/systemd/journal {RUNTIME}
touch /run/systemd/journal/flushed
chown {USER_NUMBER}:{USER_NUMBER} {RUNTIME}
chmod 700 {RUNTIME}
mount -t tmpfs tmpfs /var/log
mkdir /var/log/journal
mount --bind "$1" /etc/machine-id
"""
_RUN: Final = f"""\
for folder in "$@"; do echo $$ >"$folder/cgroup.procs"; done
exec setpriv --reuid {USER_NUMBER} --regid {USER_NUMBER} --init-groups \
  env -i HOME=/home/{USER} USER={USER} LOGNAME={USER} SHELL=/bin/bash \
  PATH=/usr/local/bin:/usr/bin:/bin XDG_RUNTIME_DIR={RUNTIME} {SYSTEMD} --user
"""


def why_no_manager() -> str:
    """Return the reason why systemd cannot run in a lab on this machine; empty if it can."""
    missing = [
        str(path) for path in (SYSTEMD, JOURNAL, Path("/etc/machine-id")) if not path.exists()
    ]
    missing += [] if shutil.which("systemctl") else ["systemctl"]
    if missing:
        return f"no {', '.join(missing)} here"
    try:
        with _groups("p3lab-probe"):
            return ""
    except OSError as error:
        return f"control groups cannot be made here: {error}"


@contextmanager
def managed(computers: Sequence[OnBoard]) -> Iterator[None]:
    """Let the user of each computer have a service manager during the block; then switch it off."""
    with ExitStack() as stack:
        for computer in computers:
            stack.enter_context(_managed(computer))
        yield


@contextmanager
def _managed(computer: OnBoard) -> Iterator[None]:
    with _groups(f"p3lab-{computer.process}") as folders, ExitStack() as stack:
        for folder in folders:
            (folder / "cgroup.procs").write_text(str(computer.process))
        machine = computer.folder / "machine-id"
        machine.write_text(uuid.uuid4().hex + "\n")
        _call(computer, _PREPARE, str(machine))
        users = [str(folder / USERS) for folder in folders]
        for words in ([str(JOURNAL)], ["sh", "-c", _RUN, "sh", *users]):
            process = subprocess.Popen(
                [*computer.inside, *words],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            stack.callback(process.wait)
            stack.callback(process.kill)  # nsenter stops itself when its child has been stopped
        stack.callback(computer.stop)
        _wait_for_manager(computer)
        yield


@contextmanager
def _groups(name: str) -> Iterator[list[Path]]:
    """Make a control group in each tree that systemd uses, with one for the user."""
    trees = [GROUPS / each for each in ("systemd", "unified") if (GROUPS / each).is_dir()]
    folders = [tree / name for tree in trees or [GROUPS]]
    try:
        for folder in folders:
            users = folder / USERS
            users.mkdir(parents=True)
            for path in (users, *users.iterdir()):
                os.chown(path, USER_NUMBER, USER_NUMBER)
        yield folders
    finally:
        for folder in folders:
            _remove(folder)


def _remove(folder: Path) -> None:
    """Remove a control group and those in it, once their processes have gone."""
    end = time.monotonic() + PATIENCE
    while folder.exists():
        for path, _, _ in os.walk(folder, topdown=False):
            with suppress(OSError):
                os.rmdir(path)  # noqa: PTH106
        assert time.monotonic() < end, f"{folder} is still in use"
        time.sleep(0.01)


def as_user(computer: OnBoard, *words: str) -> list[str]:
    """Return the command that runs `words` as the computer's user, with its service manager."""
    user = ["setpriv", "--reuid", str(USER_NUMBER), "--regid", str(USER_NUMBER), "--init-groups"]
    variables = ["env", f"HOME=/home/{USER}", f"XDG_RUNTIME_DIR={RUNTIME}"]
    return [*computer.inside, *user, *variables, *words]


def _wait_for_manager(computer: OnBoard) -> None:
    end = time.monotonic() + PATIENCE
    ask = as_user(computer, "systemctl", "--user", "is-active", "default.target")
    while subprocess.run(ask, capture_output=True, check=False).stdout.strip() != b"active":
        assert time.monotonic() < end, f"systemd does not start on {computer.name}"
        time.sleep(0.05)


def _call(computer: OnBoard, script: str, *arguments: str) -> None:
    subprocess.run([*computer.inside, "sh", "-c", script, "sh", *arguments], check=True)
