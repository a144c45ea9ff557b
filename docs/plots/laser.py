"""Take the picture of `pioneer3 laser` for docs/images: `python docs/plots/laser.py laser.svg`."""

import asyncio
import io
import sys
from pathlib import Path

from rich.console import Console

from pioneer3.cli.laser import FIRST_REACH, view
from pioneer3.demo.drawing import reach_for_points
from pioneer3.demo.modes.sensors import points_in_robot
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.connect import connect_laser_async
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec, WorldFile, parse_equipment

WORLD = WorldFile(
    name="office",
    map="office",
    robots=(RobotSpec(port=0, equipment=parse_equipment("laser=utm-30lx")),),
)
COLUMNS, ROWS = 92, 30
SETTLING = 2.0
"""Until the rate is that of a second, and the reach is steady [s]."""


async def screenshot() -> str:
    """Look around in the simulated office; return what the terminal shows, as SVG."""
    async with simulator(map_name=WORLD, port=0) as running:
        (robot,) = running.robots
        assert robot.laser is not None
        async with connect_async(robot.url), connect_laser_async(robot.laser.url) as laser:
            await asyncio.sleep(SETTLING)
            scan, reach = await laser.reading(), FIRST_REACH
            for _ in range(100):
                reach = reach_for_points(points_in_robot(scan), reach)
            console = Console(file=io.StringIO(), record=True, width=COLUMNS, highlight=False)
            console.print(view(laser, scan, COLUMNS, ROWS, reach))
            return console.export_svg(title="pioneer3 laser")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(asyncio.run(screenshot()))
