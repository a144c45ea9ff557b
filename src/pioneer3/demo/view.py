"""The texts around the panel: who is driven, which modes there are, what is going on."""

from collections.abc import Iterable

from rich.text import Text

from pioneer3.behaviors.explanations import explain
from pioneer3.demo.modes import Mode
from pioneer3.robot.devices import detailed_status
from pioneer3.robot.identity import is_simulator, kind
from pioneer3.robot.supervisor import Connection
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
    text.append(state.upper() if state is not Connection.CONNECTED else state, _state_style(state))
    if snapshot is not None:
        low = snapshot.battery.low
        text.append(f" {snapshot.link.rate:.0f}/s")
        text.append(f" {snapshot.battery.voltage:.1f} V", "bold red" if low else "")
    return text


def mode_list(modes: Iterable[Mode], active: Mode, rows: int) -> Text:
    """Return the modes with their keys, as many as there are rows, the active one among them."""
    listed = list(modes)
    first = min(max(0, listed.index(active) - rows + 2), max(0, len(listed) - rows))
    text = Text(no_wrap=True, overflow="ellipsis")
    for number, mode in enumerate(listed[first : first + rows]):
        text.append("\n" if number else "")
        missing = mode.presence().there is False
        style = "reverse bold" if mode is active else "grey62" if missing else ""
        text.append(f" {mode.key} ", style or "bold cyan")
        text.append(f"{mode.label or mode.name}{' ✗' if missing else ''} ", style)
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
    """Return who decided what, and why the robot stands still if it does."""
    text = Text(overflow="ellipsis")
    if words := explain(robot.arbiter.decision):
        text.append("; ".join(words), "cyan").append("\n")
    why = robot.why_not_moving()
    return text.append(why or "moving", "yellow" if why else "bold green")


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


def _state_style(state: Connection) -> str:
    return "green" if state is Connection.CONNECTED else "bold white on red"
