"""Every exception this package raises on purpose; each also is the builtin it resembles.

Corrupt bytes *received* are counted, not raised: noise on a serial cable is normal.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import final

SETUP = Path(__file__).parents[2] / "scripts/setup"
"""Exists where the package runs from a clone."""


def how_to_get(extra: str) -> str:
    """Return the command that installs an optional part of this package, which no index has."""
    if SETUP.is_file():
        return f"the extra `{extra}` is missing; run: {SETUP}"
    command = f"python -m pip install '.[{extra}]'"
    return f"the extra `{extra}` is missing; in the folder of the package's clone run: {command}"


@final
@dataclass(frozen=True, slots=True)
class Refusal:
    """The answer to a request that is not carried out, where `None` says that it is."""

    text: str

    def __str__(self) -> str:
        return self.text


class PioneerError(Exception):
    """Base class; catch this to catch everything below."""


class LinkError(PioneerError, ConnectionError):
    """The cable or socket failed."""


class PortNotFoundError(LinkError, FileNotFoundError):
    """There is no such port, host or file."""


class UnknownHostError(PortNotFoundError):
    """Nobody knows a host of this name."""


class PortPermissionError(LinkError, PermissionError):
    """The port exists, but this user may not open it."""


class PortBusyError(LinkError):
    """Another program has the port open."""


class HungUpError(LinkError):
    """The far end closed the link, as it does while another program has the robot."""


class RecordingOverError(LinkError):
    """A recording in the place of a robot has been played to its end."""


class HostError(LinkError):
    """Another computer does not answer over ssh."""


class LoginError(HostError):
    """Another computer answers over ssh, but does not let this user in."""


class NoRobotError(PioneerError, TimeoutError):
    """The port opened, but no robot answered on it."""


class TurnedAwayError(NoRobotError):
    """The far end closed the link before a robot answered."""


class CommandError(PioneerError, ValueError):
    """A command that is not finite, out of the protocol's range or of the wrong type."""


class MotionError(PioneerError, RuntimeError):
    """The robot could not carry out a motion; the message is :meth:`Robot.why_not_moving`."""


class DeviceError(PioneerError, RuntimeError):
    """The robot does not have the accessory, or it does not answer."""


class ConfigError(PioneerError, ValueError):
    """An option, map, model or fleet file is missing, malformed or out of range."""


class MissingTypeError(ConfigError):
    """The ROS that is installed lacks a type of messages; the message names its package."""


class FilePermissionError(PioneerError, PermissionError):
    """This user may not read or write a file."""


class RemoteError(PioneerError, RuntimeError):
    """Work on another computer failed there."""
