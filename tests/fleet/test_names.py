"""Names of the fleet on the operator's computer, with the real ssh and the real resolver."""

import subprocess

import pytest

from tests.fleet.lab import Lab

pytestmark = pytest.mark.realtime


def applied(lab: Lab, command: str) -> str:
    """Run `pioneer3 fleet COMMAND --apply`; return what it said."""
    file = str(lab.operator.home / "fleet.toml")
    done = lab.operator.p3("fleet", command, "--apply", "--fleet", file)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_ssh_finds_a_robot_by_its_name_alone(lab: Lab) -> None:
    applied(lab, "ssh-config")
    lab.operator.sh("echo 127.0.0.1 localhost >/etc/hosts")
    words = ["ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=5", lab.robots[1].name]
    done = subprocess.run(
        [*lab.operator.inside, *words, "hostname; whoami"],
        capture_output=True,
        text=True,
        env=lab.operator.environment,
        timeout=60,
        check=False,
    )
    assert done.stdout.split() == [lab.robots[1].name, "pioneer"], done.stderr


def test_every_computer_finds_all_others_by_their_names(lab: Lab) -> None:
    lab.operator.sh("printf '127.0.0.1 localhost\\n127.0.1.1 laptop\\n' >/etc/hosts")
    said = applied(lab, "hosts")
    assert f"+{lab.robots[0].address}\t{lab.robots[0].name}" in said
    for computer in (lab.operator, *lab.robots):
        found = lab.operator.sh(f"getent hosts {computer.name}")
        assert found.split() == [computer.address, computer.name]
    assert "is so already" in applied(lab, "hosts")
