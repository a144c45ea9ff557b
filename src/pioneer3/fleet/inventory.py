"""The fleet file: robots, their computers, the operator's computer, and groups of robots.

:func:`read_fleet` checks every field; an error names file, line and key.
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.fleet import checks
from pioneer3.fleet.network import check_networks
from pioneer3.fleet.spec import ALL, Defaults, Fleet, Operator, Robot
from pioneer3.maps.text import decoded, read_bytes
from pioneer3.tables import Source, converted, load, written

__all__ = [
    "ALL",
    "Defaults",
    "Fleet",
    "Operator",
    "Robot",
    "find_fleet",
    "parse_fleet",
    "read_fleet",
    "to_toml",
]

FILE: Final = "fleet.toml"
VARIABLE: Final = "PIONEER3_FLEET"
LARGEST_FLEET: Final = 1 << 20
"""Larger files are not read [bytes]."""


def find_fleet(
    given: Path | None, *, environment: Mapping[str, str], here: Path, home: Path
) -> Path:
    """Return the path of the fleet file.

    Args:
        given: The option `--fleet`.
        environment: Variables; `PIONEER3_FLEET` names the file where the option does not.
        here: The folder that is looked in next.
        home: The user's folder, below which `.config/pioneer3/fleet.toml` comes last.

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
    """Read a fleet file.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file, line and key.
    """
    return parse_fleet(path, decoded(read_bytes(path, LARGEST_FLEET, kind="fleet")))


def parse_fleet(path: Path, text: str) -> Fleet:
    """Read the text of a fleet file; paths of models in it are relative to its folder.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    from pioneer3.fleet.schema import FileTable  # imports msgspec

    source = Source.of(path, text)
    file = converted(source, load(path, text), FileTable)
    operator = file.operator.operator() if file.operator else Operator()
    defaults = file.defaults.defaults() if file.defaults else Defaults()
    lines = (source.line(f"robot[{index}]") or 0 for index in range(len(file.robot)))
    robots = tuple(
        table.robot(defaults, line) for table, line in zip(file.robot, lines, strict=True)
    )
    checks.check_operator(source, operator)
    checks.check_hardware(source, "defaults", path.parent, defaults)
    networks = tuple(table.network() for table in file.network)
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
    from pioneer3.fleet.schema import FileTable  # imports msgspec

    return written(FileTable.of(fleet))
