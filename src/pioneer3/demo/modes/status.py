"""Status and error flags in detail (facts.md 8.16)."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import isfinite

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import MISSING, Cell, Row, tenths
from pioneer3.errors import PioneerError
from pioneer3.robot.devices import detailed_status
from pioneer3.state import Charging, Snapshot

CHARGE_STATES = {Charging.UNKNOWN: MISSING, Charging.NONE: "not charging"}


def status(cockpit: Cockpit) -> Mode:
    """Return the mode that names every flag."""
    safety = cockpit.robot.devices.safety
    answer = ""

    async def ask() -> None:
        nonlocal answer
        answer = "safety state: asking ..."
        try:
            reading = await safety.ask()
        except PioneerError as error:
            answer = f"safety state: {error}"
            return
        answer = (
            f"safety state: {reading.state}; e-stop system {reading.estop_system},"
            f" laser system {reading.laser_system}"
        )

    @contextmanager
    def enter() -> Iterator[None]:
        cockpit.work(ask())
        yield

    def details() -> list[str]:
        if cockpit.snapshot is None:
            return []
        lines = [*flag_lines(cockpit.snapshot), answer]
        if safety.warnings:
            lines.append(f"safety warnings: {safety.warnings}")
        return lines + [f"firmware: {text}" for text in safety.texts]

    return Mode(
        key="f",
        name="detailed status/error flags",
        label="status",
        help=("f: ask again",),
        enter=enter,
        again=lambda: cockpit.work(ask()),
        row=lambda: status_row(cockpit.snapshot) if cockpit.snapshot else None,
        details=details,
    )


def status_row(snapshot: Snapshot) -> Row:
    """Return everything, flag words in binary with the highest bit first."""
    words, motors, battery = snapshot.words, snapshot.motors, snapshot.battery
    detail = detailed_status(snapshot)
    temperature = snapshot.inputs.temperature
    cycle = f"{1000 * detail.cycle:.0f}" if isfinite(detail.cycle) else MISSING
    return Row(
        (
            Cell("volt", 5, tenths(battery.voltage)),
            Cell("soc", 5, MISSING if battery.charge is None else f"{100 * battery.charge:.0f}%"),
            Cell("temp", 5, MISSING if temperature is None else str(temperature)),
            Cell("mot.enable", 12, "yes" if motors.enabled else "NO"),
            Cell("estop", 6, _loud(up=motors.stop_button)),
            Cell("stall l", 7, _loud(up=motors.left_stalled)),
            Cell("stall r", 7, _loud(up=motors.right_stalled)),
            Cell("stallval", 16, _word(words.stalls, 16)),
            Cell("sips/sec", 9, str(round(snapshot.link.rate))),
            Cell("cycletime", 10, cycle),
            Cell("flags", 16, _word(words.flags, 16)),
            Cell("faults", 16, _word(words.faults, 16)),
            Cell("flags3", 32, _word(words.flags3, 32)),
            Cell("chargestate", 13, CHARGE_STATES.get(battery.charging, battery.charging)),
            Cell("chargepower", 13, _loud(up=detail.charger_power)),
        ),
        gap=" ",  # the widths alone would let the flag words touch each other
    )


def flag_lines(snapshot: Snapshot) -> Iterator[str]:
    """Yield the names of the flags, faults and flags3 that are up."""
    detail = detailed_status(snapshot)
    yield f"flags: {', '.join(detail.flags) or 'none'}"
    for name, flags in (("faults", detail.faults), ("flags3", detail.flags3)):
        yield f"{name}: {'not sent' if flags is None else ', '.join(flags) or 'none'}"


def _word(value: int | None, width: int) -> str:
    return MISSING if value is None else f"{value:0{width}b}"


def _loud(*, up: bool) -> str:
    return "YES" if up else "no"
