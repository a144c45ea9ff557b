"""ssh p3at-1 reaches the robot; ssh itself says so, where it is installed."""

import shutil
import subprocess
from pathlib import Path

import pytest

from pioneer3.fleet.inventory import parse_fleet
from pioneer3.fleet.ssh_config import (
    INCLUDE,
    INCLUDED,
    aliases,
    ssh_hosts,
    with_aliases,
    with_include,
)

FLEET = parse_fleet(
    Path("lab/fleet.toml"),
    """\
[[robot]]
name = "p3at-1"
host = "cr-246-1"
address = "192.168.1.113"
[[robot]]
name = "p3at-2"
address = "192.168.1.114"
user = "robot"
[[robot]]
name = "p3at-3"
address = "192.168.2.114"
[[robot]]
name = "p3at-4"
address = "fd00::7"
""",
)


def test_every_robot_has_a_section() -> None:
    text = ssh_hosts(FLEET)
    assert "Host p3at-1 cr-246-1\n    HostName 192.168.1.113\n    User pioneer\n" in text
    assert "Host p3at-2\n    HostName 192.168.1.114\n    User robot\n" in text


@pytest.mark.parametrize(
    "text", ["", "Host *\n    ForwardAgent no\n", "# mine\n", "Include other\n", "\n\nHost a\n"]
)
def test_the_file_is_included_once_and_before_all_sections(text: str) -> None:
    included = with_include(text, Path("/home/me/.ssh"))
    assert included.startswith(f"{INCLUDE}\n")
    assert included.endswith(text)
    assert with_include(included, Path("/home/me/.ssh")) == included


@pytest.mark.parametrize(
    "line",
    ["Include config.d/*", "include  config.d/pioneer3", "Include /home/me/.ssh/config.d/pion*"],
)
def test_a_file_that_is_included_already_is_not_included_again(line: str) -> None:
    text = f"# mine\n{line}\n"
    assert with_include(text, Path("/home/me/.ssh")) == text


def test_an_include_of_one_host_alone_does_not_count() -> None:
    text = "Host a\n    Include config.d/*\n"
    assert with_include(text, Path("/home/me/.ssh")) == f"{INCLUDE}\n\n{text}"


@pytest.mark.skipif(not shutil.which("ssh"), reason="ssh is not installed")
def test_ssh_understands_it(tmp_path: Path) -> None:
    (tmp_path / INCLUDED).parent.mkdir()
    (tmp_path / INCLUDED).write_text(ssh_hosts(FLEET))
    # a relative name is one below ~/.ssh, which is not here
    included = with_include("Host *\n    User nobody\n", tmp_path).replace(
        INCLUDED, str(tmp_path / INCLUDED)
    )
    config = tmp_path / "config"
    config.write_text(included)
    said = subprocess.run(
        ["ssh", "-G", "-F", str(config), "p3at-2"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert "hostname 192.168.1.114" in said
    assert "user robot" in said


def test_the_last_number_of_an_address_opens_ssh_where_it_is_the_only_one() -> None:
    assert aliases(FLEET) == (
        "alias CR_113='ssh pioneer@192.168.1.113'",
        "alias CR_p3at_2='ssh robot@192.168.1.114'",
        "alias CR_p3at_3='ssh pioneer@192.168.2.114'",
        "alias CR_p3at_4='ssh pioneer@fd00::7'",
    )


def test_a_shell_understands_the_aliases() -> None:
    script = with_aliases("# mine\n", FLEET, "R") + "alias R113\n"
    said = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=True).stdout
    assert "ssh pioneer@192.168.1.113" in said
