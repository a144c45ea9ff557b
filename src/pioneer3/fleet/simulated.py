"""The robots of a fleet file as simulated ones."""

from collections.abc import Iterator
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.fleet.reach import model_of, reached_at
from pioneer3.fleet.spec import Fleet
from pioneer3.links.hosts import ANY, is_address, is_loopback, is_own
from pioneer3.sim.worldfile import RobotSpec

USUAL: Final = "p3at"
"""The model of a simulated robot whose row names none."""


def simulated(
    fleet: Fleet, bind: str = "127.0.0.1", *, network: bool = False
) -> tuple[RobotSpec, ...]:
    """Return a robot for each row, with its name, model and TCP port.

    A row listens where others look for it, if this computer has that address: on loopback, and
    elsewhere if `network` allows it; other rows at `bind`. Of rows that would listen at the same
    place, the later ones get the next port. Raises ConfigError if the fleet has no robot.
    """
    if not fleet.robots:
        raise ConfigError(f"{fleet.path}: it has no robot to simulate; add one as [[robot]]")
    return tuple(_specs(fleet, bind, network=network))


def _specs(fleet: Fleet, bind: str, *, network: bool) -> Iterator[RobotSpec]:
    taken: set[tuple[str, int]] = set()
    for robot in fleet.robots:
        endpoint = robot.endpoint and reached_at(fleet, robot.endpoint)
        address, number = endpoint or (robot.address, None)
        host = address if bind not in ANY and _may_listen(address, network=network) else ""
        if number is not None:
            # at all addresses of this computer no number is free twice
            place = ("" if bind in ANY else host or bind, number)
            number = None if place in taken else number
            taken.add(place)
        yield RobotSpec(
            model=model_of(fleet, robot) or USUAL, name=robot.name, port=number, host=host
        )


def _may_listen(host: str, *, network: bool) -> bool:
    """Whether a simulated robot listens at an address; names are not looked up."""
    return is_address(host) and (network or is_loopback(host)) and is_own(host)
