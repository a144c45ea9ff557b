"""The way and the curves of a run, to be drawn: speeds wanted and measured, battery, link."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from pioneer3.analysis.open_log import OpenLog
from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap

Float = NDArray[np.float64]
LARGEST: Final = 1e6
"""No robot is so far away [m], or so quick."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Values over time [s], shape (N,); those of a step hold until the next."""

    label: str
    times: Float
    values: Float
    step: bool = False


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves with one axis: its title and unit."""

    title: str
    unit: str
    curves: tuple[Curve, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDrawn:
    """All that is drawn of the run of one robot.

    Attributes:
        way: Points [m], shape (N, 2): on the map where one is known, else of odometry.
        line_map: The map; `None` without one.
        charts: Over the same time.
    """

    way: Float
    line_map: LineMap | None
    charts: tuple[Chart, ...]


def run_drawn(log: OpenLog) -> RunDrawn:
    """Return the curves of a run.

    Raises:
        ConfigError: The log is damaged, has several robots, or no report of one.
    """
    odometry = _possible(log.array("odometry"), "x", "y", "v", "w")
    if not len(odometry):
        raise ConfigError(f"{log.path}: no report of a robot was logged, so nothing can be drawn")
    used = log.newest("map")
    found = _possible(log.array("estimate"), "x", "y")
    on_map = used is not None and len(found) > 1
    places = found if on_map else odometry
    wanted = _possible(log.array("decision"), "v", "w")
    battery = _possible(log.array("battery"), "voltage")
    link = _possible(log.array("link"), "rate")
    return RunDrawn(
        way=np.column_stack([places["x"], places["y"]]),
        line_map=used[1].line_map if used and on_map else None,
        charts=(
            Chart("speed", "m/s", _both(wanted, odometry, "v")),
            Chart("turn rate", "rad/s", _both(wanted, odometry, "w")),
            _alone("battery", "V", battery["time"], battery["voltage"]),
            _alone("link", "reports/s", link["time"], link["rate"]),
        ),
    )


def _possible(rows: NDArray[Any], *names: str) -> NDArray[Any]:
    """Return the rows whose numbers of some names are finite, and not those of a damaged log."""
    known: NDArray[Any] = rows[np.all([abs(rows[name]) < LARGEST for name in names], axis=0)]
    return known


def _both(wanted: NDArray[Any], measured: NDArray[Any], column: str) -> tuple[Curve, ...]:
    return (
        Curve("wanted", wanted["time"], wanted[column], step=True),
        Curve("measured", measured["time"], measured[column]),
    )


def _alone(title: str, unit: str, times: Float, values: Float) -> Chart:
    return Chart(title, unit, (Curve(title, times, values),))
