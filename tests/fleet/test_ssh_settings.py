"""Settings of `~/.ssh/config` count for `pioneer3 fleet`, as they do for `ssh`."""

import subprocess

import pytest

from tests.fleet.lab import OPERATOR_ADDRESS, Lab

pytestmark = pytest.mark.realtime
CONFIG = """\
Host p3at-1
    Port 2222
Host p3at-2
    HostKeyAlias second
Host p3at-3
    ProxyJump pioneer@192.168.1.112
"""


def test_port_alias_and_jump_are_those_of_ssh(lab: Lab) -> None:
    first, second, third = lab.robots
    (lab.operator.home / ".ssh/config").write_text(CONFIG)
    lab.operator.known_hosts.write_text(
        f"[{first.address}]:2222 {first.host_key}\n"
        f"second {second.host_key}\n"
        f"{second.address} {second.host_key}\n"
        f"{third.address} {third.host_key}\n"
    )
    config = first.folder / "sshd_config"
    config.write_text("Port 2222\nPort 22\n" + config.read_text())
    first.restart_sshd()
    done = lab.operator.p3("fleet", "run", 'echo "from $SSH_CONNECTION"')
    assert done.returncode == 0, done.stderr
    said = dict(line.split(" | from ") for line in done.stdout.splitlines())
    assert said[first.name].endswith("192.168.1.111 2222")
    assert said[second.name].startswith(OPERATOR_ADDRESS)
    assert said[third.name].startswith(second.address)


def test_a_new_host_key_is_kept_under_the_name_that_ssh_asks_for(new_lab: Lab) -> None:
    robot = new_lab.robots[1]
    robot.authorize(new_lab.operator.make_key())
    (new_lab.operator.home / ".ssh/config").write_text(CONFIG)
    done = new_lab.operator.p3("fleet", "key", "p3at-2", "--accept-new")
    assert done.returncode == 0, done.stderr
    (line,) = new_lab.operator.known_hosts.read_text().splitlines()
    assert line.endswith(robot.host_key)
    words = ["ssh", "-o", "BatchMode=yes", "-o", "User=pioneer", "-o", f"HostName={robot.address}"]
    ssh = subprocess.run(
        [*new_lab.operator.inside, *words, "p3at-2", "hostname"],
        capture_output=True,
        text=True,
        env=new_lab.operator.environment,
        timeout=60,
        check=False,
    )
    assert ssh.stdout.strip() == "p3at-2", ssh.stderr
