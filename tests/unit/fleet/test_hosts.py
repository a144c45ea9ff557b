"""/etc/hosts: what is wrong with the names of a fleet, and how it is mended."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pioneer3.doctor.facts import Level
from pioneer3.errors import ConfigError
from pioneer3.fleet.hosts import check_hosts, entries, with_entries
from pioneer3.fleet.inventory import parse_fleet

FLEET = parse_fleet(
    Path("fleet.toml"),
    """\
[operator]
name = "laptop"
address = "192.168.1.10"
[[robot]]
name = "p3at-1"
address = "192.168.1.113"
[[robot]]
name = "p3at-2"
host = "p3at-2.local"
address = "192.168.1.114"
""",
)
DEBIAN = """\
127.0.0.1\tlocalhost
127.0.1.1\tlaptop.lab laptop  # by the installer
# The following lines are for IPv6
::1     localhost ip6-localhost ip6-loopback
192.168.1.9 printer
"""
BLOCK = """\
# BEGIN pioneer3 fleet
192.168.1.10\tlaptop
192.168.1.113\tp3at-1
192.168.1.114\tp3at-2.local p3at-2
# END pioneer3 fleet
"""


def found(text: str, name: str = "laptop") -> list[tuple[str, Level, str]]:
    return [(f.check, f.level, f.found) for f in check_hosts(text, FLEET, name)]


def test_operator_and_robots_have_an_entry_each() -> None:
    assert "".join(f"{entry}\n" for entry in entries(FLEET)) in BLOCK


def test_a_fresh_installation_is_told_what_it_lacks() -> None:
    assert found(DEBIAN) == [
        ("own name", Level.FAIL, "line 2: laptop means this computer itself, and nothing else"),
        ("missing", Level.FAIL, "p3at-1 at 192.168.1.113"),
        ("missing", Level.FAIL, "p3at-2.local and p3at-2 at 192.168.1.114"),
    ]


def test_after_the_change_all_is_well_and_other_lines_are_as_before() -> None:
    mended = with_entries(DEBIAN, FLEET)
    assert mended == DEBIAN.replace("laptop.lab laptop", "laptop.lab") + "\n" + BLOCK
    assert found(mended) == []
    assert found(mended, "p3at-2") == []
    assert with_entries(mended, FLEET) == mended


@pytest.mark.parametrize(
    ("line", "check", "said"),
    [
        ("192.168.1.77 p3at-1", "other address", "p3at-1 is 192.168.1.77; in the fleet 192.168.1."),
        ("192.168.1.113 p3at-1", "double", "192.168.1.113 on lines "),
    ],
)
def test_what_contradicts_the_fleet_is_told_and_removed(line: str, check: str, said: str) -> None:
    text = f"{line}\n{BLOCK}{line}\n"
    assert any(one[0] == check and said in one[2] for one in found(text))
    mended = with_entries(text, FLEET)
    assert mended == f"# {line}\n{BLOCK}# {line}\n"
    assert found(mended) == []


def test_an_address_with_another_name_is_told() -> None:
    text = f"192.168.1.113 old-name\n{BLOCK}"
    assert ("reverse", Level.WARN, "192.168.1.113 is old-name here, p3at-1 in the fleet") in (
        found(text)
    )


def test_a_computer_of_no_fleet_is_told() -> None:
    ((check, level, said),) = found(BLOCK, "somebody")
    assert (check, level) == ("this computer", Level.WARN)
    assert "its name is somebody" in said


def test_a_robot_that_left_the_fleet_leaves_the_block() -> None:
    fewer = parse_fleet(Path("f.toml"), '[[robot]]\nname = "p3at-1"\naddress = "192.168.1.113"\n')
    text = f"127.0.0.1 localhost\n{BLOCK}# after\n"
    assert with_entries(text, fewer) == (
        "127.0.0.1 localhost\n# BEGIN pioneer3 fleet\n192.168.1.113\tp3at-1\n"
        "# END pioneer3 fleet\n# after\n"
    )


def test_a_block_without_an_end_is_left_alone() -> None:
    with pytest.raises(ConfigError, match="has no line `# END pioneer3 fleet`"):
        with_entries(BLOCK.replace("# END pioneer3 fleet\n", ""), FLEET)


def may_mount() -> bool:
    if os.name != "posix" or not shutil.which("unshare") or not shutil.which("getent"):
        return False
    tried = subprocess.run(["unshare", "--mount", "true"], capture_output=True, check=False)
    return tried.returncode == 0


@pytest.mark.realtime
@pytest.mark.skipif(not may_mount(), reason="mount namespaces need root, and unshare and getent")
def test_the_system_finds_all_names_where_the_file_is_mounted_as_in_containers(
    tmp_path: Path,
) -> None:
    (tmp_path / "hosts").write_text(DEBIAN)
    (tmp_path / "fleet.toml").write_text(
        '[operator]\nname = "laptop"\naddress = "192.168.1.10"\n'
        '[[robot]]\nname = "p3at-1"\naddress = "192.168.1.113"\n'
    )
    script = f"""
    set -e
    cp -a /etc etc
    rm -f etc/hosts.before-fleet-*
    mount --bind etc /etc
    mount --bind hosts /etc/hosts
    {sys.executable} -m pioneer3 fleet hosts --apply --name laptop --fleet fleet.toml >said
    getent hosts laptop p3at-1 192.168.1.113 laptop.lab
    cat /etc/hosts.before-fleet-1
    """
    done = subprocess.run(
        ["unshare", "--mount", "sh", "-c", script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert [line.split() for line in lines[:4]] == [
        ["192.168.1.10", "laptop"],
        ["192.168.1.113", "p3at-1"],
        ["192.168.1.113", "p3at-1"],
        ["127.0.1.1", "laptop.lab"],
    ]
    assert "\n".join(lines[4:]) + "\n" == DEBIAN
    assert "+192.168.1.113\tp3at-1" in (tmp_path / "said").read_text()
