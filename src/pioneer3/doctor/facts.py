"""The parts of a diagnosis: facts, and the findings derived from them."""

from dataclasses import dataclass
from enum import StrEnum

from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.recognition import OtherDevice
from pioneer3.errors import LinkError
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Snapshot

FAILED = 1
"""Exit code where a check failed (facts.md 14.4)."""
UNREACHABLE = 3
"""Exit code where nothing answers."""
FORBIDDEN = 4
"""Exit code where a port may not be opened."""


class Level(StrEnum):
    """Severity of a finding."""

    OK = "ok"
    WARN = "warn"
    FAIL = "fail"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One check and its outcome.

    Attributes:
        check: Its subject, in a word or two.
        level: Its severity.
        found: The observation.
        meaning: Its explanation; empty where it is plain.
        advice: For the user; empty where there is nothing to do.
        code: Exit code of the command, where this is the first failure.
    """

    check: str
    level: Level
    found: str
    meaning: str = ""
    advice: str = ""
    code: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Heard:
    """Summary of the bytes received from a robot.

    Attributes:
        seconds: Duration [s].
        reports: Number of information packets.
        longest_gap: Longest interval between two of them [s].
        packets: Number of frames of any kind.
        bad_checksums: Number of rejected frames.
        bytes_skipped: Number of bytes that belonged to no frame.
        sonars: Numbers of the transducers that were read.
        snapshot: The last one, or `None` if there was none.
        config_trusted: False where CONFIG's checksum was wrong, but twice the same.
        ended: The reason for an early end of the session, or `None`.
    """

    seconds: float
    reports: int
    longest_gap: float = 0.0
    packets: int = 0
    bad_checksums: int = 0
    bytes_skipped: int = 0
    sonars: frozenset[int] = frozenset()
    snapshot: Snapshot | None = None
    config_trusted: bool = True
    ended: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkFacts:
    """The facts about one link.

    Attributes:
        url: Of the link.
        port: Properties of a serial port; `None` for other links.
        refused: The error that kept the link from opening.
        closed: Whether the far end closed the link without sending anything.
        other_device: The device that answers in place of a robot.
        heard_at: Serial speeds at which bytes were received [baud].
        info: Description of the robot; `None` when none answered.
        streaming: Whether the robot still served an earlier session.
        heard: Summary of the bytes received from it.
    """

    url: str
    port: SerialPort | None = None
    refused: LinkError | None = None
    closed: bool = False
    other_device: OtherDevice | None = None
    heard_at: tuple[int, ...] = ()
    info: RobotInfo | None = None
    streaming: bool = False
    heard: Heard | None = None

    @property
    def is_serial(self) -> bool:
        """Whether the link is a serial port."""
        return self.port is not None
