"""Texts and bars of the screen: the robot, the modes, the active mode, the flags."""

from collections.abc import Iterable, Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text
from textual.renderables.digits import Digits

from pioneer3.behaviors.explanations import explain
from pioneer3.demo.mode import DemoMode, Gauge
from pioneer3.robot.devices import detailed_status
from pioneer3.robot.explain import advised
from pioneer3.robot.supervisor import Connection, is_simulator, kind
from pioneer3.runtime.robot import Robot

FOOT = (
    (" k EMERGENCY STOP ", "bold white on red"),
    ("  Ctrl-R: release it   letters: modes   h: help   Esc: quit", ""),
)


def headline(robot: Robot) -> Text:
    """Return one line: ROBOT or SIMULATOR, name, model, port, link, battery."""
    info, status, snapshot = robot.info, robot.supervisor.status.latest, robot.snapshot
    state = status.connection if status else Connection.CONNECTED
    text = Text(no_wrap=True, overflow="ellipsis")
    style = "black on cyan" if is_simulator(info) else "black on green"
    text.append(f" {kind(info)} ", f"bold {style}")
    text.append(f" {info.identity.name}, {info.model.title}  ", "bold")
    text.append(f"{info.url} ", "grey62")
    if state is Connection.CONNECTED:
        text.append(state, "green")
    else:
        text.append(state.upper(), "bold white on red")
    if snapshot is not None:
        low = snapshot.battery.low
        text.append(f" {snapshot.link.rate:.0f}/s")
        text.append(f" {snapshot.battery.voltage:.1f} V", "bold red" if low else "")
    return text


def mode_list(modes: Iterable[DemoMode], active: DemoMode, rows: int) -> Text:
    """Return the modes with their keys, as many as there are rows, the active one among them."""
    listed = list(modes)
    first = min(max(0, listed.index(active) - rows + 2), max(0, len(listed) - rows))
    text = Text(no_wrap=True, overflow="ellipsis")
    for number, mode in enumerate(listed[first : first + rows]):
        text.append("\n" if number else "")
        missing = mode.presence().there is False
        style = "reverse bold" if mode is active else "grey62" if missing else ""
        text.append(f" {mode.about.key} ", style or "bold cyan")
        text.append(f"{mode.about.label or mode.about.name}{' ✗' if missing else ''} ", style)
    return text


def flags(robot: Robot) -> Text:
    """Return the flags and faults that are up, by name."""
    snapshot = robot.snapshot
    text = Text(no_wrap=True, overflow="ellipsis")
    if snapshot is None:
        return text.append("NO READINGS: the link is lost.", "bold white on red")
    loud = {
        "E-STOP LATCHED": robot.supervisor.pilot.emergency,
        "STOP BUTTON": snapshot.motors.stop_button,
        "STALL": snapshot.motors.stalled,
        "BUMPED": any((*snapshot.bumpers.front, *snapshot.bumpers.rear)),
        **{fault.upper(): True for fault in snapshot.faults},
    }
    for name in (name for name, up in loud.items() if up):
        text.append(f" {name} ", "bold white on red").append(" ")
    if not snapshot.motors.enabled:
        text.append("motors off", "bold yellow").append(", ")
    return text.append(", ".join(_grouped(detailed_status(snapshot).flags)), "green")


def reasons(robot: Robot) -> Text:
    """Return the parts of the decision, and the reason that the robot stands still, if it does."""
    text = Text(overflow="ellipsis")
    if words := explain(robot.arbiter.decision):
        text.append("; ".join(words), "cyan").append("\n")
    why = robot.why_not_moving()
    if why is None:
        return text.append("moving", "bold green")
    return text.append(advised(why), "yellow" if why.wants_help else "")


def _grouped(names: Iterable[str]) -> list[str]:
    """Return the names, the sonar arrays as one."""
    rest, arrays = [], []
    for name in names:
        word, _, number = name.partition(" ")
        if word == "sonar":
            arrays.append(number)
        else:
            rest.append(name)
    return rest + ([f"sonar {' '.join(arrays)}"] if arrays else [])


EIGHTHS = " ▏▎▍▌▋▊▉█"
NAME = 6
"""Columns of a gauge's name."""
TEXT = 12
"""Columns of a gauge's words."""


def panel(
    mode: DemoMode, gauges: Sequence[Gauge], details: Sequence[str], width: int, *, cropped: bool
) -> RenderableType:
    """Return the panel of `mode`, `width` characters wide; `cropped` details do not wrap."""
    name, keys = mode.about.name, mode.about.help
    parts: list[RenderableType] = [Text(f" {name.upper()} ", "bold reverse"), _keys(keys)]
    presence = mode.presence()
    if presence.there is not True:
        style = "bold yellow" if presence.there is False else "yellow"
        parts.append(Text(presence.reason, style))
    for gauge in gauges:
        parts += _big(gauge, width) if gauge.big else [_small(gauge, width)]
    parts += [Text(line, no_wrap=cropped, overflow="ellipsis") for line in details]
    return Group(*parts)


def _keys(lines: Sequence[str]) -> RenderableType:
    """Return keys and their effects in two columns; notes go across, warnings in red."""
    grid = Table.grid(padding=(0, 1))
    grid.add_column(style="bold cyan", no_wrap=True)
    grid.add_column(style="grey62")
    notes = []
    for line in lines:
        keys, colon, meaning = line.partition(": ")
        if colon:
            grid.add_row(keys, meaning)
        else:
            notes.append(Text(line, "bold red" if line.isupper() else "grey62"))
    return Group(*notes, grid)


def _big(gauge: Gauge, width: int) -> list[RenderableType]:
    style = "bold yellow" if gauge.alarm else "bold"
    number, _, words = gauge.text.partition(" ")
    return [
        Digits(number, style),
        Text.assemble((f"{gauge.name} {words}".rstrip(), style)),
        bar(gauge, width, style),
    ]


def _small(gauge: Gauge, width: int) -> Text:
    style = "bold red" if gauge.alarm else ""
    text = Text(f"{gauge.name:{NAME}}", no_wrap=True)
    text.append(bar(gauge, max(4, width - NAME - TEXT), style or "cyan"))
    return text.append(f"{gauge.text:>{TEXT}}", style)


def bar(gauge: Gauge, width: int, style: str = "") -> Text:
    """Return a bar of `width` characters, to both sides of its middle where there are two."""
    text = Text(no_wrap=True)
    if not gauge.signed:
        return _filled(text, max(0.0, gauge.share), width, style)
    half = (width - 1) // 2
    # blocks grow from the left only: on the left side they are whole ones
    left = round(min(max(0.0, -gauge.share), 1.0) * half)
    text.append("·" * (half - left), "bright_black").append("█" * left, style)
    text.append("│", "bright_black")
    return _filled(text, max(0.0, gauge.share), width - half - 1, style)


def _filled(text: Text, share: float, width: int, style: str) -> Text:
    whole, part = divmod(round(min(share, 1.0) * width * 8), 8)
    drawn = "█" * whole + (EIGHTHS[part] if part else "")
    return text.append(drawn, style).append("·" * (width - len(drawn)), "bright_black")
