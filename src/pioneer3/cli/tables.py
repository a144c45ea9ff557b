"""Tables of a robot, a diagnosis and a list of ports for a terminal."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from math import degrees
from typing import Final

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from pioneer3.arcos.reports import Config
from pioneer3.doctor.facts import Finding, Level
from pioneer3.doctor.probe import Probed, ProbeVerdict, choose
from pioneer3.robot.config_table import NOT_SENT, ConfigRow, rows_by_field
from pioneer3.robot.supervisor import RobotInfo, is_simulator, kind
from pioneer3.state import Snapshot

SIGNS: Final = {
    Level.OK: Text("ok", "green"),
    Level.WARN: Text("warn", "bold yellow"),
    Level.FAIL: Text("FAIL", "bold red"),
}
VERDICT_STYLES: Final = {
    ProbeVerdict.ROBOT: "bold green",
    ProbeVerdict.SIMULATOR: "bold cyan",
    ProbeVerdict.LASER: "yellow",
    ProbeVerdict.BUSY: "yellow",
    ProbeVerdict.NO_PERMISSION: "red",
}


def robot_tables(robot: RobotInfo, snapshot: Snapshot | None) -> Iterator[RenderableType]:
    """Yield the identity of the robot, its limits and its equipment."""
    style = "cyan" if is_simulator(robot) else "green"
    yield Panel(_summary(robot, snapshot), title=Text(kind(robot), f"bold {style}"), style=style)
    yield "Its settings: pioneer3 config show"


def config_table(
    config: Config, others: Mapping[str, Mapping[str, ConfigRow]], fields: Container[str] | None
) -> Table:
    """Return a table of CONFIG, group by group, with a column for each of `others` beside it.

    Values that differ from it are marked there. Only these `fields` are shown, or all.
    """
    table = Table(box=None, pad_edge=False, header_style="bold", expand=False)
    table.add_column("field", no_wrap=True)
    for heading in ("value", *others):
        table.add_column(heading, justify="right", overflow="fold")
    table.add_column("meaning", style="dim")
    rows = rows_by_field(config).items()
    named = [(field, row) for field, row in rows if fields is None or field in fields]
    for group, members in groupby(named, key=lambda each: each[1].group):
        table.add_row(Text(group, "bold"))
        for field, row in members:
            style = "dim" if row.value == NOT_SENT else ""
            beside = (each.get(field) for each in others.values())
            cells = (
                Text(_with_unit(each), "" if each.value == row.value else "yellow")
                if each
                else Text("")
                for each in beside
            )
            table.add_row(
                Text(f" {row.field}", style), Text(_with_unit(row), style), *cells, row.meaning
            )
    return table


def _with_unit(row: ConfigRow) -> str:
    return f"{row.value} {row.unit}".rstrip()


def _summary(robot: RobotInfo, snapshot: Snapshot | None) -> Table:
    limits, model = robot.limits, robot.model
    grid = Table.grid(padding=(0, 2))
    grid.style = "default"
    grid.add_column(style="dim", no_wrap=True)
    grid.add_column()
    speed = f" at {robot.speed} baud" if robot.speed else ""
    laser = model.laser.kind if model.laser else "none"
    rows = {
        "name": robot.identity.name,
        "model": f"{model.title} ({robot.identity.model}), "
        f"{model.length:.2f} m long, {model.width:.2f} m wide",
        "link": f"{robot.url}{speed}",
        "limits kept": f"{limits.max_speed:g} m/s, {degrees(limits.max_turn_rate):.0f} deg/s; "
        f"{limits.acceleration:g} m/s², {degrees(limits.turn_acceleration):.0f} deg/s²; "
        f"commands expire after {limits.expiry:g} s",
        "sensors": f"{len(model.sonars)} sonar, usual laser {laser}",
        "battery": snapshot.battery.words if snapshot else "unknown",
        "own file": str(robot.own.path) if robot.own else "none, as pioneer3 robot init makes one",
    }
    for name, value in rows.items():
        grid.add_row(name, escape(value))
    return grid


def findings_table(findings: Iterable[Finding]) -> Table:
    """Return the findings, each with its meaning and the advice."""
    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for finding in findings:
        lines: list[RenderableType] = [Text(finding.found)]
        if finding.meaning:
            lines.append(Text(finding.meaning, "dim"))
        if finding.advice:
            lines.append(Text(f"→ {finding.advice}", "cyan"))
        if finding.symptom:
            lines.append(Text(f"See: {finding.symptom.command}", "dim"))
        table.add_row(SIGNS[finding.level], finding.check, Group(*lines))
    return table


def verdict(findings: Sequence[Finding]) -> Text:
    """Return the sum of it in one line."""
    failed = [finding.check for finding in findings if finding.level is Level.FAIL]
    warned = sum(finding.level is Level.WARN for finding in findings)
    if failed:
        return Text(f"\nMend first: {failed[0]}.", "bold red")
    if warned:
        return Text(f"\nIt works; {warned} {'thing' if warned == 1 else 'things'} to look at.")
    return Text("\nAll fine.", "bold green")


def ports_table(found: Iterable[Probed]) -> Table:
    """Return the ports, one a line."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("port", overflow="fold")
    table.add_column("what", no_wrap=True)
    table.add_column("details", style="dim", overflow="fold")
    for each in found:
        style = VERDICT_STYLES.get(each.verdict, "")
        capital = each.verdict in {ProbeVerdict.ROBOT, ProbeVerdict.SIMULATOR}
        what = each.verdict.upper() if capital else str(each.verdict)
        table.add_row(Text(each.url), Text(what, style), Text(_details(each)))
    return table


def _details(each: Probed) -> str:
    port = each.port
    about = [each.detail.removeprefix(f"{each.url}: ")] if each.detail else []
    if port is not None:
        about += [port.device] if port.device != port.path else []
        about += [" ".join(filter(None, (port.manufacturer, port.product)))]
    return "; ".join(filter(None, about))


def advice(found: Sequence[Probed]) -> Text:
    """Return the options to use, or advice when there is no robot."""
    text = _advice_for_robot(found)
    for each in found:
        if each.verdict is ProbeVerdict.LASER:
            text.append("\nThe laser: ").append(f"--laser {each.url}", "bold green")
    return text


def _advice_for_robot(found: Sequence[Probed]) -> Text:
    best = choose(found)
    if best is None:
        text = Text("\nNo robot found. Is it on, and its cable plugged in?\nWhy not: ", "bold")
        text.append(_next_step(found), "bold cyan")
        return text.append("\nWithout a robot: ").append("p3 sim", "bold cyan")
    text = Text("\nUse: ").append(f"--port {best.url}", "bold green")
    if best.verdict is ProbeVerdict.SIMULATOR:
        text.append("  (a SIMULATOR; no real robot answers)", "cyan")
    elif any(each.verdict is ProbeVerdict.SIMULATOR for each in found):
        text.append("  (a SIMULATOR runs too)", "cyan")
    return text


def _next_step(found: Sequence[Probed]) -> str:
    """Return the command that tells more: about the port most worth a closer look, if any."""
    order = (
        ProbeVerdict.NO_PERMISSION,
        ProbeVerdict.BUSY,
        ProbeVerdict.SILENT,
        ProbeVerdict.OTHER,
        ProbeVerdict.FAILED,
    )
    ranked = (each.url for verdict in order for each in found if each.verdict is verdict)
    suspect = next(ranked, None)
    return f"p3 doctor -p {suspect}" if suspect else "p3 find-port --wait"
