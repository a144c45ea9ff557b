"""`pioneer3 log plot`: the way and the curves of a run, as a picture or in the terminal."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.cli.log_why import opened
from pioneer3.cli.options import LogName, RobotName
from pioneer3.cli.process import write_line

if TYPE_CHECKING:
    from rich.text import Text

    from pioneer3.analysis.curves import Chart, RunDrawn

ROWS = 4
"""Rows of a chart in a terminal."""
MARGIN = 22
"""Columns left of a chart, for its title and the ends of its axis."""
AROUND = 0.5
"""Width of the picture beyond the end of the way [m]: a robot that stood is no speck of nothing."""
MEASURED = "cyan"
"""Style of what was measured."""
WANTED = "yellow"
"""Style of what was wanted."""


def plot(
    name: LogName = "",
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], metavar="FILE")] = None,
    robot: RobotName = None,
) -> int:
    """Draw the way of a run, speeds wanted and measured, battery and link.

    Example: pioneer3 log plot drive

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        output: A new picture: .png, .svg or .pdf; without it, the terminal.
        robot: Of a log of several.
    """
    from pioneer3.analysis.curves import run_drawn
    from pioneer3.analysis.picture import draw_picture
    from pioneer3.names import printable

    log = opened(name, robot)
    run = run_drawn(log)
    title = f"{printable(robot or ', '.join(log.robots))}, {log.began:%Y-%m-%d %H:%M:%S}"
    if output is not None:
        draw_picture(run, title, output)
        write_line(f"wrote {output}")
        return 0
    _print(run, title)
    return 0


def _print(run: "RunDrawn", title: str) -> None:
    from rich.text import Text

    from pioneer3.cli.map_drawing import CharacterCanvas
    from pioneer3.cli.terminal import Terminal

    terminal = Terminal()
    rows = max(6, terminal.height - (ROWS + 1) * len(run.charts) - 4)
    canvas = CharacterCanvas(_drawing(run), terminal.width, rows)
    terminal.print(Text(title, "bold"), Text(_where(run)))
    terminal.print(canvas.text())
    terminal.print(canvas.ruler())
    for chart in run.charts:
        terminal.print(_chart(chart, terminal.width - MARGIN))
    terminal.print(Text("⣿ wanted  ", WANTED) + Text("⣿ measured", MEASURED))


def _where(run: "RunDrawn") -> str:
    kind = f"on the map {run.line_map.name}" if run.line_map else "by odometry"
    x, y = run.way[-1]
    return f"the way {kind}, to x {x:.1f}, y {y:.1f} m"


def _drawing(run: "RunDrawn") -> Any:
    """Return the map, if there is one, with the way on it, and a mark where it ends."""
    import numpy as np

    from pioneer3.geometry import Pose2
    from pioneer3.maps.drawing import Layer, MapDrawing, Marker, bounds_of

    way = np.column_stack([run.way[:-1], run.way[1:]]).reshape(-1, 4)
    x, y = run.way[-1].tolist()
    end = Marker(Layer.DOCK, Pose2(x, y, 0.0), "", has_heading=False)
    if run.line_map is not None:
        drawing = run.line_map.drawing
        lines = drawing.lines | {Layer.GOAL: way}
        bounds = bounds_of(lines.values(), (*drawing.markers, end))
        return replace(drawing, lines=lines, bounds=bounds, markers=(end,))
    around = np.array([[x - AROUND, y - AROUND, x + AROUND, y + AROUND]])
    bounds = bounds_of([way, around], [end])
    return MapDrawing(name="", bounds=bounds, lines={Layer.GOAL: way}, markers=(end,))


def _chart(chart: "Chart", columns: int) -> "Text":
    """Return curves as dots, with the title and the ends of the axis at the left."""
    import numpy as np
    from rich.text import Text

    from pioneer3.demo.drawing import Braille

    known = [each for each in chart.curves if np.isfinite(each.values).any()]
    if not known:
        return Text(f"{chart.title} [{chart.unit}]: nothing is known")
    values = np.concatenate([each.values[np.isfinite(each.values)] for each in known])
    low, high = float(values.min()), float(values.max())
    begin = min(float(each.times[0]) for each in known)
    end = max(float(each.times[-1]) for each in known)
    picture = Braille(max(columns, 8), ROWS, [WANTED, MEASURED])
    across, down = 2 * picture.columns, 4 * ROWS
    moments = np.linspace(begin, end, across)
    for curve in known:
        style = WANTED if curve.step else MEASURED
        place = np.searchsorted(curve.times, moments, side="right") - 1
        for column, at in enumerate(place.tolist()):
            value = float(curve.values[at]) if at >= 0 else np.nan
            if np.isfinite(value):
                share = (value - low) / (high - low) if high > low else 0.5
                picture.dot(column, round((1 - share) * (down - 1)), style)
    labels = [f"{high:.2f}", f"{chart.title} [{chart.unit}]", "", f"{low:.2f}"]
    text = Text()
    for label, line in zip(labels, picture.text().split("\n"), strict=True):
        text.append(f"{label:>{MARGIN - 1}} ").append_text(line).append("\n")
    seconds = f"{begin:.0f} s to {end:.0f} s"
    return text.append(" " * MARGIN + seconds, "dim")
