"""What every accessory is: obeys commands, reports, and puts its bits into the standard report.

An accessory has no clock and no framing: time is an argument, commands and reports are typed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from pioneer3.arcos.commands import Command, Request
from pioneer3.arcos.reports import Report, SipFlag
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel

NO_FLAGS = SipFlag(0)


class Moving(Protocol):
    """One velocity of the drive [m/s or rad/s]."""

    @property
    def velocity(self) -> float: ...


class Wheels(Protocol):
    """How the wheels turn."""

    @property
    def linear(self) -> Moving: ...
    @property
    def angular(self) -> Moving: ...


class Cells(Protocol):
    """What feeds the robot."""

    @property
    def voltage(self) -> float: ...
    @property
    def charge(self) -> float: ...
    @property
    def fixed(self) -> float | None: ...


class Carrier(Protocol):
    """As much of a robot as its accessories feel; `sim.body.Body` is one."""

    @property
    def model(self) -> RobotModel: ...
    @property
    def robot_in_world(self) -> Pose2: ...
    @property
    def drive(self) -> Wheels: ...
    @property
    def battery(self) -> Cells: ...
    @property
    def wheel_travel(self) -> tuple[float, float]: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What accessories put into the standard report; the fields are those of `reports.Sip`."""

    analog_port: int = 0
    gripper_state: int = 0
    analog: int = 0
    digital_in: int = 0xFF
    digital_out: int = 0xFF
    compass_raw: int = 0
    flags: SipFlag = NO_FLAGS


NOTHING = Inputs()


class Accessory(Protocol):
    """One thing that is connected to the controller."""

    def obey(self, command: Command, now: float) -> bool:
        """Carry out `command` at `now` [s]; return whether it was meant for this accessory."""

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return what is due: answers always, streams once per `cycle` of standard reports."""

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Return `sip` with this accessory's bits."""

    def hang_up(self) -> None:
        """Stop what the host of the ended session has asked for."""


@dataclass(slots=True)
class Asked:
    """How often a report is wanted: never, once, or with every cycle."""

    once: bool = False
    stream: bool = False

    def ask(self, how: Request) -> None:
        """Take a request; a later one takes the place of an earlier one."""
        self.once, self.stream = how is Request.ONCE, how is Request.STREAM

    def due(self, *, cycle: bool) -> bool:
        """Whether a report is to be sent now; what was wanted once is then no longer."""
        due = self.once or (cycle and self.stream)
        self.once = False
        return due
