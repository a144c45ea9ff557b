"""The timing, the states and the events of a host's session."""

from enum import Enum

from msgspec import Struct

from pioneer3.arcos import reports
from pioneer3.arcos.reports import Report
from pioneer3.state import Identity


class Timing(Struct, frozen=True, kw_only=True):
    """Waiting times of the host [s].

    Attributes:
        listen: Before the first SYNC packet at each speed; a robot that serves an earlier session
            sends a report every 0.1 s.
        retry: Between the first unanswered SYNC packets; a robot answers within 30 ms.
        drain: Silence to wait for after closing an earlier session.
        config_retry: Between requests for CONFIG.
        config_patience: After which the session goes on without CONFIG.
        pulse: Longest pause between two packets; the robot's watchdog stops it after 2 s.
        silence: Without an information packet for this long the robot is lost (ARIA: 8 s).
        give_up: Longest handshake over all speeds.
    """

    listen: float = 0.2
    retry: float = 0.4
    drain: float = 0.2
    config_retry: float = 0.25
    config_patience: float = 1.5
    pulse: float = 0.5
    silence: float = 2.0
    give_up: float = 12.0


class SessionState(Enum):
    """State of the session."""

    LISTENING = -1
    SYNC0 = 0
    SYNC1 = 1
    SYNC2 = 2
    OPEN = 3
    CLOSED = 4


class SpeedWanted(Struct, frozen=True):
    """The caller must set the link to `baud` before it sends :meth:`Host.outgoing`."""

    baud: int


class Opened(Struct, frozen=True):
    """The handshake finished."""

    identity: Identity


class Configured(Struct, frozen=True):
    """CONFIG arrived, or `None`: the robot did not send it in time. Once a session.

    `trusted` is false for a CONFIG whose checksum was wrong, but twice the same.
    """

    config: reports.Config | None
    trusted: bool = True


class ReportReceived(Struct, frozen=True):
    """Any other report arrived."""

    report: Report


class Lost(Struct, frozen=True):
    """The session is over; `reason` is a sentence for a person."""

    reason: str


Event = SpeedWanted | Opened | Configured | ReportReceived | Lost
