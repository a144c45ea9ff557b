"""A new fleet file: made of a few words, checked before it is written."""

import socket
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.fleet.inventory import parse_fleet, to_toml
from pioneer3.fleet.reach import address_towards
from pioneer3.fleet.spec import Defaults, Fleet, Operator, Robot, usual
from pioneer3.text import shown

DOCUMENTATION_ADDRESS = "192.0.2.1"
"""An address that no computer has (RFC 5737)."""


def robot_of(word: str, defaults: Defaults) -> Robot:
    """Read `NAME=ADDRESS`, such as `p3at-1=192.168.1.113`.

    Raises:
        ConfigError: It is not that.
    """
    name, equals, address = (part.strip() for part in word.partition("="))
    if not (name and equals and address):
        raise ConfigError(f"{shown(word)}: expected NAME=ADDRESS, such as p3at-1=192.168.1.113")
    robot = Robot(name=name, address=address, port=defaults.port, ros=defaults.ros)
    return replace(robot, **usual(robot, defaults))


def draft(path: Path, operator: Operator, defaults: Defaults, robots: Sequence[str]) -> Fleet:
    """Return a new fleet, checked as a file is.

    Args:
        path: Of the file to be.
        operator: This computer.
        defaults: Of all robots.
        robots: `NAME=ADDRESS` of each.

    Raises:
        ConfigError: Something of it is wrong.
    """
    given = tuple(robot_of(word, defaults) for word in robots)
    fleet = Fleet(path=path, operator=operator, defaults=defaults, robots=given)
    return parse_fleet(path, to_toml(fleet))


def here(robots: Sequence[str]) -> Operator:
    """Return this computer: its name, and the address that the first of `robots` sees.

    The address is empty if it is a robot's: simulated robots are on this computer.

    Args:
        robots: `NAME=ADDRESS` of each; a network without a router has no other hint.
    """
    addresses = [word.partition("=")[2].strip() for word in robots]
    own = address_towards(next(iter(addresses), DOCUMENTATION_ADDRESS))
    name = socket.gethostname().partition(".")[0]
    return Operator(name=name, address="" if own in addresses else own)
