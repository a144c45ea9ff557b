"""`pioneer3 fleet key`: from a shared password to a key, with nothing secret left anywhere."""

import os
import pty
import re
import select
import subprocess
import time
from collections.abc import Iterator, Sequence

import pytest

from tests.fleet.lab import PASSWORD, PATIENCE, Lab

pytestmark = pytest.mark.realtime


class Terminal:
    """A command of the operator at a terminal."""

    def __init__(self, lab: Lab, arguments: Sequence[str]) -> None:
        self._master, slave = pty.openpty()
        self.shown = ""
        self.process = subprocess.Popen(
            lab.operator.command(*arguments),
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
            env=lab.operator.environment | {"COLUMNS": "200", "TERM": "dumb"},
        )
        os.close(slave)

    def until(self, pattern: str) -> None:
        """Wait until the pattern is shown, after what was waited for before."""
        end = time.monotonic() + PATIENCE
        before = len(self.shown)
        while not re.search(pattern, self.shown[before:]):
            ready, _, _ = select.select([self._master], [], [], end - time.monotonic())
            assert ready, self.shown
            self.shown += os.read(self._master, 4096).decode()

    def type(self, text: str) -> None:
        """Type a line."""
        os.write(self._master, f"{text}\n".encode())

    def end(self) -> int:
        """Wait for the end; return the exit code."""
        try:
            while more := os.read(self._master, 4096):
                self.shown += more.decode()
        except OSError:  # the terminal of a command that has ended
            pass
        os.close(self._master)
        return self.process.wait(PATIENCE)


def arguments_of_all_processes() -> str:
    found = []
    for process in os.listdir("/proc"):  # noqa: PTH208
        if process.isdigit():
            try:
                with open(f"/proc/{process}/cmdline", "rb") as file:  # noqa: PTH123
                    found.append(file.read().replace(b"\0", b" ").decode(errors="replace"))
            except OSError:
                continue
    return "\n".join(found)


def test_the_first_day(new_lab: Lab) -> None:
    lab = new_lab
    lab.robots[2].set_password_login(on=False)
    terminal = Terminal(lab, ["fleet", "key", "--no-passphrase"])
    for robot in lab.robots:
        listed = ["ssh-keygen", "-lf", str(robot.folder / "host_key.pub")]
        own = subprocess.run(listed, capture_output=True, text=True, check=True).stdout.split()[1]
        terminal.until(rf"{robot.name} .* host key {re.escape(own)}[\s\S]*Are they the same")
        terminal.type("yes")
    terminal.until("Password of pioneer@p3at-1, pioneer@p3at-2, pioneer@p3at-3 .*: ")
    terminal.type(PASSWORD)
    while terminal.process.poll() is None and "works" not in terminal.shown:
        assert PASSWORD not in arguments_of_all_processes()
        terminal.until(".")
    assert terminal.end() == 1, terminal.shown
    assert terminal.shown.count("the key is installed, and works") == 2
    words = " ".join(terminal.shown.split())
    assert "pioneer@192.168.1.113: wrong password, or logins with one are switched off" in words
    assert "p3at-1, p3at-2: passwords let people in, too" in words
    assert "sudo tee /etc/ssh/sshd_config.d/10-keys-only.conf" in words
    assert PASSWORD not in terminal.shown
    done = lab.operator.p3("fleet", "run", "--on", "front", "cat .ssh/authorized_keys | wc -l")
    assert sorted(done.stdout.splitlines()) == ["p3at-1 | 1", "p3at-2 | 1"]
    for folder in (lab.operator.folder, *(robot.folder for robot in lab.robots)):
        for path in folder.rglob("*"):
            assert not path.is_file() or PASSWORD.encode() not in path.read_bytes()
    ssh = ["ssh", "-o", "BatchMode=yes", "pioneer@192.168.1.111", "true"]
    subprocess.run([*lab.operator.inside, *ssh], env=lab.operator.environment, check=True)


def test_again_it_installs_nothing_and_asks_nothing(lab: Lab) -> None:
    robot = lab.robots[0]
    authorized = robot.user_home / ".ssh/authorized_keys"
    authorized.write_text(f"# mine\n{authorized.read_text().strip()}")
    before = authorized.read_text()
    done = lab.operator.p3("fleet", "key")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("the key was installed before") == 3
    assert authorized.read_text() == before


