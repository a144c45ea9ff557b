"""Every exception this package raises on purpose.

* :exc:`PioneerError`
    * :exc:`LinkError` (also :exc:`ConnectionError`): the cable or socket failed
        * :exc:`PortNotFoundError` (also :exc:`FileNotFoundError`): no such port, host or file
            * :exc:`UnknownHostError`: nobody knows a host of this name
        * :exc:`PortPermissionError` (also :exc:`PermissionError`): this user may not open the port
        * :exc:`PortBusyError`: another program has the port
        * :exc:`HungUpError`: the far end closed the link
        * :exc:`RecordingOverError`: a recording in the place of a robot has been played to its end
        * :exc:`HostError`: another computer does not answer over ssh
            * :exc:`LoginError`: it answers, but does not let this user in
    * :exc:`NoRobotError` (also :exc:`TimeoutError`): the port opened, but no robot answered
        * :exc:`TurnedAwayError`: the far end closed the link before a robot answered
    * :exc:`CommandError` (also :exc:`ValueError`): a command must not be sent to the robot
    * :exc:`MotionError` (also :exc:`RuntimeError`): the robot could not carry out the motion
    * :exc:`DeviceError` (also :exc:`RuntimeError`): an accessory is missing or does not answer
    * :exc:`ConfigError` (also :exc:`ValueError`): an option, map, model or fleet file is wrong
        * :exc:`MissingTypeError`: the ROS that is installed lacks a type of messages
    * :exc:`FilePermissionError` (also :exc:`PermissionError`): this user may not use a file
    * :exc:`RemoteError` (also :exc:`RuntimeError`): work on another computer failed there

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
    """The answer to a request that is not carried out, where `None` says that it is.

    Attributes:
        text: The reason, for people.
    """

    text: str

    def __str__(self) -> str:
        return self.text


class PioneerError(Exception):
    """Base class; catch this to catch everything above."""


class LinkError(PioneerError, ConnectionError):
    """The cable or socket failed."""


class PortNotFoundError(LinkError, FileNotFoundError):
    """There is no such port, host or recording."""


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
    """Another computer does not let this user in."""


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
    """A parameter, map, model or fleet file is missing, malformed or out of range."""


class MissingTypeError(ConfigError):
    """The ROS that is installed lacks a type of messages; the message names its package."""


class FilePermissionError(PioneerError, PermissionError):
    """This user may not read or write a file."""


class RemoteError(PioneerError, RuntimeError):
    """Work on another computer failed there."""
