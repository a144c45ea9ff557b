"""The camera of a robot: its pictures, and the motors that turn it."""

import asyncio
from collections.abc import AsyncGenerator
from contextlib import aclosing
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final, Protocol

from pioneer3.errors import DeviceError
from pioneer3.robot.devices.camera import Camera, CameraName
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.supervisor import Supervisor
from pioneer3.state import Picture

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_PIXELS: Final = 1 << 24
"""A larger picture is refused: it may be a few bytes that fill the memory."""
NONE: Final = (
    "No camera with pictures is known: give the URL of its MJPEG stream with --camera, or "
    'connect(..., camera="http://...").'
)


class PictureSource(Protocol):
    """A camera that is read by a driver."""

    @property
    def presence(self) -> Presence:
        """Whether there is one, and its state."""

    def values(self) -> AsyncGenerator[Picture, None]:
        """Yield each picture; the newest when the reader is slow."""

    async def picture(self, max_age: float = ..., patience: float = ...) -> Picture:
        """Return the newest picture."""


@dataclass(frozen=True, slots=True)
class Image:
    """A picture as numbers; `numpy.asarray` takes it too.

    Attributes:
        pixels: Red, green, blue from 0 to 255; rows from above, shape (H, W, 3), uint8.
        stamp: When it was here [s, monotonic], as that of snapshots.
        view: Angle from its left edge to its right one [rad], with the zoom that the camera had;
            `None` where the camera does not tell it. Those of the simulator do.
    """

    pixels: "NDArray[np.uint8]"
    stamp: float
    view: float | None = None

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> "NDArray[Any]":
        """Return the pixels."""
        pixels = self.pixels if dtype is None else self.pixels.astype(dtype, copy=False)
        return pixels.copy() if copy else pixels


def decode(picture: Picture) -> Image:
    """Return a picture as numbers; DeviceError if it is broken, or too large."""
    import numpy as np
    from PIL import Image as Pillow

    try:
        with Pillow.open(BytesIO(picture.jpeg), formats=["JPEG"]) as opened:
            if opened.width * opened.height > MOST_PIXELS:
                raise DeviceError(
                    f"a picture of {opened.width} x {opened.height} pixels: let the camera send "
                    f"smaller ones, of {MOST_PIXELS} pixels at most"
                )
            pixels = np.array(opened.convert("RGB"))  # a copy, which may be changed
    except (
        OSError,
        SyntaxError,
        ValueError,
        Pillow.DecompressionBombError,
        Pillow.DecompressionBombWarning,
    ) as error:
        raise DeviceError(f"the camera sent a broken picture: {error}") from None
    return Image(pixels, picture.stamp, picture.view)


class RobotCamera:
    """The camera of a robot: :meth:`image` and the like read its pictures, :meth:`ptz` turns it.

    Pictures come over the network, from the URL that was given to the connection; pan, tilt and
    zoom go through the robot's own serial port. Either may be missing.
    """

    def __init__(self, supervisor: Supervisor, source: PictureSource | None = None) -> None:
        self._supervisor, self._source = supervisor, source
        self._motors: dict[tuple[CameraName, int], Camera] = {}

    @property
    def presence(self) -> Presence:
        """Whether there are pictures."""
        return self._source.presence if self._source else Presence(False, NONE)

    async def image(self, max_age: float = 1.0, patience: float = 6.0) -> Image:
        """Return the newest picture as an array, with its time; never one older than `max_age` [s].

        Raises:
            DeviceError: None came for `patience` [s], it is broken, or no camera is known.
        """
        return await asyncio.to_thread(decode, await self.picture(max_age, patience))

    async def picture(self, max_age: float = 1.0, patience: float = 6.0) -> Picture:
        """Return the newest picture as JPEG; never one older than `max_age` [s].

        Raises:
            DeviceError: None came for `patience` [s], or no camera is known.
        """
        return await self._known().picture(max_age, patience)

    async def pictures(self) -> AsyncGenerator[Picture, None]:
        """Yield each picture as JPEG, to a slow reader the newest; DeviceError without a camera."""
        async with aclosing(self._known().values()) as values:
            async for picture in values:
                yield picture

    def ptz(self, name: CameraName, port: int = 1) -> Camera:
        """Return pan, tilt and zoom of a camera of this make on AUX `port`, always the same one.

        Raises:
            ConfigError: there is no such make or port.
        """
        if (name, port) not in self._motors:
            self._motors[name, port] = Camera(self._supervisor, name, port)
        return self._motors[name, port]

    def __call__(self, name: CameraName, port: int = 1) -> Camera:
        """Do the same as :meth:`ptz`."""
        return self.ptz(name, port)

    def _known(self) -> PictureSource:
        if self._source is None:
            raise DeviceError(NONE)
        return self._source
