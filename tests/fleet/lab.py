"""A lab: an operator's computer and on-board computers, each with namespaces of its own.

Each has its own network, mounts, host name, users and home; the on-board computers also their own
processes and a real sshd. All of it vanishes with this process.
"""

import contextlib
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Final, Self

from tests.fleet.network import CARD, Cable, Switch

PATIENCE: Final = 60.0
"""Longest wait for anything on a busy machine [s]."""
USER, USER_NUMBER = "pioneer", 5400
PASSWORD: Final = "correct horse"
OPERATOR_ADDRESS: Final = "192.168.1.10"
SSHD: Final = "/usr/sbin/sshd"
SMALL: Final = "/opt/small"
"""A folder of the on-board computers on a disk of 256 KiB."""
ROOT: Final = Path(__file__).parents[2]
NEEDED: Final = ("unshare", "nsenter", "setpriv", "ip", "ssh-keygen")

_ACCOUNTS = {
    "passwd": "root:x:0:0:root:{home}:/bin/bash\nsshd:x:102:65534::/run/sshd:/usr/sbin/nologin\n"
    "nobody:x:65534:65534::/:/usr/sbin/nologin\n"
    f"{USER}:x:{USER_NUMBER}:{USER_NUMBER}::/home/{USER}:/bin/bash\n",
    "shadow": "root:*:19000:0:99999:7:::\nsshd:*:19000:0:99999:7:::\n"
    f"{USER}:{{password}}:19000:0:99999:7:::\n",
    "group": f"root:x:0:\ntty:x:5:\nshadow:x:42:\ndialout:x:20:{USER}\nnogroup:x:65534:\n"
    f"{USER}:x:{USER_NUMBER}:\n",
    "hosts": "127.0.0.1 localhost\n",
    "hostname": "{name}\n",
}
_SSHD_CONFIG = """\
HostKey {folder}/host_key
PidFile none
UsePAM no
PasswordAuthentication yes
PermitRootLogin no
Subsystem sftp internal-sftp
MaxStartups 100
"""
_LIAR = """\
import os, subprocess, sys
truth, lie = map(os.fsencode, sys.argv[1:])
server = subprocess.Popen("/usr/lib/openssh/sftp-server", stdout=subprocess.PIPE, bufsize=0)
while data := server.stdout.read(1 << 16):
    sys.stdout.buffer.write(data.replace(truth, lie))
    sys.stdout.buffer.flush()
"""
_START = """\
set -e
mount --make-rprivate /
if [ "$OWN_PROCESSES" ]; then mount -t proc proc /proc; fi
hostname "$NAME"
for file in passwd shadow group hosts hostname; do
  mount --bind "$FOLDER/etc/$file" "/etc/$file"
done
for folder in /home /run /opt; do mount -t tmpfs -o size=400m,mode=755 tmpfs $folder; done
mkdir -p /run/sshd /home/pioneer /opt/small
mount -t tmpfs -o size=256k,mode=1777 tmpfs /opt/small
chown 5400:5400 /home/pioneer
ip link set lo up
echo ready
read -r _
ip link set "$CARD" mtu 1500 up
ip address add "$ADDRESS/24" dev "$CARD"
echo connected
while [ "$OWN_PROCESSES" ]; do
  "$SSHD" -D -e -f "$FOLDER/sshd_config" 2>>"$FOLDER/log" || true
  sleep 0.05
done
exec sleep infinity
"""


def why_not() -> str:
    """Return the reason why there can be no lab on this machine; empty if there can."""
    missing = [program for program in (*NEEDED, SSHD) if shutil.which(program) is None]
    if missing:
        return f"no {', '.join(missing)} here: apt-get install openssh-server iproute2 util-linux"
    if os.geteuid() != 0:
        return "namespaces with users of their own need root"
    if not os.access("/dev/net/tun", os.R_OK | os.W_OK):
        return "no /dev/net/tun here"
    made = subprocess.run(["unshare", "-nmup", "--fork", "true"], capture_output=True, check=False)
    return "" if made.returncode == 0 else made.stderr.decode().strip()


