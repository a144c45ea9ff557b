"""All accessories of one robot."""

from collections.abc import Mapping, Sequence
from math import inf
from types import MappingProxyType
from typing import Final

from numpy.random import Generator, default_rng

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, GripperVal
from pioneer3.arcos.reports import Report
from pioneer3.sim.accessories.aux_port import SimulatedAuxPort
from pioneer3.sim.accessories.base import NOTHING, Accessory, CarryingRobot, SipFields
from pioneer3.sim.accessories.canon import SimulatedCanonVcc4
from pioneer3.sim.accessories.digital_io import DigitalIo, TableIr
from pioneer3.sim.accessories.gauges import BatteryGauge, SimulatedEncoders, SimulatedJoystick
from pioneer3.sim.accessories.gripper import NoGripper, SimulatedGripper
from pioneer3.sim.accessories.heading import SimulatedCompass, SimulatedGyro
from pioneer3.sim.accessories.sony import SimulatedSonyEvi
from pioneer3.sim.equipment import PORTS, Camera, Equipment

IGNORED: Final = frozenset(
    commands.NUMBERS[name]
    for name in (
        "AUX1BAUD",
        "AUX2BAUD",
        "CALCOMP",
        "JOYDRIVE",
        "MOVINGBLINK",
        "PLAYLIST",
        "POWER_12V",
        "POWER_5V",
        "POWER_AUDIO",
        "POWER_AUX_PC",
        "POWER_LRF",
        "POWER_LRF2",
        "POWER_PC",
        "POWER_PTZ",
        "POWER_TOUCHSCREEN",
        "PTUPOS",
        "SOUND",
        "SOUNDTOG",
    )
) | {commands.Say.ID}
CAMERAS: Final[Mapping[Camera, type[SimulatedCanonVcc4 | SimulatedSonyEvi]]] = MappingProxyType(
    {"vcc4": SimulatedCanonVcc4, "sony": SimulatedSonyEvi}
)


class IgnoredCommands(Accessory):
    """Takes commands that have no effect in the simulator, without an answer."""

    def obey(self, command: Command, now: float) -> bool:
        """Return whether `command` is one of them."""
        return command.ID in IGNORED


class Accessories:
    """The accessories of one robot; `None` for those it does not have.

    Call :meth:`tick` whenever time passes, :meth:`obey` for commands, :meth:`reports` after both,
    and :meth:`inputs` for each standard report.
    """

    def __init__(
        self, body: CarryingRobot, equipment: Equipment | None = None, rng: Generator | None = None
    ) -> None:
        """Without `equipment` the robot has that of its model; `rng` makes the noise."""
        self.equipment = fitted = equipment or Equipment.of(body.model)
        noise = rng or default_rng(0)
        self.table_ir = TableIr(fitted.table_ir) if fitted.table_ir else None
        self.digital = DigitalIo(self.table_ir.held_low) if self.table_ir else DigitalIo()
        self.encoders = SimulatedEncoders(body)
        self.battery = BatteryGauge(body)
        self.gripper = SimulatedGripper() if fitted.gripper else None
        self.compass = self._compass(body, noise) if fitted.compass else None
        self.gyro = self._gyro(body, noise) if fitted.gyro_type else None
        self.joystick = SimulatedJoystick() if fitted.joystick else None
        self.aux = tuple(SimulatedAuxPort(port) for port in PORTS)
        self.camera = CAMERAS[fitted.camera]() if fitted.camera else None
        self.aux[fitted.camera_port - 1].device = self.camera
        fixed: tuple[Accessory, ...] = (self.digital, self.encoders, self.battery, *self.aux)
        chosen = (
            self.gripper or NoGripper(),
            self.compass,
            self.gyro,
            self.joystick,
            IgnoredCommands(),
        )
        self._all: tuple[Accessory, ...] = (*fixed, *(each for each in chosen if each))
        shown = (self.gripper, self.compass, self.joystick)
        self._shown: tuple[Accessory, ...] = (self.digital, *(each for each in shown if each))

    @property
    def due(self) -> float:
        """When to :meth:`tick` and to look for :meth:`reports` between cycles [s], or `inf`."""
        return min(self.gyro.due if self.gyro else inf, *(port.due for port in self.aux))

    def tick(self, now: float) -> None:
        """Measure at `now` [s]; the oftener, the better are the gyro's samples."""
        if self.gyro:
            self.gyro.tick(now)

    def obey(self, command: Command, now: float) -> bool:
        """Give `command` to its accessory; return whether there is one."""
        return any(accessory.obey(command, now) for accessory in self._all)

    def claims(self, command: Command) -> bool:
        """Whether `command` is for an accessory although its number may mean the old laser."""
        return bool(self.gripper and self.gripper.awaits_value and isinstance(command, GripperVal))

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the reports that are due at `now`.

        Answers are always due: reports requested once, and bytes from an AUX port. Streams are due
        if `cycle` is true: a standard report follows.
        """
        return [report for accessory in self._all for report in accessory.reports(now, cycle=cycle)]

    def inputs(self, now: float) -> SipFields:
        """Return the part of the standard report that accessories fill in."""
        sip = NOTHING
        for accessory in self._shown:
            sip = accessory.inputs(sip, now)
        return sip

    def hang_up(self) -> None:
        """Stop the streams and motions of the ended session; keep all other states."""
        for accessory in self._all:
            accessory.hang_up()

    def _compass(self, body: CarryingRobot, rng: Generator) -> SimulatedCompass:
        fitted = self.equipment
        return SimulatedCompass(body, rng, north=fitted.north, noise=fitted.compass_noise)

    def _gyro(self, body: CarryingRobot, rng: Generator) -> SimulatedGyro:
        fitted = self.equipment
        return SimulatedGyro(
            body,
            rng,
            packets=fitted.gyro_type == 1,
            bias=fitted.gyro_bias,
            noise=fitted.gyro_noise,
        )
