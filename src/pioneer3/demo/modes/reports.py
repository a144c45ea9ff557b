"""The configuration, the flags, and any command by its number (facts.md 8.13, 8.15, 8.16)."""

from collections import deque
from collections.abc import Iterator
from itertools import groupby
from math import isfinite

from pioneer3.arcos.reports import Config
from pioneer3.demo.columns import MISSING, ColumnCell, ColumnRow, tenths
from pioneer3.demo.mode import Context, DemoMode, Description
from pioneer3.errors import CommandError, PioneerError
from pioneer3.models import RobotModel
from pioneer3.robot.config_table import explained
from pioneer3.robot.devices import detailed_status, parse_typed
from pioneer3.state import Charging, Snapshot


def config(context: Context, about: Description) -> DemoMode:
    """Return the mode that reports the configuration."""
    lines: tuple[str, ...] = ()

    async def ask() -> None:
        nonlocal lines
        lines = ("asking the robot for its CONFIG ...",)
        try:
            answer = await context.robot.devices.configuration()
        except PioneerError as error:
            lines = (str(error),)
            return
        lines = (*config_lines(answer), "", *model_lines(context.robot.info.model))

    def begin() -> None:
        context.work(ask())

    return DemoMode(about, begin=begin, again=begin, details=lambda: lines)


def config_lines(answer: Config) -> Iterator[str]:
    """Yield every field by group: its name, its value, its unit, its meaning."""
    for group, rows in groupby(explained(answer), key=lambda row: row.group):
        yield f"{group}:"
        for row in rows:
            yield f"  {row.field:25} {f'{row.value} {row.unit}'.rstrip():>12}  {row.meaning}"


def model_lines(model: RobotModel) -> Iterator[str]:
    """Yield figures of the model that CONFIG does not have."""
    yield f"of the model {model.name}:"
    yield f"front bumpers  {model.front_bumpers or 'none'}"
    yield f"rear bumpers   {model.rear_bumpers or 'none'}"
    yield f"table sensing  {len(model.table_irs) or 'none'}"
    yield f"sonars         {len(model.sonars)}"
    yield f"laser          {model.laser.kind if model.laser else 'none'}"
    yield (
        f"size           length {model.length:.3f} m, width {model.width:.3f} m,"
        f" radius {model.radius:.3f} m"
    )


CHARGE_STATES = {Charging.UNKNOWN: MISSING, Charging.NONE: "not charging"}


def status(context: Context, about: Description) -> DemoMode:
    """Return the mode that names every flag."""
    safety = context.robot.devices.safety
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

    def begin() -> None:
        context.work(ask())

    def details() -> list[str]:
        if context.snapshot is None:
            return []
        lines = [*flag_lines(context.snapshot), answer]
        if safety.warnings:
            lines.append(f"safety warnings: {safety.warnings}")
        return lines + [f"firmware: {text}" for text in safety.texts]

    return DemoMode(
        about,
        begin=begin,
        again=begin,
        row=lambda: status_row(context.snapshot) if context.snapshot else None,
        details=details,
    )


def status_row(snapshot: Snapshot) -> ColumnRow:
    """Return everything, flag words in binary with the highest bit first."""
    words, motors, battery = snapshot.words, snapshot.motors, snapshot.battery
    detail = detailed_status(snapshot)
    temperature = snapshot.inputs.temperature
    cycle = f"{1000 * detail.cycle:.0f}" if isfinite(detail.cycle) else MISSING
    return ColumnRow(
        (
            ColumnCell("volt", 5, tenths(battery.voltage)),
            ColumnCell(
                "soc", 5, MISSING if battery.charge is None else f"{100 * battery.charge:.0f}%"
            ),
            ColumnCell("temp", 5, MISSING if temperature is None else str(temperature)),
            ColumnCell("mot.enable", 12, "yes" if motors.enabled else "NO"),
            ColumnCell("estop", 6, _loud(up=motors.stop_button)),
            ColumnCell("stall l", 7, _loud(up=motors.left_stalled)),
            ColumnCell("stall r", 7, _loud(up=motors.right_stalled)),
            ColumnCell("stallval", 16, _word(words.stalls, 16)),
            ColumnCell("sips/sec", 9, str(round(snapshot.link.rate))),
            ColumnCell("cycletime", 10, cycle),
            ColumnCell("flags", 16, _word(words.flags, 16)),
            ColumnCell("faults", 16, _word(words.faults, 16)),
            ColumnCell("flags3", 32, _word(words.flags3, 32)),
            ColumnCell("chargestate", 13, CHARGE_STATES.get(battery.charging, battery.charging)),
            ColumnCell("chargepower", 13, _loud(up=detail.charger_power)),
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


LONGEST = 40
"""Characters of a command."""
REMEMBERED = 10


def command(context: Context, about: Description) -> DemoMode:
    """Return the mode that sends typed commands."""
    prompt = _Prompt(context)
    return DemoMode(
        about,
        on_key=prompt.on_key,
        row=lambda: ColumnRow(tail=f"> {prompt.text}"),
        details=lambda: tuple(prompt.sent),
    )


class _Prompt:
    def __init__(self, context: Context) -> None:
        self._context = context
        self.text = ""
        self.sent: deque[str] = deque(maxlen=REMEMBERED)

    def on_key(self, key: str) -> bool:
        match key:
            case "enter":
                self._send()
            case "backspace":
                self.text = self.text[:-1]
            case "space":
                self._add(" ")
            case "-":
                if self.text.endswith(" "):
                    self._add("-")
            case _ if key.isascii() and key.isdecimal():
                self._add(key)
            case _:
                return False
        return True

    def _add(self, character: str) -> None:
        if len(self.text) < LONGEST:
            self.text += character

    def _send(self) -> None:
        line, self.text = self.text, ""
        robot = self._context.robot
        if robot.supervisor.pilot.emergency:
            self._note("not sent: the emergency stop is latched")
            return
        try:
            robot.send_unsafe(parse_typed(line))
        except CommandError as error:
            self._note(f"not sent: {error}")
            return
        number, *arguments = line.split()
        what = {0: "", 1: ", integer ", 2: ", bytes "}[len(arguments)] + " ".join(arguments)
        self._note(f"sent: command {number}{what}")

    def _note(self, text: str) -> None:
        self.sent.append(text)
        self._context.say(text)
