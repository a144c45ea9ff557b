"""The way and the curves of a run as a picture, where matplotlib is installed."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pioneer3.analysis.curves import Chart, RunDrawn
from pioneer3.distribution import how_to_add
from pioneer3.errors import ConfigError
from pioneer3.maps.drawing import Layer

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE: Final = (12.0, 7.0)
"""Size of a picture [inches]."""
RESOLUTION: Final = 110
"""Resolution of a picture [dots per inch]."""
COLOURS: Final = {"wanted": "#ff7f0e", "measured": "#1f77b4"}
"""Colours of curves; of all others the last one."""


def draw_picture(run: RunDrawn, title: str, output: Path) -> None:
    """Write a picture of a run; the ending of the file tells the format, such as `.png`.

    Raises:
        ConfigError: matplotlib is missing, or the file cannot be written.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ConfigError(
            f"a picture needs matplotlib; run: {how_to_add('matplotlib')}; without -o the run is "
            "drawn in the terminal"
        ) from None
    figure = Figure(figsize=SIZE, dpi=RESOLUTION, layout="constrained")
    figure.suptitle(title, parse_math=False)
    parts: Any = figure.subfigures(1, 2, width_ratios=(1, 1.2))
    left, right = parts
    _draw_way(left.subplots(), run)
    for axes, chart in zip(right.subplots(len(run.charts), sharex=True), run.charts, strict=True):
        _draw_chart(axes, chart)
    axes.set_xlabel("time [s]")
    try:
        figure.savefig(output)
    except (OSError, ValueError) as error:
        raise ConfigError(f"{output}: cannot be written: {error}") from None


def _draw_way(axes: "Axes", run: RunDrawn) -> None:
    axes.set(title="way on the map" if run.line_map else "way by odometry", aspect="equal")
    axes.set(xlabel="x [m]", ylabel="y [m]")
    if run.line_map is not None:
        from matplotlib.collections import LineCollection

        drawing = run.line_map.drawing
        for layer, lines in drawing.lines.items():
            pieces: Any = lines.reshape(-1, 2, 2)
            axes.add_collection(LineCollection(pieces, colors=layer.colour, linewidths=0.8))
        for marker in drawing.markers:
            place = marker.pose.x, marker.pose.y
            axes.annotate(marker.name, place, fontsize=7, color="#777777", parse_math=False)
    x, y = run.way.T
    axes.plot(x, y, color=Layer.GOAL.colour)
    axes.plot(x[:1], y[:1], "o", color=Layer.HOME.colour, label="begin")
    axes.plot(x[-1:], y[-1:], "s", color=Layer.FORBIDDEN.colour, label="end")
    axes.legend(fontsize=8)


def _draw_chart(axes: "Axes", chart: Chart) -> None:
    axes.set_ylabel(f"{chart.title}\n[{chart.unit}]", fontsize=9)
    axes.grid(alpha=0.3)
    for curve in chart.curves:
        colour = COLOURS.get(curve.label, COLOURS["measured"])
        style: Any = "steps-post" if curve.step else "default"
        axes.plot(
            curve.times, curve.values, color=colour, drawstyle=style, label=curve.label, lw=1.2
        )
    if len(chart.curves) > 1:
        axes.legend(fontsize=8, loc="upper right")
