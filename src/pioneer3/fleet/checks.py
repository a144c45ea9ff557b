"""The checks of a fleet file that its tables do not make: addresses, ports, doubles, groups."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from ipaddress import ip_address
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import ALL, Defaults, FleetRobot, OperatorComputer
from pioneer3.links.urls import split_host, split_url
from pioneer3.tables import Source, nearest
from pioneer3.text import shown

GROUP = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,61}")
MODEL_FILES = (".toml", ".p")


def check_robots(source: Source, folder: Path, robots: Sequence[FleetRobot]) -> None:
    """Raise ConfigError for the first wrong name, address, port, model, laser or camera.

    Paths of models are relative to `folder`.
    """
    for index, robot in enumerate(robots):
        place = f"robot[{index}]"
        if robot.name.lower() in {ALL, "localhost"}:
            problem = f"{robot.name} means something else; take another name"
            raise source.wrong(f"{place}.name", problem)
        check_address(source, f"{place}.address", robot.address)
        check_hardware(source, place, folder, robot)


def check_members(
    source: Source,
    networks: Sequence[FleetNetwork],
    defaults: Defaults,
    robots: Sequence[FleetRobot],
) -> None:
    """Raise ConfigError for a robot on a network that the file does not have."""
    known = tuple(network.name for network in networks)
    named = [("defaults", defaults.network)]
    named += [(f"robot[{index}]", robot.network) for index, robot in enumerate(robots)]
    for place, name in named:
        if name and name not in known:
            advice = nearest(name, known) if known else "the file has none; add it as [[network]]"
            raise source.wrong(f"{place}.network", f"no network {name!r}, {advice}")


def check_hardware(source: Source, place: str, folder: Path, given: FleetRobot | Defaults) -> None:
    """Raise ConfigError for a port, model, laser or camera that commands would refuse."""
    checks: tuple[tuple[str, Callable[[], object]], ...] = (
        ("port", lambda: _check_port(given.port)),
        ("bridge", lambda: _check_bridge(given)),
        ("model", lambda: _check_model(folder, given.model)),
        ("laser", lambda: _check_laser(given.laser)),
        ("camera", lambda: _check_camera(given.camera)),
    )
    for key, check in checks:
        with _blamed_on(source, f"{place}.{key}"):
            check()


def refuse_doubles(
    source: Source, operator: OperatorComputer, robots: Sequence[FleetRobot]
) -> None:
    """Raise ConfigError for a name, host, address, port or node that two computers have."""
    for key in ("name", "address"):
        value = getattr(operator, key)
        for index, robot in enumerate(robots):
            if value and value.lower() in {getattr(robot, key).lower(), robot.host.lower()}:
                raise source.wrong(f"operator.{key}", f"{value} is robot[{index}]'s")
    _refuse_shared(source, robots)


def groups(
    source: Source, tables: Mapping[str, object], robots: Sequence[FleetRobot]
) -> dict[str, tuple[str, ...]]:
    """Return the groups; ConfigError if one is no list of robots, or its name means another."""
    names = tuple(robot.name for robot in robots)
    found: dict[str, tuple[str, ...]] = {}
    for name, members in tables.items():
        place = f"groups.{name if name.isprintable() and len(name) < 64 else shown(name)}"
        if not GROUP.fullmatch(name):
            raise source.wrong(place, "a group's name has letters, digits, - and _")
        if name in names or name == ALL:
            meant = "the group of all robots" if name == ALL else "a robot"
            raise source.wrong(place, f"{name} is {meant} already; take another name")
        if not isinstance(members, list) or not all(isinstance(one, str) for one in members):
            example = ", ".join(f'"{robot}"' for robot in names[:2]) or '"p3at-1"'
            raise source.wrong(place, f"expected a list of robots, such as [{example}]")
        for index, member in enumerate(members):
            if member not in names:
                advice = nearest(member, names) if names else "the file has none"
                raise source.wrong(f"{place}[{index}]", f"no robot {shown(member)}, {advice}")
            if member in members[:index]:
                raise source.wrong(f"{place}[{index}]", f"{member} is in the group already")
        found[name] = tuple(members)
    return found


def check_address(source: Source, place: str, text: str) -> None:
    """Raise ConfigError for a text that is no address of a computer."""
    try:
        address = ip_address(text)
    except ValueError:
        problem = f"expected an IP address such as 192.168.1.113, got {shown(text)}"
        raise source.wrong(place, problem) from None
    if address.is_unspecified or address.is_multicast or text == "255.255.255.255":
        raise source.wrong(place, f"{text} is no computer's address")
    if str(address) != text:
        raise source.wrong(place, f"{text} is written {address}")


def _check_port(port: str) -> None:
    scheme, rest = split_url(port)
    if scheme == "replay":
        raise ConfigError(f"{shown(port)} is a recording, no robot")
    if scheme == "tcp":
        split_host(f"tcp:{rest}")


def _check_bridge(given: FleetRobot | Defaults) -> None:
    if not given.bridge or isinstance(given, Defaults):
        return
    if not given.is_device:
        raise ConfigError(f"{given.port} is reached by others as it is; leave bridge out, or 0")
    if given.ros:
        raise ConfigError(f"the node of ROS {given.ros} has the port; leave ros or bridge out")


def _check_model(folder: Path, model: str) -> None:
    from pioneer3.models import load_model

    if not model:
        return
    is_file = Path(model).suffix.lower() in MODEL_FILES
    load_model(folder / model if is_file else model)


def _check_laser(laser: str) -> None:
    from pioneer3.robot.lasers.spec import parse_laser

    if laser not in {"", "auto"}:
        parse_laser(laser)


def _check_camera(camera: str) -> None:
    from pioneer3.mjpeg import parse_url

    if camera:
        parse_url(camera)


@contextmanager
def _blamed_on(source: Source, place: str) -> Iterator[None]:
    """Give the errors of a check the line of the key."""
    try:
        yield
    except ConfigError as error:
        said = str(error).removeprefix("--laser: ").removeprefix("--camera ")
        raise source.wrong(place, said) from None


REMEDY: Mapping[str, str] = {
    "name": "; give each robot a name of its own",
    "host": "; each robot has a computer of its own, with a host name of its own",
    "address": "; each robot has a computer of its own; robots that are simulated on this one "
    "have 127.0.0.1, 127.0.0.2, ..., and `pioneer3 sim --fleet FILE` starts them",
    "port": "; give the other robot's address, or another TCP port",
    "node": "; give one of them `node`, or a `network` of its own",
}
"""Remedies for robots that share a value, by key."""


def _refuse_shared(source: Source, robots: Sequence[FleetRobot]) -> None:
    keys: Mapping[str, Callable[[FleetRobot], object]] = {
        "name": lambda robot: robot.name.lower(),
        "host": lambda robot: robot.host.lower(),
        "address": lambda robot: robot.address,
        "port": lambda robot: _reached(robot, robots),
        "node": lambda robot: (robot.ros, robot.network, robot.node.lstrip("/")),
    }
    for key, value_of in keys.items():
        seen: dict[object, int] = {}
        for index, robot in enumerate(robots):
            value = value_of(robot)
            if value is not None and value in seen:
                problem = f"{getattr(robot, key)} is robot[{seen[value]}]'s already{REMEDY[key]}"
                raise source.wrong(f"robot[{index}].{key}", problem)
            seen[value] = index


def _reached(robot: FleetRobot, robots: Sequence[FleetRobot]) -> object:
    """Return address and number of a TCP port; `None` for a device, which is its computer's own."""
    if robot.endpoint is None:
        return None
    host, number = robot.endpoint
    for other in robots:
        if host.lower() in {other.name.lower(), other.host.lower()}:
            return other.address, number
    return ("127.0.0.1" if host.lower() == "localhost" else host.lower()), number
