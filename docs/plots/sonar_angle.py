"""Measures what a simulated sonar hears of a wall that it looks at slantingly; draws it.

:func:`table` is the table of docs/explanation/realism.md.
"""

from dataclasses import replace
from math import cos, radians
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.realism import Realism, SonarErrors
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.world import World

if TYPE_CHECKING:
    from docs.plots.studio import Studio

Float = NDArray[np.float64]

PICTURE = Path(__file__).parents[1] / "images/sonar-angle.svg"
MODEL = load_model("p3dx-sh")
TRANSDUCER = 3
"""One of the two that look ahead."""
DISTANCES = 1.0, 2.0
"""From the transducer to the wall, along the transducer's axis [m]."""
READINGS = 2000
WALL = LineMap(name="wall", walls=np.array([[0.0, -50.0, 0.0, 50.0]]))


def listen(distance: float, angle: float) -> Float:
    """Return what the transducer hears again and again, shape (READINGS,) [m].

    Args:
        distance: To the wall along its axis [m].
        angle: Between its axis and the normal of the wall [rad].
    """
    mount = MODEL.sonars[TRANSDUCER]
    sonar_in_world = Pose2(0, 0, angle) @ Pose2(-distance)
    # the wall is the y axis, so the transducer slides along it as it turns
    body = Body(MODEL, sonar_in_world @ Pose2(mount.x, mount.y, mount.theta).inverse())
    always = replace(Realism(), sonar=SonarErrors(cycle=0.0))  # fires whenever it is asked
    world = World(WALL, [body], seed=1, realism=always)
    return np.array([world.sonar(body)[TRANSDUCER] for _ in range(READINGS)])


def heard(distance: float, angle: float) -> tuple[float, float]:
    """Return the median of the echoes [m], NaN without any, and the share of missed ones."""
    ranges = listen(distance, angle)
    echoes = ranges[ranges < SONAR_RANGE]
    missed = 1 - len(echoes) / len(ranges)
    return (float(np.median(echoes)) if missed < 0.9 else float("nan")), missed


def table() -> str:
    """Return the table of the page."""
    ahead = [f"{distance:g} m: range | missed" for distance in DISTANCES]
    lines = [f"| angle | {' | '.join(ahead)} |", "|" + "---|" * (1 + 2 * len(DISTANCES))]
    for degrees in range(0, 81, 10):
        cells = [f"{degrees}°"]
        for distance in DISTANCES:
            range_, missed = heard(distance, radians(degrees))
            cells += ["none" if np.isnan(range_) else f"{range_:.2f} m", f"{100 * missed:.1f} %"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


async def sonar_angle(studio: "Studio") -> None:
    """Draw both curves over the angle.

    Raises:
        PictureError: There is no matplotlib.
    """
    from docs.plots.studio import PictureError

    try:
        from matplotlib import pyplot
    except ImportError as error:
        how = "uv run --with matplotlib python -m docs.plots sonar-angle"
        raise PictureError(f"sonar-angle needs matplotlib: {how}") from error

    pyplot.rcParams["svg.hashsalt"] = "sonar"

    degrees = np.arange(0, 81)
    figure, (above, below) = pyplot.subplots(
        2, 1, sharex=True, figsize=(7, 6), height_ratios=(2, 1), layout="constrained"
    )
    for distance, colour in zip(DISTANCES, ("tab:blue", "tab:orange"), strict=True):
        pairs = np.array([heard(distance, radians(float(angle))) for angle in degrees])
        above.plot(degrees, pairs[:, 0], colour, label=f"heard, wall at {distance:g} m")
        square = [distance * cos(radians(float(angle))) for angle in degrees]
        above.plot(degrees, square, colour, linestyle=":", label="nearest point of the wall")
        above.axhline(distance, color=colour, alpha=0.3, label="along the axis")
        below.plot(degrees, 100 * pairs[:, 1], colour)
    above.set(ylabel="median range [m]", ylim=(0, 2.2), xlim=(0, 80))
    above.legend(fontsize="small", ncols=2, loc="lower left")
    below.set(xlabel="angle between axis and the wall's normal [°]", ylabel="missed [%]")
    figure.savefig(PICTURE, metadata={"Date": None})
    studio.kept("sonar-angle")
