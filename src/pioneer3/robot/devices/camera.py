"""A pan-tilt-zoom camera on one of the robot's serial ports (facts.md 8.6)."""

import asyncio
from collections.abc import Sequence
from contextlib import suppress
from math import isfinite
from typing import Literal, get_args

from pioneer3.errors import CommandError, ConfigError, DeviceError
from pioneer3.robot.devices.aux_port import AuxPort
from pioneer3.robot.devices.camera_kind import Aim, CameraKind, CanonVcc4, SonyEvi
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.supervisor import Supervisor

CameraName = Literal["sony", "vcc4", "vcc4-inverted"]
"""Kinds of cameras that pan, tilt and zoom."""
UNDOCUMENTED = ("dpptu", "amptu")
PAUSE = 0.1
"""Pause between the first packets [s]: a camera answers one before it takes the next."""
CORNER = 7.0
"""Time of the exercise in each corner [s] (facts.md 8.6)."""


def kind_of(name: str) -> CameraKind:
    """Return the camera of this name; ConfigError if there is none."""
    match name:
        case "sony":
            return SonyEvi()
        case "vcc4":
            return CanonVcc4()
        case "vcc4-inverted":
            return CanonVcc4(inverted=True)
    if name in UNDOCUMENTED:
        raise ConfigError(f"camera {name}: the bytes of this pan-tilt unit are not documented here")
    raise ConfigError(f"camera {name!r}: there are {', '.join(get_args(CameraName))}")


class Camera:
    """A camera that turns and zooms; call :meth:`connect` first. `aim` is what was asked last.

    Every command raises a CommandError where no robot is connected, or a number is not finite.
    """

    def __init__(self, supervisor: Supervisor, name: CameraName, port: int = 1) -> None:
        self.kind = kind_of(name)
        self.aim = Aim()
        self._port = AuxPort(supervisor, port)
        self._answers: bool | None = None

    @property
    def presence(self) -> Presence:
        """Whether there is one: CONFIG lists no cameras, only their answers show it."""
        device = f"{self.kind.title} on AUX{self._port.number}"
        if self._answers is None:
            return Presence(None, f"Nobody has asked the {device} yet: CONFIG does not tell of it.")
        if self._answers:
            return Presence(True, f"The {device} answers.")
        return Presence(False, f"The {device} does not answer: is it this port, and switched on?")

    async def connect(self) -> Aim:
        """Initialise the camera; return its direction and zoom; DeviceError without an answer."""
        for packet in self.kind.begin():
            self._port.write(packet)
            await asyncio.sleep(PAUSE)
        return await self.where()

    async def where(self) -> Aim:
        """Ask for the direction; return it with the last commanded zoom; DeviceError if silent."""
        try:
            answer = await self._port.ask(
                self.kind.where,
                self.kind.position_in,
                self.kind.position_size,
                name=f"the {self.kind.title}",
            )
        except DeviceError:
            self._answers = False
            raise
        self._answers = True
        pan, tilt = self.kind.read_position(answer)
        return Aim(pan, tilt, self.aim.zoom)

    def look(self, pan: float, tilt: float) -> None:
        """Turn to `pan` to the left and `tilt` up [rad], as far as it goes."""
        _finite(pan, tilt)
        wanted = Aim(self.kind.pan.bound(pan), self.kind.tilt.bound(tilt), self.aim.zoom)
        self._port.write(self.kind.look(wanted))
        self.aim = wanted

    def turn(self, pan: float = 0.0, tilt: float = 0.0) -> None:
        """Turn by `pan` to the left and `tilt` up [rad], from the last commanded direction."""
        self.look(self.aim.pan + pan, self.aim.tilt + tilt)

    def zoom(self, share: float) -> None:
        """Zoom to `share` of its range, 0 wide to 1 tele."""
        _finite(share)
        wanted = Aim(self.aim.pan, self.aim.tilt, max(0.0, min(1.0, share)))
        self._port.write(self.kind.zoom(wanted))
        self.aim = wanted

    def centre(self) -> None:
        """Look straight ahead, wide."""
        self.look(0.0, 0.0)
        self.zoom(0.0)

    async def exercise(self) -> None:
        """Look into the corners, clockwise from the upper left, then ahead, until cancelled.

        Each takes 7 s; every 35 s the zoom goes to its other end.
        """
        while True:
            for place in self._corners():
                with suppress(CommandError):  # without a link the camera stays
                    self.look(*place)
                await asyncio.sleep(CORNER)
            with suppress(CommandError):
                self.zoom(0.0 if self.aim.zoom > 0.5 else 1.0)

    def _corners(self) -> Sequence[tuple[float, float]]:
        pan, tilt = self.kind.pan, self.kind.tilt
        left, right, up, down = pan.high, pan.low, tilt.high, tilt.low
        return (left, up), (right, up), (right, down), (left, down), (0.0, 0.0)


def _finite(*numbers: float) -> None:
    if not all(map(isfinite, numbers)):
        raise CommandError(f"a camera cannot be told {', '.join(map(str, numbers))}")
