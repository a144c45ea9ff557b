"""Take the picture of the demo's screen for docs/images: `python docs/plots/demo.py demo.svg`."""

import asyncio
import sys
from pathlib import Path

from pioneer3.demo.app import DemoApp
from pioneer3.demo.program import Program
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.start import simulator

SIZE = (92, 26)
SECONDS = 13.0


async def screenshot() -> str:
    """Wander in the simulated office for a while; return what the screen shows, as SVG."""
    async with simulator(port=0) as running, connect_async(running.url) as robot:
        app = DemoApp(lambda app: Program(robot, app, first="w"))
        async with app.run_test(size=SIZE) as pilot:
            await pilot.pause(SECONDS)
            return app.export_screenshot(title="pioneer3 demo")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(asyncio.run(screenshot()))
