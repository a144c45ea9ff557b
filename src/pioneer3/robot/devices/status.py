"""Flags and faults by name; safety of MTX robots (protocol.md 4.4 to 4.6, facts.md 8.16)."""

from collections import deque
from dataclasses import dataclass
from enum import IntFlag
from math import nan

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestConfig, RequestMode
from pioneer3.arcos.reports import Config, Fault, Report, SipFlag, SipFlag3
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import ask
from pioneer3.robot.supervisor import Supervisor
from pioneer3.state import Charging, Snapshot

LAST_TEXTS = 100
SYSTEM_STATES = {
    0x00: "unknown",
    0x10: "failure",
    0x20: "warning",
    0x40: "commissioned",
    0x50: "disabled",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class DetailedStatus:
    """The values of ARIA's status mode that a snapshot does not have as fields.

    Flags and faults are the names of those that are set; `None` where the robot sends none, as
    only MTX robots do of `flags3`.

    Attributes:
        charger_power: Whether the charger's power is good.
        high_temperature: Whether the motors are too hot.
        cycle: Mean interval of reports [s]; NaN before the second one.
    """

    flags: tuple[str, ...]
    faults: tuple[str, ...] | None
    flags3: tuple[str, ...] | None
    charging: Charging
    charger_power: bool
    high_temperature: bool
    cycle: float


def detailed_status(snapshot: Snapshot) -> DetailedStatus:
    """Return the status that `snapshot` holds, by name."""
    words = snapshot.words
    flags = SipFlag(words.flags)
    return DetailedStatus(
        flags=names(flags, 16),
        faults=None if words.faults is None else names(Fault(words.faults), 16),
        flags3=None if words.flags3 is None else names(SipFlag3(words.flags3), 32),
        charging=snapshot.battery.charging,
        charger_power=SipFlag.CHARGER_POWER_GOOD in flags,
        high_temperature=SipFlag.HIGH_TEMPERATURE in flags,
        cycle=1 / snapshot.link.rate if snapshot.link.rate else nan,
    )


def names(flags: IntFlag, width: int) -> tuple[str, ...]:
    """Return the name of each bit that is set, the lowest first; `bit 12` where it has none."""
    kind = type(flags)
    found = ((bit, kind(1 << bit).name) for bit in range(width) if flags >> bit & 1)
    return tuple(name.lower().replace("_", " ") if name else f"bit {bit}" for bit, name in found)


@dataclass(frozen=True, slots=True)
class SafetyReading:
    """The safety systems of an MTX robot; `state` is undocumented."""

    state: int
    estop_system: str
    laser_system: str


class Safety:
    """Asks for the safety state, and keeps the firmware's unrequested texts and warnings.

    Attributes:
        texts: Debug texts of the firmware (packets 211), the newest last.
        warnings: Number of safety warnings (packets 217).
        latest: The last safety state (packet 214), or `None`.
    """

    def __init__(self, supervisor: Supervisor) -> None:
        self.texts: deque[str] = deque(maxlen=LAST_TEXTS)
        self.warnings = 0
        self.latest: SafetyReading | None = None
        self._supervisor = supervisor
        supervisor.reports.hand_to(
            self._take, reports.FirmwareText, reports.SafetyWarning, reports.SafetyState
        )

    @property
    def presence(self) -> Presence:
        """Whether the robot has safety systems that answer: only an answer shows it."""
        if self.latest is not None:
            return Presence(True, "The robot has told its safety state.")
        return Presence(None, "No safety state has come: MTX robots tell it, a Pioneer 3 does not.")

    async def ask(self) -> SafetyReading:
        """Ask for the safety state (SAFETY_STATE_INFO 1).

        Raises:
            DeviceError: the robot does not answer; no Pioneer 3 does.
            CommandError: no robot is connected.
        """
        what = "the safety systems, which only MTX robots have"
        command = commands.SafetyStateInfo(RequestMode.ONCE)
        return _read(await ask(self._supervisor, what, command, reports.SafetyState))

    def _take(self, report: Report, stamp: float) -> None:
        match report:
            case reports.FirmwareText(text):
                self.texts.append(text)
            case reports.SafetyWarning():
                self.warnings += 1
            case reports.SafetyState():
                self.latest = _read(report)


def _read(report: reports.SafetyState) -> SafetyReading:
    return SafetyReading(report.state, _system(report.estop_system), _system(report.laser_system))


def _system(state: int) -> str:
    return SYSTEM_STATES.get(state, f"state {state:#04x}")


async def ask_configuration(supervisor: Supervisor) -> Config:
    """Ask for the present CONFIG and return it; `supervisor.info` has it from then on.

    Raises:
        DeviceError: the robot does not answer; its model's values stay in use.
        CommandError: no robot is connected.
    """
    return await ask(supervisor, "CONFIG", RequestConfig(), Config)
