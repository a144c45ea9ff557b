"""The interface of an accessory: it obeys commands, reports, and adds to the standard report.

An accessory has no clock and no framing: time is an argument, commands and reports are typed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from pioneer3.arcos.commands import Command, RequestMode
from pioneer3.arcos.reports import Report, SipFlag
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel

NO_FLAGS = SipFlag(0)


class BatteryState(Protocol):
    """The state of the battery."""

    @property
    def charge(self) -> float: ...
    @property
    def fixed(self) -> float | None: ...


class CarryingRobot(Protocol):
    """The part of a robot that its accessories use; `sim.body.Body` is one."""

    @property
    def model(self) -> RobotModel: ...
    @property
    def robot_in_world(self) -> Pose2: ...
    @property
    def battery(self) -> BatteryState: ...
    @property
    def wheel_travel(self) -> tuple[float, float]: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class SipFields:
    """The fields of the standard report, `reports.Sip`, that accessories fill in."""

    analog_port: int = 0
    gripper_state: int = 0
    analog: int = 0
    digital_in: int = 0xFF
    digital_out: int = 0xFF
    compass_raw: int = 0
    flags: SipFlag = NO_FLAGS


NOTHING = SipFields()


class Accessory:
    """One device that is connected to the controller; by default it says nothing by itself."""

    def obey(self, command: Command, now: float) -> bool:
        """Carry out `command` at `now` [s]; return whether it was meant for this accessory."""
        raise NotImplementedError

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the reports that are due: answers always, streams only if `cycle` is true."""
        return ()

    def inputs(self, sip: SipFields, now: float) -> SipFields:
        """Return `sip` with this accessory's bits."""
        return sip

    def hang_up(self) -> None:
        """Stop the streams and motions of the ended session; other states stay."""


@dataclass(slots=True)
class HostRequest:
    """The host's request for a report: never, once, or with every cycle."""

    once: bool = False
    stream: bool = False

    def set(self, how: RequestMode) -> None:
        """Set the request; it replaces an earlier one."""
        self.once, self.stream = how is RequestMode.ONCE, how is RequestMode.STREAM

    def due(self, *, cycle: bool) -> bool:
        """Whether a report is to be sent now; this fulfils a request for one."""
        due = self.once or (cycle and self.stream)
        self.once = False
        return due


class ReportingAccessory(Accessory):
    """An accessory that sends one kind of report, when that is requested."""

    def __init__(self) -> None:
        self._request = HostRequest()

    def read(self, now: float) -> Report:
        """Return the report as it is at `now` [s]."""
        raise NotImplementedError

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the report when it is due."""
        return (self.read(now),) if self._request.due(cycle=cycle) else ()

    def hang_up(self) -> None:
        self._request = HostRequest()
