"""The parts of a diagnosis: facts, and the findings derived from them."""

from dataclasses import dataclass
from enum import StrEnum
from functools import partial

from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.recognition import OtherDevice
from pioneer3.errors import LinkError, Symptom
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
        symptom: The page of the book about it; `None` where all is well.
    """

    check: str
    level: Level
    found: str
    meaning: str = ""
    advice: str = ""
    code: int = FAILED
    symptom: Symptom | None = None

    def __post_init__(self) -> None:
        """Take the exit code from what is no failure."""
        if self.level is not Level.FAIL:
            object.__setattr__(self, "code", 0)


def ok(check: str, found: str) -> Finding:
    """Return the finding that all is well."""
    return Finding(check=check, level=Level.OK, found=found)


warning = partial(Finding, level=Level.WARN)
failure = partial(Finding, level=Level.FAIL)


@dataclass(frozen=True, slots=True, kw_only=True)
class Heard:
    """Summary of the bytes received from a robot in some seconds.

    `reports` counts information packets, `packets` frames of any kind, `bad_checksums` rejected
    ones, and `bytes_skipped` what belonged to no frame. `longest_gap` is between two reports [s];
    `sonars` are the numbers of the transducers that were read. `config_trusted` is false where
    CONFIG's checksum was wrong, but twice the same; `ended` is the reason for an early end of the
    session.
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

    `port` is `None` for other links than serial ports; `refused` is the error that kept the link
    from opening. It is `closed` if the far end did so without sending anything; bytes were
    `heard_at` serial speeds [baud]. `info` is `None` when no robot answered; one that was
    `streaming` still served an earlier session.
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
