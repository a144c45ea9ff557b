"""What a diagnosis is made of: facts, and the findings drawn from them."""

from dataclasses import dataclass
from enum import StrEnum

from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.recognition import OtherDevice
from pioneer3.errors import LinkError
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Snapshot

FAILED, UNREACHABLE, FORBIDDEN = 1, 3, 4
"""Exit codes of the command line (facts.md 14.4)."""


class Level(StrEnum):
    """How bad it is."""

    OK = "ok"
    WARN = "warn"
    FAIL = "fail"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One check and its outcome.

    Attributes:
        check: What was looked at, in a word or two.
        level: How bad it is.
        found: What was found.
        meaning: What that means; empty where it is plain.
        advice: What to do; empty where nothing is.
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
    """What a robot sent while we listened.

    Attributes:
        seconds: How long that was [s].
        reports: Information packets.
        longest_gap: Between two of them [s].
        packets: Frames of any kind.
        bad_checksums: Frames rejected.
        bytes_skipped: Bytes that belonged to no frame.
        sonars: Numbers of the transducers that were read.
        snapshot: The last reading, or `None` if there was none.
        config_trusted: False where CONFIG's checksum was wrong, but twice the same.
        ended: Why the session ended too early, or `None`.
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
class Facts:
    """Everything that was found out.

    Attributes:
        url: What was asked for.
        port: What the system knows of a serial port; `None` for other links.
        refused: Why the link did not open.
        closed: Whether the far end hung up without a word.
        other_device: Who answers in place of a robot.
        heard_at: Serial speeds at which anything was heard [baud].
        info: What the robot is; `None` when none answered.
        streaming: Whether the robot still served an earlier session.
        heard: What it sent.
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
        """Whether this is about a serial port."""
        return self.port is not None
