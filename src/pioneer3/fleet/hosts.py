"""The names of a fleet in /etc/hosts: entries for all its computers, and mistakes there.

Every computer of a fleet needs the same entries: a ROS node tells the others its host's name, and
whoever cannot turn that into an address receives nothing.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from pioneer3.doctor.facts import Finding, failure, warning
from pioneer3.fleet.edit import with_block
from pioneer3.fleet.spec import Fleet
from pioneer3.links.hosts import is_loopback

_LINE: Final = re.compile(r"(\s*)([^\s#]+)([ \t]+)([^#]*?)([ \t]*)(#.*)?$")


@dataclass(frozen=True, slots=True)
class HostsEntry:
    """A line of a hosts file: an address and its names, the first of which is the usual one."""

    address: str
    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.address}\t{' '.join(self.names)}"


@dataclass(frozen=True, slots=True)
class HostsSituation:
    """A fleet, the name of this computer, and the entries of its hosts file by line numbers."""

    fleet: Fleet
    name: str
    lines: tuple[tuple[int, HostsEntry], ...]

    def having(self, name: str) -> tuple[tuple[int, HostsEntry], ...]:
        """Return the entries with a name."""
        return tuple((at, e) for at, e in self.lines if name.lower() in map(str.lower, e.names))


def entries(fleet: Fleet) -> tuple[HostsEntry, ...]:
    """Return the entries for the operator's computer and all robots'."""
    operator = fleet.operator
    first = (
        (HostsEntry(operator.address, (operator.name,)),)
        if operator.name and operator.address
        else ()
    )
    return first + tuple(
        HostsEntry(robot.address, tuple(dict.fromkeys((robot.host, robot.name))))
        for robot in fleet.robots
    )


def with_entries(text: str, fleet: Fleet) -> str:
    """Return the text of a hosts file with the entries of a fleet as a block.

    The fleet's names are taken from other lines, and a line without names becomes a comment. Raises
    ConfigError if an earlier block has lost its end.
    """
    wanted = entries(fleet)
    names = {name.lower() for entry in wanted for name in entry.names}
    block = with_block("", [str(entry) for entry in wanted])
    cleaned = with_block(text, [str(entry) for entry in wanted]).partition(block)
    return _without(cleaned[0], names) + cleaned[1] + _without(cleaned[2], names)


def check_hosts(text: str, fleet: Fleet, name: str) -> tuple[Finding, ...]:
    """Return the findings about the text of a hosts file, which is of the computer `name`."""
    situation = HostsSituation(fleet, name.partition(".")[0], tuple(_entries_in(text)))
    return tuple(finding for check in CHECKS for finding in check(situation))


def _own_name(here: HostsSituation) -> Iterator[Finding]:
    """Look whether this computer is of the fleet, and which addresses its own name leads to."""
    known = {name.lower(): e for e in entries(here.fleet) for name in e.names}
    mine = known.get(here.name.lower())
    if mine is None:
        yield warning(
            check="this computer",
            found=f"its name is {here.name}, which is no computer of {here.fleet.path}",
            advice="name it there, as the operator or a robot; or run this on one of them",
        )
        return
    own = here.having(here.name)
    local = [at for at, entry in own if is_loopback(entry.address)]
    if local and len(local) == len(own) and not is_loopback(mine.address):
        yield failure(
            check="own name",
            found=f"line {local[0]}: {here.name} means this computer itself, and nothing else",
            meaning="ROS tells others the address behind the own name: they would call themselves.",
            advice=f"{mine.address} must be its address: pioneer3 fleet hosts --apply",
        )


def _missing(here: HostsSituation) -> Iterator[Finding]:
    """Look for computers without an entry, and for addresses that lead back to another name."""
    for entry in entries(here.fleet):
        found = [one for _, one in here.lines if one.address == entry.address]
        absent = [name for name in entry.names if not here.having(name)]
        if absent:
            yield failure(
                check="missing",
                found=f"{' and '.join(absent)} at {entry.address}",
                meaning="A computer that cannot be found by its name gets no messages of ROS.",
                advice="pioneer3 fleet hosts --apply",
            )
        elif found and found[0].names[0].lower() not in map(str.lower, entry.names):
            yield warning(
                check="reverse",
                found=f"{entry.address} is {found[0].names[0]} here, {entry.names[0]} in the fleet",
                meaning="Whoever asks for the name of this address is told the other one.",
                advice=f"remove {found[0].names[0]}, or name it as the host in {here.fleet.path}",
            )


def _elsewhere(here: HostsSituation) -> Iterator[Finding]:
    """Look for names at another address than the fleet's."""
    for entry in entries(here.fleet):
        for name in entry.names:
            others = [
                (at, one.address)
                for at, one in here.having(name)
                if one.address != entry.address and not is_loopback(one.address)
            ]
            for at, address in others:
                yield failure(
                    check="other address",
                    found=f"line {at}: {name} is {address}; in the fleet {entry.address}",
                    meaning="The first line with a name counts.",
                    advice="pioneer3 fleet hosts --apply, or mend the fleet file",
                )


def _doubles(here: HostsSituation) -> Iterator[Finding]:
    """Look for fleet addresses on several lines."""
    for entry in entries(here.fleet):
        lines = [at for at, one in here.lines if one.address == entry.address]
        if len(lines) > 1:
            yield warning(
                check="double",
                found=f"{entry.address} on lines {', '.join(map(str, lines))}",
                advice="one line with all its names is enough",
            )


CHECKS: Final[tuple[Callable[[HostsSituation], Iterator[Finding]], ...]] = (
    _own_name,
    _missing,
    _elsewhere,
    _doubles,
)


def _entries_in(text: str) -> Iterator[tuple[int, HostsEntry]]:
    for number, line in enumerate(text.split("\n"), 1):
        address, *names = line.partition("#")[0].split() or [""]
        if names:
            yield number, HostsEntry(address, tuple(names))


def _without(text: str, names: set[str]) -> str:
    """Return lines of a hosts file without some names."""
    return "\n".join(_line_without(line, names) for line in text.split("\n"))


def _line_without(line: str, names: set[str]) -> str:
    matched = _LINE.match(line)
    if not matched or line.lstrip().startswith("#"):
        return line
    lead, address, gap, named, tail, comment = matched.groups()
    kept = [name for name in named.split() if name.lower() not in names]
    if len(kept) == len(named.split()):
        return line
    if not kept:
        return f"# {line}"
    return f"{lead}{address}{gap}{' '.join(kept)}{tail}{comment or ''}"
