"""The same without threads: drive until something is near, in an event loop of your own."""

import asyncio
import sys

from pioneer3 import connect_async


async def main(url: str) -> None:
    """Drive ahead for three seconds, or until the sonar sees something within half a metre."""
    async with connect_async(url) as robot:
        async for snapshot in robot.snapshots(seconds=3):
            if snapshot.sonar.nearest < 0.5:
                break
            robot.drive(0.2)


asyncio.run(main(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101"))
