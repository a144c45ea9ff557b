"""An ACTS server for each simulated robot: blobs of the people, boxes and robots it sees."""

import asyncio
import logging
from collections import defaultdict
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from typing import Final

from pioneer3.acts import QUIT, REQUEST, Blob, encode
from pioneer3.sim.eye import Eye, Kind, look
from pioneer3.sim.server.listeners import StreamServer
from pioneer3.sim.server.running import SimulatedRobot
from pioneer3.sim.world import World

log = logging.getLogger(__name__)

CHANNELS: Final[Mapping[Kind, int]] = {"person": 1, "box": 2, "robot": 3}
"""In which channel of ACTS a thing is seen."""
FRAME = 1 / 30
"""Between two pictures [s, real]: clients ask again as soon as they have one."""
MOST_CLIENTS = 8
"""Most clients of one robot's tracker."""
EYE = Eye()


@asynccontextmanager
async def colour_trackers(
    world: World, robots: list[SimulatedRobot], port: int, host: str
) -> AsyncIterator[list[str]]:
    """Serve pictures while the block runs; yield a URL for each of `robots`.

    Each robot has an eye above its front, and looks where its PTZ camera looks. `port` is the TCP
    port of the first, the others have the next ones; 0 takes free ones.

    Raises:
        LinkError: A port cannot be listened on.
    """
    async with AsyncExitStack() as stack:
        servers = [StreamServer(ColourTracker(world, r).serve, most=MOST_CLIENTS) for r in robots]
        yield [
            await stack.enter_async_context(server.at(host, port and port + number))
            for number, server in enumerate(servers)
        ]


class ColourTracker:
    """ACTS for one robot."""

    def __init__(self, world: World, robot: SimulatedRobot) -> None:
        self._world, self._robot = world, robot

    def picture(self) -> bytes:
        """Return the picture of the robot's camera in the protocol of ACTS."""
        camera = self._robot.firmware.accessories.camera
        position = camera.position(self._world.time) if camera else None
        pan, tilt = (position.pan, position.tilt) if position else (0.0, 0.0)
        blobs: dict[int, list[Blob]] = defaultdict(list)
        for patch in look(self._world, self._robot.body, EYE, pan, tilt):
            blobs[CHANNELS[patch.kind]].append(
                Blob(
                    area=patch.area,
                    x=patch.x,
                    y=patch.y,
                    left=patch.left,
                    right=patch.right,
                    top=patch.top,
                    bottom=patch.bottom,
                )
            )
        return encode(blobs)

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer until the client quits or goes; no client ends the simulator."""
        try:
            with suppress(OSError):
                while (said := await reader.read(1)) not in {b"", QUIT}:
                    if said == REQUEST:
                        await asyncio.sleep(FRAME)
                        writer.write(self.picture())
                        await writer.drain()
        except Exception:
            log.exception("the colour tracker of %s failed", self._robot.name)
        finally:
            writer.close()
