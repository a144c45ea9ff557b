"""Takes pictures of what commands show in a terminal: `pioneer3 demo` and `pioneer3 laser`."""

import asyncio
import io
import re
from dataclasses import replace

from rich.console import Console

from docs.plots.studio import SEED, SIM_PORT, Size, Studio
from pioneer3.cli.laser import FIRST_REACH, view
from pioneer3.demo.app import DemoApp
from pioneer3.demo.drawing import reach_for_points
from pioneer3.demo.modes.sensors import points_in_robot
from pioneer3.demo.program import Program
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.connect import connect_laser_async
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec, WorldFile, parse_equipment

ROBOT = RobotSpec(port=int(SIM_PORT))
WORLD = WorldFile(name="office", map="office", seed=int(SEED), robots=(ROBOT,))
WITH_LASER = replace(WORLD, robots=(replace(ROBOT, equipment=parse_equipment("laser=utm-30lx")),))
DEMO: Size = (92, 26)
LASER: Size = (92, 30)
"""Columns and rows of the terminals."""
WIDTH = 1142
"""Width of a picture of a terminal [px]."""
GROUND = "#121212"
"""Colour of cells in which nothing has been written, as that of the demo."""
WANDERING = 13.0
"""Time until the demo's robot has come to something [s]."""
SETTLING = 2.0
"""Time until the rate of the laser is that of a second [s]."""


async def demo(studio: Studio) -> None:
    """Wander in the simulated office for a while, and show the screen of `pioneer3 demo`."""
    async with simulator(map_name=WORLD, port=0) as running, connect_async(running.url) as robot:
        app = DemoApp(lambda app: Program(robot, app, first="w"))
        async with app.run_test(size=DEMO) as pilot:
            await pilot.pause(WANDERING)
            screen = app.export_screenshot(title="pioneer3 demo")
    await take(studio, "demo", screen)


async def laser(studio: Studio) -> None:
    """Look around in the simulated office, and show what `pioneer3 laser` does."""
    async with simulator(map_name=WITH_LASER, port=0) as running:
        (robot,) = running.robots
        assert robot.laser is not None
        async with connect_async(robot.url), connect_laser_async(robot.laser.url) as connected:
            await asyncio.sleep(SETTLING)
            scan, reach = await connected.reading(), FIRST_REACH
            for _ in range(100):
                reach = reach_for_points(points_in_robot(scan), reach)
            console = Console(file=io.StringIO(), record=True, width=LASER[0], highlight=False)
            console.print(view(connected, scan, *LASER, reach))
    await take(studio, "laser", console.export_svg(title="pioneer3 laser"))


async def take(studio: Studio, name: str, screen: str) -> None:
    """Draw a terminal, an SVG, by the fonts of this computer: those that it names are elsewhere."""
    screen = re.sub(r"@font-face \{.*?\}", "", screen, flags=re.DOTALL)
    page = await studio.open("about:blank")
    await page.set_content(screen.replace('fill="#292929"', f'fill="{GROUND}"'))
    await page.add_style_tag(content="body { margin: 0 } svg { display: block }")
    await page.evaluate(f"document.querySelector('svg').style.width = '{WIDTH}px'")
    await studio.take(page, name, "svg")
