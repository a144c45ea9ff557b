"""Lines for a fleet file, for findings on the network."""

import re
from collections.abc import Iterator, Sequence

from pioneer3.fleet.discovery import Found, Kind
from pioneer3.fleet.spec import Fleet
from pioneer3.models import find_model
from pioneer3.names import printable

_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")


def offers(found: Sequence[Found], fleet: Fleet | None) -> Iterator[str]:
    """Yield lines of a fleet file: a robot for each address that the fleet does not have yet.

    A row is one on-board computer, so of several robots at one address the first gets the row.

    Args:
        found: On the network.
        fleet: The one that there is already; `None` without one.
    """
    known = set(fleet.addresses.values()) if fleet else set()
    known |= {robot.address for robot in fleet.robots} if fleet else set()
    names = {robot.name.lower() for robot in fleet.robots} if fleet else set()
    for address in dict.fromkeys(one.address for one in found if one.address not in known):
        here = [one for one in found if one.address == address]
        ports = [one for one in here if one.port is not None]
        best = (ports or here)[0]
        name = _name(here, address, names)
        names.add(name.lower())
        yield ""
        for one in here:
            where = f" at port {one.port}" if one.port else ""
            told = printable(one.detail or one.name)
            yield f"# {one.kind}{where}: {told}"
        yield "[[robot]]"
        yield f'name = "{name}"'
        yield f'address = "{address}"'
        if best.port is not None:
            host = f"[{address}]" if ":" in address else address
            yield f'port = "tcp://{host}:{best.port}"'
        if best.model and find_model(best.model) is not None:
            yield f'model = "{best.model.strip()}"'


def _name(here: Sequence[Found], address: str, taken: set[str]) -> str:
    """Return a name that no other robot has: that of its computer, else one by its address."""
    told = next((one.name for one in here if one.name and one.kind is not Kind.ROBOT), "")
    usual = f"robot-{re.split(r'[.:]', address)[-1]}"
    made = _host_name(told) or _host_name(usual)
    name, number = made, 1
    while name.lower() in taken | {"all", "localhost"}:
        number += 1
        name = f"{made}-{number}"
    return name


def _host_name(text: str) -> str:
    """Return the part of a text that may be a host name."""
    return _NOT_IN_NAMES.sub("-", text).strip("-")[:40].strip("-")
