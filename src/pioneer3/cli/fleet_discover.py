"""`pioneer3 fleet discover`."""

from importlib.util import find_spec
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, FleetFile, Seconds, fleet_if_any
from pioneer3.cli.process import (
    busy_sign,
    until_told_to_leave,
    write_json,
    write_line,
    write_warning,
)
from pioneer3.distribution import how_to_get


@until_told_to_leave
async def discover(
    *addresses: Annotated[str, Parameter(negative=(), metavar="ADDRESS")],
    fleet: FleetFile = None,
    seconds: Seconds = 2.0,
    no_broadcast: Flag = False,
    json: Flag = False,
) -> int:
    """Find robots, simulators and on-board computers; print them as lines of a file.

    All of the network are asked: announced robots (zeroconf), and the serial
    bridges of Pioneer robots. At the addresses given it looks for robots at TCP
    ports 8101 to 8120, and for ssh. A robot that answers is asked for its name by
    a short session; nothing moves. Rows of the fleet file are left out. The
    exit code is 3 if nothing was found.

    Example: pioneer3 fleet discover
    Example: pioneer3 fleet discover 192.168.1.0/24

    Args:
        addresses: Where to look: 192.168.1.113, or a network such as 192.168.1.0/24.
        seconds: How long to wait for answers.
        no_broadcast: Look at the addresses alone.
        json: Print JSON for programs: one array of all that was found.
    """
    from pioneer3.fleet.discovery import addresses_in, offers
    from pioneer3.fleet.discovery import discover as find

    if not no_broadcast and find_spec("zeroconf") is None:
        write_warning(f"announcements are not heard: {how_to_get('fleet')}")
    targets = addresses_in(addresses)
    known = fleet_if_any(fleet)

    where = f" and {len(targets)} addresses" if targets else ""
    with busy_sign(f"Looking in the network{where} ..."):
        found = await find(targets, seconds=seconds, broadcast=not no_broadcast)
    if json:
        write_json(found, indent=2)
        return 0 if found else 3
    if not found:
        write_warning(
            "nothing was found; name addresses, such as pioneer3 fleet discover 192.168.1.0/24"
        )
        return 3
    lines = list(offers(found, known))
    if not lines:
        write_line(f"# all {len(found)} that were found are in the fleet file already")
    for line in lines:
        write_line(line)
    return 0
