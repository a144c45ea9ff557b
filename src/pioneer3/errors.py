"""Every exception this package raises on purpose; each also is the builtin it resembles.

Corrupt bytes *received* are counted, not raised: noise on a serial cable is normal.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar, final


class Symptom(StrEnum):
    """Symptoms that a user sees, each by the name of its page in docs/troubleshooting."""

    COMMAND_NOT_FOUND = "command-not-found"
    DOES_NOT_MOVE = "does-not-move"
    DRIVES_IN_CIRCLES = "drives-in-circles"
    EMERGENCY_STOP = "emergency-stop"
    IT_BEEPS = "it-beeps"
    LOSES_THE_LINK = "loses-the-link"
    NO_ANSWER = "no-answer"
    NO_LASER = "no-laser"
    NO_PORT = "no-port"
    NO_WAY = "no-way"
    NOT_SURE_WHERE_IT_IS = "not-sure-where-it-is"
    PAGE_DOES_NOT_OPEN = "page-does-not-open"
    PAGE_IS_SLOW = "page-is-slow"
    ROS_TOPIC_SILENT = "ros-topic-silent"
    SONAR_IS_WRONG = "sonar-is-wrong"
    STOPS_BY_ITSELF = "stops-by-itself"
    UNKNOWN_ROBOT = "unknown-robot"
    WRONG_DISTANCES = "wrong-distances"

    @property
    def command(self) -> str:
        """The command that opens the page."""
        return f"pioneer3 docs {self}"


@final
@dataclass(frozen=True, slots=True)
class Refusal:
    """The answer to a request that is not carried out, where `None` says that it is."""

    text: str

    def __str__(self) -> str:
        return self.text


class PioneerError(Exception):
    """Base class; catch this to catch everything below.

    `symptom` is the page about a kind of errors; `None` where the message says it all.
    """

    symptom: ClassVar[Symptom | None] = None


class LinkError(PioneerError, ConnectionError):
    """The cable or socket failed."""


class PortNotFoundError(LinkError, FileNotFoundError):
    """There is no such port, host or file."""

    symptom = Symptom.NO_PORT


class UnknownHostError(PortNotFoundError):
    """Nobody knows a host of this name."""

    symptom = Symptom.NO_ANSWER


class PortPermissionError(LinkError, PermissionError):
    """The port exists, but this user may not open it."""

    symptom = Symptom.NO_PORT


class PortBusyError(LinkError):
    """Another program has the port open."""

    symptom = Symptom.NO_PORT


class HungUpError(LinkError):
    """The far end closed the link, as it does while another program has the robot."""

    symptom = Symptom.NO_ANSWER


class RecordingOverError(LinkError):
    """A recording in the place of a robot has been played to its end."""


class HostError(LinkError):
    """Another computer does not answer over ssh."""


class LoginError(HostError):
    """Another computer answers over ssh, but does not let this user in."""


class NoRobotError(PioneerError, TimeoutError):
    """The port opened, but no robot answered on it."""

    symptom = Symptom.NO_ANSWER


class NoNodeError(NoRobotError):
    """No node of ROS is a robot by that name, or it is silent."""

    symptom = Symptom.ROS_TOPIC_SILENT


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
