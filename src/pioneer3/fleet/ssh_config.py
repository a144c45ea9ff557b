"""Short ways to the robots' computers: an include file of ssh, and aliases of a shell."""

import re
from collections import Counter
from pathlib import Path
from typing import Final

from pioneer3.fleet.edit import with_block
from pioneer3.fleet.spec import Fleet, FleetRobot

INCLUDED: Final = "config.d/pioneer3"
"""Below the folder of ssh."""
INCLUDE: Final = f"Include {INCLUDED}"
PREFIX: Final = "CR_"
"""Prefix of the lab's aliases, such as CR_113."""
_INCLUDES: Final = re.compile(r"^\s*include\s+(.*)$", re.IGNORECASE)
_SECTION: Final = re.compile(r"^\s*(host|match)\s", re.IGNORECASE)


def ssh_hosts(fleet: Fleet) -> str:
    """Return the file that makes `ssh p3at-1` work, whatever /etc/hosts says."""
    head = (
        f"# The robots of {fleet.path.name}, by `pioneer3 fleet ssh-config --apply`;\n"
        "# the next time replaces this file.\n"
    )
    return head + "".join(map(_host, fleet.robots))


def with_include(text: str, folder: Path) -> str:
    """Return the text of ssh's configuration with our file included, before sections of hosts.

    `folder` is that of ssh, `~/.ssh`.
    """
    for line in text.splitlines():
        if _SECTION.match(line):
            break
        if (included := _INCLUDES.match(line)) and any(
            _names(pattern, folder) for pattern in included[1].replace('"', "").split()
        ):
            return text
    return f"{INCLUDE}\n{text}" if text.startswith("\n") or not text else f"{INCLUDE}\n\n{text}"


def aliases(fleet: Fleet, prefix: str = PREFIX) -> tuple[str, ...]:
    """Return an alias for each robot: the last number of its address opens ssh.

    A robot whose number is another one's too, or whose address has no such number, has its name.
    """
    numbers = Counter(_last_number(robot) for robot in fleet.robots)
    return tuple(
        f"alias {prefix}{_short(robot, numbers)}='ssh {robot.user}@{robot.address}'"
        for robot in fleet.robots
    )


def with_aliases(text: str, fleet: Fleet, prefix: str = PREFIX) -> str:
    """Return the start-up file of a shell with the aliases of a fleet as a block."""
    return with_block(text, list(aliases(fleet, prefix)))


def _host(robot: FleetRobot) -> str:
    names = " ".join(dict.fromkeys((robot.name, robot.host)))
    return f"\nHost {names}\n    HostName {robot.address}\n    User {robot.user}\n"


def _names(pattern: str, folder: Path) -> bool:
    """Whether an `Include` of ssh names our file."""
    path = Path(pattern).expanduser()
    return (folder / INCLUDED).match(str(path if path.is_absolute() else folder / path))


def _last_number(robot: FleetRobot) -> str:
    return "" if ":" in robot.address else robot.address.rpartition(".")[2]


def _short(robot: FleetRobot, numbers: "Counter[str]") -> str:
    number = _last_number(robot)
    return number if number and numbers[number] == 1 else robot.name.replace("-", "_")
