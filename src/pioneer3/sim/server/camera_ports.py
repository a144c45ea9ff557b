"""The cameras of a simulation: their ports, and the process that renders their pictures."""

import asyncio
import logging

from pioneer3.errors import DeviceError
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.physics.dynamics import MujocoDynamics
from pioneer3.sim.server.camera import Shot, SimulatedCamera
from pioneer3.sim.server.listeners import first_free, listening
from pioneer3.sim.server.picture_process import PictureProcess
from pioneer3.sim.world import World

log = logging.getLogger(__name__)

FIRST_PORT = 8181
"""Port of the first camera's pictures; the others have the next free ones."""
STILL = 1.0
"""While time stands a picture is taken so often [s, real]."""
RESTART = 5.0
"""Pause before the process is started again that has ended [s, real]."""


class CameraPorts:
    """All cameras of a simulation whose world has physics.

    With `free` any free port does for a camera whose equipment names none.
    """

    def __init__(self, world: World, host: str, *, free: bool = False) -> None:
        assert isinstance(world.dynamics, MujocoDynamics)
        self.cameras: list[SimulatedCamera] = []
        self._world, self._dynamics = world, world.dynamics
        self._host, self._free = host, free
        self._process = PictureProcess()
        self._wake = asyncio.Event()

    async def add(self, firmware: Firmware, equipment: Equipment) -> SimulatedCamera:
        """Let viewers connect to the camera of a robot.

        With the first camera the process starts that renders pictures.

        Raises:
            DeviceError: OpenGL is missing; the message says what to install.
            PortBusyError: Another program listens at its port, or at all usual ones.
            LinkError: It cannot listen.
        """
        if not self._process.backend:
            await self._process.start()
        camera = SimulatedCamera(self._dynamics, firmware, equipment, self._wake.set)
        number = 0 if self._free else None
        if equipment.picture_port is not None:
            number = equipment.picture_port
        if number is None:
            listener = await first_free(self._host, FIRST_PORT)
        else:
            listener = await listening(self._host, number)
        await camera.listen(listener, lambda: self._world.time)
        self.cameras.append(camera)
        return camera

    def remove(self, camera: SimulatedCamera) -> None:
        """Cut off the viewers of a camera and close its port."""
        self.cameras.remove(camera)
        camera.close()

    def tick(self, now: float) -> None:
        """Take the pictures that are due at `now` [s, simulated]."""
        for camera in self.cameras:
            camera.tick(now)

    async def close(self) -> None:
        """Cut off all viewers, close all ports and end the process."""
        for camera in self.cameras:
            camera.close()
        await self._process.close()

    async def run(self) -> None:
        """Render pictures, one after the other, until cancelled; then close everything."""
        try:
            while True:
                await self._woken()
                for camera in self.cameras[:]:
                    if camera.shot is not None:
                        await self._render(camera, camera.shot)
        finally:
            await self.close()

    async def _render(self, camera: SimulatedCamera, shot: Shot) -> None:
        try:
            camera.publish(shot, await self._process.picture(shot.instant, shot.asked))
        except DeviceError as error:
            camera.publish(shot, None)
            log.warning("a camera has no picture: %s", error)
            await asyncio.sleep(RESTART)
            try:
                await self._process.start()
            except DeviceError as problem:
                log.warning("%s", problem)

    async def _woken(self) -> None:
        """Wait for a picture to render; while time stands, take one now and then."""
        before = self._world.time
        try:
            async with asyncio.timeout(STILL):
                await self._wake.wait()
        except TimeoutError:
            stands = self._world.time == before
            for camera in self.cameras:
                if stands and camera.wanted:
                    camera.shoot(before)
        self._wake.clear()