class Computer:
    """A computer of the lab.

    Attributes:
        name: Its host name.
        address: Its address in the lab's network.
        folder: What it is made of; seen under the same path inside.
        cable: Its connection to the others.
    """

    own_processes = True

    def __init__(self, name: str, address: str, folder: Path, switch: Switch) -> None:
        self.name, self.address, self.folder = name, address, folder
        self.etc = folder / "etc"
        self.etc.mkdir(parents=True)
        for file, text in _ACCOUNTS.items():
            (self.etc / file).write_text(self._filled(text))
        self._prepare()
        self._holder = self._held()
        self._said("ready")
        self.cable: Cable = switch.plug_in(self.process)
        assert self._holder.stdin is not None
        self._holder.stdin.write("\n")
        self._holder.stdin.flush()
        self._said("connected")

    def _filled(self, text: str) -> str:
        return (
            text.replace("{name}", self.name)
            .replace("{password}", _hashed(PASSWORD))
            .replace("{home}", str(self.home))
            .replace("{folder}", str(self.folder))
        )

    @property
    def home(self) -> Path:
        """The home of root."""
        return Path("/root")

    def _prepare(self) -> None:
        subprocess.run(
            ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.folder / "host_key"],
            check=True,
        )
        (self.folder / "sshd_config").write_text(self._filled(_SSHD_CONFIG))

    def _held(self) -> "subprocess.Popen[str]":
        namespaces = ["--net", "--mount", "--uts", "--kill-child", "--fork"]
        namespaces += ["--pid"] if self.own_processes else []
        return subprocess.Popen(
            ["setpriv", "--pdeathsig", "KILL", "unshare", *namespaces, "bash", "-c", _START],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={
                "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
                "NAME": self.name,
                "FOLDER": str(self.folder),
                "ADDRESS": self.address,
                "CARD": CARD,
                "SSHD": SSHD,
                "OWN_PROCESSES": "1" if self.own_processes else "",
            },
        )

    def _said(self, word: str) -> None:
        assert self._holder.stdout is not None
        line = self._holder.stdout.readline().strip()
        assert line == word, f"{self.name} said {line!r} in place of {word!r}"

    @property
    def process(self) -> int:
        """The first process inside."""
        holder = self._holder.pid
        return int(Path(f"/proc/{holder}/task/{holder}/children").read_text().split()[0])

    @property
    def inside(self) -> list[str]:
        """The words that come before a command to run it here, as root."""
        spaces = ["--net", "--mount", "--uts", *(["--pid"] if self.own_processes else [])]
        return ["nsenter", "--target", str(self.process), *spaces, f"--wd={self.home}", "--"]

    def sh(self, command: str, *, check: bool = True) -> str:
        """Run a line of the shell here as root; return its output."""
        done = subprocess.run(
            [*self.inside, "sh", "-c", command],
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        assert done.returncode == 0 or not check, done.stderr
        return done.stdout

    def processes(self, words: str = "") -> list[int]:
        """Return the processes inside whose command line contains `words`; own processes only."""
        own = Path(f"/proc/{self.process}/ns/pid").readlink()
        found = []
        for process in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if (process / "ns/pid").readlink() == own:
                    line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                    found += [int(process.name)] if words in line else []
        return found

    def freeze(self) -> None:
        """Stop every process: the network answers, the programs do not."""
        for process in self.processes():
            os.kill(process, signal.SIGSTOP)

    def thaw(self) -> None:
        """Let every process go on."""
        for process in self.processes():
            os.kill(process, signal.SIGCONT)

    def stop(self) -> None:
        """Switch it off."""
        if self._holder.poll() is None:
            with contextlib.suppress(ProcessLookupError, IndexError, FileNotFoundError):
                os.kill(self.process, signal.SIGKILL)
            self._holder.kill()
        self._holder.wait()
        for pipe in (self._holder.stdin, self._holder.stdout):
            assert pipe is not None
            with contextlib.suppress(BrokenPipeError):
                pipe.close()
        self.cable.plugged = False


class OnBoard(Computer):
    """The computer of a robot, with sshd and the user `pioneer`."""

    @property
    def user_home(self) -> Path:
        """The home of its user, as this process can reach it."""
        return Path(f"/proc/{self.process}/root/home/{USER}")

    @property
    def root(self) -> Path:
        """Its file system, as this process can reach it."""
        return Path(f"/proc/{self.process}/root")

    def authorize(self, public_key: str) -> None:
        """Let the owner of a key log in as its user."""
        folder = self.user_home / ".ssh"
        folder.mkdir(mode=0o700, exist_ok=True)
        (folder / "authorized_keys").write_text(public_key)
        for path in (folder, folder / "authorized_keys"):
            os.chown(path, USER_NUMBER, USER_NUMBER)

    @property
    def host_key(self) -> str:
        """Its public host key, without a comment."""
        return " ".join((self.folder / "host_key.pub").read_text().split()[:2])

    def replace_program(self, path: str, script: str) -> None:
        """Put a script of the shell in the place of a program, which is `$0.real` to it."""
        name = path.rpartition("/")[2]
        new = self.folder / name
        real = f"/run/{name}.real"
        new.write_text("#!/bin/sh\n" + script.replace("$0.real", real))
        new.chmod(0o755)
        self.sh(f"if [ -e {path} ]; then cp {path} {real}; else touch {path}; fi")
        self.sh(f"mount --bind {new} {path}")

    def set_password_login(self, *, on: bool) -> None:
        """Change the sshd's settings, and start it anew."""
        config = self.folder / "sshd_config"
        word = "yes" if on else "no"
        first = f"PasswordAuthentication {word}\nKbdInteractiveAuthentication {word}\n"
        config.write_text(first + self._filled(_SSHD_CONFIG))  # the first of two lines counts
        self.restart_sshd()

    def lie(self, truth: str, lie: str) -> None:
        """Let its file transfer tell a lie in the place of each truth, which is as long."""
        assert len(truth) == len(lie)
        self.sh(f"printf %s {shlex.quote(_LIAR)} >/run/liar.py")
        liar = f"Subsystem sftp /usr/bin/python3 /run/liar.py {truth} {lie}\n"
        told = self._filled(_SSHD_CONFIG).replace("Subsystem sftp internal-sftp\n", liar)
        (self.folder / "sshd_config").write_text(told)
        self.restart_sshd()

    def new_host_key(self) -> None:
        """Get another host key, as after a new installation."""
        for name in ("host_key", "host_key.pub"):
            (self.folder / name).unlink()
        self._prepare()
        self.restart_sshd()

    def restart_sshd(self) -> None:
        """End the sshd; the next one starts at once."""
        self._end_sshd()
        self.wait_for_sshd()

    def stop_sshd(self) -> None:
        """End the sshd for good: connections are refused."""
        (self.folder / "sshd_config").write_text("Nonsense yes\n")
        self._end_sshd()

    def _end_sshd(self) -> None:
        listening = self.processes(f"sshd: {SSHD}")
        assert listening
        for process in listening:
            os.kill(process, signal.SIGTERM)
        while set(listening) & set(self.processes()):
            time.sleep(0.02)

    def wait_for_sshd(self) -> None:
        """Wait until it answers."""
        end = time.monotonic() + PATIENCE
        ask = ["bash", "-c", "read -t 5 line </dev/tcp/127.0.0.1/22 && [[ $line == SSH* ]]"]
        while subprocess.run([*self.inside, *ask], capture_output=True, check=False).returncode:
            assert time.monotonic() < end, (self.folder / "log").read_text()
            time.sleep(0.05)


class Operator(Computer):
    """The computer of the person who works with the robots."""

    own_processes = False
    source = ROOT / "src"
    """Where its pioneer3 is."""
    more: Mapping[str, str] = MappingProxyType({})
    """Variables that its commands see, besides the usual ones."""

    @property
    def home(self) -> Path:
        """The home of root."""
        return self.folder / "home"

    def _prepare(self) -> None:
        (self.home / ".ssh").mkdir(mode=0o700, parents=True)

    @property
    def environment(self) -> dict[str, str]:
        """The variables that its commands see."""
        return {
            "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
            "HOME": str(self.home),
            "USER": "root",
            "LANG": "C.UTF-8",
            "PYTHONPATH": str(self.source),
            "COLUMNS": "100",
            **self.more,
        }

    @property
    def known_hosts(self) -> Path:
        """Its list of host keys."""
        return self.home / ".ssh/known_hosts"

    def make_key(self) -> str:
        """Make a key without a passphrase; return the public one."""
        key = self.home / ".ssh/id_ed25519"
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", key], check=True)
        return key.with_suffix(".pub").read_text()

    def in_lab(self, *words: str) -> list[str]:
        """Return the command line that runs `words` in the folder `lab` of the home."""
        spaces = self.inside[:-2]  # the last two name the home
        return [*spaces, f"--wd={self.home / 'lab'}", "--", *words]

    def install(self, name: str, script: str) -> None:
        """Put a program of the shell on the path, before all others."""
        folder = self.folder / "bin"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(f"#!/bin/sh\n{script}\n")
        (folder / name).chmod(0o755)

    def command(self, *arguments: str) -> list[str]:
        """Return the command line of `pioneer3` with these arguments, here."""
        return [*self.inside, sys.executable, "-m", "pioneer3", *arguments]

    def p3(self, *arguments: str, text: str = "") -> "subprocess.CompletedProcess[str]":
        """Run `pioneer3` to its end in the operator's home."""
        return subprocess.run(
            self.command(*arguments),
            input=text,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            env=self.environment,
            check=False,
        )


class Lab:
    """An operator and `number` robots, p3at-1 at 192.168.1.111 and so on.

    The operator has a key that all accept, knows their host keys, and has a `fleet.toml`.
    """

    def __init__(self, folder: Path, number: int = 3, *, introduced: bool = True) -> None:
        self._folder, self._number, self._introduced = folder, number, introduced
        self._stack = ExitStack()
        self.switch = Switch()

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stack.enter_context(self.switch)
            self.operator = Operator(
                "laptop", OPERATOR_ADDRESS, self._folder / "laptop", self.switch
            )
            stack.callback(self.operator.stop)
            self.robots: list[OnBoard] = []
            for number in range(1, self._number + 1):
                name = f"p3at-{number}"
                robot = OnBoard(name, f"192.168.1.{110 + number}", self._folder / name, self.switch)
                stack.callback(robot.stop)
                self.robots.append(robot)
            for robot in self.robots:
                robot.wait_for_sshd()
            self.write_fleet()
            if self._introduced:
                self.introduce()
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.close()

    def introduce(self) -> None:
        """Let the operator in everywhere, and let it know all host keys."""
        key = self.operator.make_key()
        for robot in self.robots:
            robot.authorize(key)
        self.operator.known_hosts.write_text(
            "".join(f"{each.name},{each.address} {each.host_key}\n" for each in self.robots)
        )

    def write_fleet(self, *, tcp: bool = False, **defaults: str) -> None:
        """Write the operator's `fleet.toml`.

        Args:
            tcp: Whether the robots are at port 8101 of their computers.
            defaults: Of all robots.
        """
        lines = ["[operator]", 'name = "laptop"', f'address = "{OPERATOR_ADDRESS}"']
        lines += ["[defaults]", *(f'{key} = "{value}"' for key, value in defaults.items())]
        for robot in self.robots:
            lines += ["", "[[robot]]", f'name = "{robot.name}"', f'address = "{robot.address}"']
            lines += [f'port = "tcp://{robot.name}:8101"'] if tcp else []
        front = ", ".join(f'"{robot.name}"' for robot in self.robots[:2])
        lines += ["", "[groups]", f"front = [{front}]"]
        (self.operator.home / "fleet.toml").write_text("\n".join(lines) + "\n")


def _hashed(password: str) -> str:
    done = subprocess.run(
        ["openssl", "passwd", "-6", "-stdin"],
        input=password,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()
