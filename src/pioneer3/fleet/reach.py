"""How this computer reaches a robot of the fleet: by its port, if that is one for others."""

from collections.abc import Sequence
from dataclasses import replace

from pioneer3.errors import ConfigError
from pioneer3.fleet.spec import ALL, Fleet, FleetRobot
from pioneer3.links.hosts import bracketed, is_loopback, is_own
from pioneer3.links.urls import split_url
from pioneer3.mjpeg import parse_url
from pioneer3.models import Fallback, find_model
from pioneer3.sim.worldfile.toml import MODEL_FILES


def port_of(fleet: Fleet, name: str) -> str:
    """Return the port of a robot, for `--port`; its host's name is replaced by the address.

    Raises:
        ConfigError: There is no such robot, or its port is a device of another computer.
    """
    robot = fleet.robot(name)
    if robot.endpoint is not None:
        address, number = reached_at(fleet, robot.endpoint)
        return f"tcp://{bracketed(address)}:{number}"
    if is_here(robot):
        return robot.port
    place = f"{fleet.path}:{robot.line}" if robot.line else str(fleet.path)
    raise ConfigError(
        f"{place}: {name} is at {robot.port}, a device of {robot.host} ({robot.address}) and not "
        f"of this computer. Run the command there, after ssh {robot.user}@{robot.address}; or let "
        f"others reach the robot: say bridge = 8101 in the file, and run: pioneer3 fleet deploy"
    )


def named(words: Sequence[str], fleet: Fleet) -> tuple[FleetRobot, ...]:
    """Return the robots that words name which may be models too; empty if all are models.

    Raises:
        ConfigError: Some are models, and others robots.
    """
    models = [word for word in words if ":" in word or _is_file(word) or find_model(word)]
    if len(models) == len(words):
        return ()
    known = {ALL, *fleet.groups, *(robot.name for robot in fleet.robots)}
    if not known.intersection(words):
        return ()
    if models:
        raise ConfigError(f"{models[0]} is a model, not a robot of {fleet.path}: give one kind")
    return fleet.select(words)


def _is_file(model: str) -> bool:
    return model.lower().endswith(MODEL_FILES)


def model_of(fleet: Fleet, robot: FleetRobot) -> str:
    """Return the model that the fleet file gives a robot: a name, a path, or nothing."""
    return str(fleet.path.parent / robot.model) if _is_file(robot.model) else robot.model


def given_model(fleet: Fleet, robot: FleetRobot) -> str | Fallback | None:
    """Return the model of a robot, for `connect_async`.

    A file counts whatever the robot says of itself; a name, if the robot's own is not known.
    """
    model = model_of(fleet, robot)
    return model if _is_file(model) else Fallback(model) if model else None


def laser_of(robot: FleetRobot) -> str:
    """Return the laser of a robot, for `--laser`; empty if it has none that is reached from here.

    Like the robot's port, a device is its computer's own.
    """
    url = robot.laser.rpartition("@")[2]
    if not url or is_here(robot):
        return robot.laser
    return robot.laser if url != "auto" and split_url(url)[0] == "tcp" else ""


def camera_of(robot: FleetRobot) -> str | None:
    """Return the camera of a robot, for `--camera`; `None` if it has none.

    One at the loopback address of another computer is looked for at that computer's address.
    """
    if not robot.camera:
        return None
    url = parse_url(robot.camera)
    if not is_loopback(url.host) or is_here(robot):
        return robot.camera
    return str(replace(url, host=robot.address))


def reached_at(fleet: Fleet, endpoint: tuple[str, int]) -> tuple[str, int]:
    """Return a host and a TCP port with the host's address, if the fleet has a host of the name."""
    host, number = endpoint
    return fleet.addresses.get(host.lower(), host), number


def is_here(robot: FleetRobot) -> bool:
    """Whether the robot's computer is this one."""
    return is_own(robot.address)
