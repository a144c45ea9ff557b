"""The fleet file: robots, their computers, the operator's computer, and groups of robots.

:func:`read_fleet` checks every field; an error names file, line and key.
"""

import socket
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.fleet import checks
from pioneer3.fleet.network import FleetNetwork, check_networks
from pioneer3.fleet.spec import Defaults, Fleet, FleetRobot, OperatorComputer, usual
from pioneer3.links.hosts import SOMEWHERE, address_towards
from pioneer3.tables import Source, converted, keys, load, table_of, written
from pioneer3.text import decoded, read_bytes, shown

FILE: Final = "fleet.toml"
VARIABLE: Final = "PIONEER3_FLEET"
LARGEST_FLEET: Final = 1 << 20
"""Larger files are not read [bytes]."""


def find_fleet(
    given: Path | None, *, environment: Mapping[str, str], here: Path, home: Path
) -> Path:
    """Return the path of the fleet file: `given`, that of the variable, or one of two places.

    `here` comes before `home`, in which it is `.config/pioneer3/fleet.toml`.

    Raises:
        ConfigError: There is none; says how to make one.
    """
    if given is not None:
        return given
    if named := environment.get(VARIABLE):
        return Path(named)
    places = (here / FILE, home / ".config/pioneer3" / FILE)
    for place in places:
        if place.exists():
            return place
    raise ConfigError(
        f"no fleet file: {' and '.join(map(str, places))} are missing; make one with "
        "pioneer3 fleet init, or name one with --fleet FILE"
    )


def read_fleet(path: Path) -> Fleet:
    """Read a fleet file; ConfigError, with file, line and key, if it is wrong or cannot be read."""
    return parse_fleet(path, decoded(read_bytes(path, LARGEST_FLEET, kind="fleet")))


def parse_fleet(path: Path, text: str) -> Fleet:
    """Read the text of a fleet file; paths of models in it are relative to its folder.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    source = Source.of(path, text)
    file = converted(source, load(source), _Tables)
    operator, defaults, networks = file.operator, file.defaults, file.network
    robots = tuple(_robot(source, *row, defaults) for row in enumerate(file.robot))
    if operator.address:
        checks.check_address(source, "operator.address", operator.address)
    checks.check_hardware(source, "defaults", path.parent, defaults)
    check_networks(source, networks)
    checks.check_members(source, networks, defaults, robots)
    checks.check_robots(source, path.parent, robots)
    checks.refuse_doubles(source, operator, robots)
    return Fleet(
        path=path,
        operator=operator,
        defaults=defaults,
        networks=networks,
        robots=robots,
        groups=MappingProxyType(checks.groups(source, file.groups, robots)),
    )


def to_toml(fleet: Fleet) -> str:
    """Return the text of a fleet file; defaults are left out."""
    tables = {
        "operator": table_of(fleet.operator),
        "defaults": table_of(fleet.defaults),
        "network": [table_of(network) for network in fleet.networks],
        "robot": [_table(robot, fleet.defaults) for robot in fleet.robots],
        "groups": dict(fleet.groups),
    }
    return written({name: table for name, table in tables.items() if table})


@dataclass(frozen=True, slots=True, kw_only=True)
class _Tables:
    """All tables of a fleet file; :mod:`pioneer3.fleet.checks` checks the groups."""

    operator: OperatorComputer = field(default_factory=OperatorComputer)
    defaults: Defaults = field(default_factory=Defaults)
    network: tuple[FleetNetwork, ...] = ()
    robot: tuple[dict[str, object], ...] = ()
    groups: dict[str, object] = field(default_factory=dict)


def _robot(source: Source, index: int, table: Mapping[str, Any], defaults: Defaults) -> FleetRobot:
    """Return the robot of a table, with the usual values of keys that it does not give."""
    place = f"robot[{index}]"
    robot = converted(source, table, FleetRobot, place)
    port, ros = table.get("port", defaults.port), table.get("ros", defaults.ros)
    robot = replace(robot, port=port, ros=ros, line=source.line(place) or 0)
    missing = {key: value for key, value in usual(robot, defaults).items() if key not in table}
    return replace(robot, **missing)


def _table(robot: FleetRobot, defaults: Defaults) -> dict[str, object]:
    """Return the table of a robot, without usual values."""
    known = usual(robot, defaults)
    values = {key: getattr(robot, key) for key in keys(FleetRobot)}
    given = [key for key, value in values.items() if value != known.get(key, "")]
    written_out = table_of(robot)
    return {key: written_out.get(key, values[key]) for key in given}


def robot_of(word: str, defaults: Defaults) -> FleetRobot:
    """Read `NAME=ADDRESS`, such as `p3at-1=192.168.1.113`; ConfigError if it is not that."""
    name, equals, address = (part.strip() for part in word.partition("="))
    if not (name and equals and address):
        raise ConfigError(f"{shown(word)}: expected NAME=ADDRESS, such as p3at-1=192.168.1.113")
    robot = FleetRobot(name=name, address=address, port=defaults.port, ros=defaults.ros)
    return replace(robot, **usual(robot, defaults))


def draft(
    path: Path, operator: OperatorComputer, defaults: Defaults, robots: Sequence[str]
) -> Fleet:
    """Return a new fleet of robots, each as `NAME=ADDRESS`; raises as :func:`parse_fleet` does."""
    given = tuple(robot_of(word, defaults) for word in robots)
    fleet = Fleet(path=path, operator=operator, defaults=defaults, robots=given)
    return parse_fleet(path, to_toml(fleet))


def here(robots: Sequence[str]) -> OperatorComputer:
    """Return this computer: its name, and the address that the first of `robots` sees.

    The address is empty if it is a robot's: simulated robots are on this computer. A network
    without a router has no other hint than these `NAME=ADDRESS`.
    """
    addresses = [word.partition("=")[2].strip() for word in robots]
    own = ""
    with suppress(OSError):  # no network leads there, or it is no address
        own = address_towards(next(iter(addresses), SOMEWHERE))
    name = socket.gethostname().partition(".")[0]
    return OperatorComputer(name=name, address="" if own in addresses else own)