def test_a_key_is_added_to_those_of_others(new_lab: Lab) -> None:
    lab = new_lab
    other = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIOtherOtherOtherOtherOtherOtherOtherOther other"
    lab.robots[0].authorize(other)  # without the end of its line
    mine = lab.operator.make_key().strip()
    terminal = Terminal(lab, ["fleet", "key", "p3at-1", "--accept-new"])
    terminal.until("Password of pioneer@p3at-1 .*: ")
    terminal.type(PASSWORD)
    assert terminal.end() == 0, terminal.shown
    authorized = lab.robots[0].user_home / ".ssh/authorized_keys"
    assert authorized.read_text() == f"{other}\n{mine}\n"


def test_wrong_answers_leave_everything_as_it_is(new_lab: Lab) -> None:
    lab = new_lab
    terminal = Terminal(lab, ["fleet", "key", "--on", "front", "--no-passphrase"])
    terminal.until("Are they the same")
    terminal.type("no")
    terminal.until("p3at-2[\\s\\S]*Are they the same")
    terminal.type("yes")
    terminal.until("Password of pioneer@p3at-2 .*: ")
    terminal.type("wrong horse")
    assert terminal.end() == 1
    assert "its host key was not accepted; nothing was installed" in terminal.shown
    assert "pioneer@192.168.1.112: wrong password" in terminal.shown
    known = lab.operator.known_hosts.read_text()
    assert "192.168.1.111" not in known
    assert lab.operator.known_hosts.stat().st_mode & 0o777 == 0o600
    assert not (lab.robots[0].user_home / ".ssh/authorized_keys").exists()


def test_a_changed_host_key_is_an_error_even_with_accept_new(lab: Lab) -> None:
    lab.robots[0].new_host_key()
    known = lab.operator.known_hosts.read_text()
    done = lab.operator.p3("fleet", "key", "p3at-1", "--accept-new")
    assert "ANOTHER COMPUTER" in " ".join(done.stderr.split())
    assert done.returncode == 3
    assert lab.operator.known_hosts.read_text() == known


def test_ctrl_c_at_the_password_gives_the_terminal_back(lab: Lab) -> None:
    (lab.robots[0].user_home / ".ssh/authorized_keys").unlink()
    terminal = Terminal(lab, ["fleet", "key", "p3at-1"])
    terminal.until("Password of .*: ")
    time.sleep(0.2)
    terminal.process.send_signal(2)
    assert terminal.end() == 130


@pytest.fixture
def agent(new_lab: Lab) -> Iterator[Lab]:
    """A lab whose operator has a key with a passphrase in an agent, and no longer in a file."""
    lab, home = new_lab, new_lab.operator.home
    key, answer, socket = home / ".ssh/id_ed25519", home / "answer", home / "agent"
    lab.operator.make_key()
    change = ["ssh-keygen", "-q", "-p", "-P", "", "-N", "a secret", "-f", str(key)]
    subprocess.run(change, check=True, capture_output=True)
    answer.write_text("#!/bin/sh\necho a secret\n")
    answer.chmod(0o755)
    with subprocess.Popen(["ssh-agent", "-D", "-a", socket], stdout=subprocess.DEVNULL) as process:
        while not socket.exists():
            time.sleep(0.02)
        lab.operator.more = {"SSH_AUTH_SOCK": str(socket)}
        asking = {"SSH_ASKPASS": str(answer), "SSH_ASKPASS_REQUIRE": "force", "DISPLAY": ":0"}
        environment = lab.operator.environment | asking
        subprocess.run(["ssh-add", key], env=environment, check=True, capture_output=True)
        key.unlink()
        yield lab
        process.terminate()


def test_a_key_in_the_agent_alone_is_installed_and_used(agent: Lab) -> None:
    public = agent.operator.home / ".ssh/id_ed25519.pub"
    body = public.read_text().split()[1]
    public.unlink()
    terminal = Terminal(agent, ["fleet", "key", "p3at-1", "--accept-new"])
    terminal.until("Password of pioneer@p3at-1 .*: ")
    terminal.type(PASSWORD)
    assert terminal.end() == 0, terminal.shown
    authorized = agent.robots[0].user_home / ".ssh/authorized_keys"
    assert authorized.read_text().split()[:2] == ["ssh-ed25519", body]
    assert not public.exists()
