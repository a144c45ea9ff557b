"""Pictures of the camera to ROS messages (REP 103, REP 104)."""

from math import tan
from typing import Any, Final

from pioneer3.ros.messages.update import PictureUpdate, fill_header

CHANNELS: Final = 3
"""Bytes of a pixel in `rgb8`."""
MODEL: Final = "plumb_bob"
"""Model of a lens, with as many numbers as :data:`PERFECT`."""
PERFECT: Final = [0.0] * 5
"""A lens without distortion."""


def image(message: Any, update: PictureUpdate) -> None:
    """Fill a sensor_msgs/Image as `rgb8`."""
    pixels = update.image.pixels
    fill_header(message, update.stamp, update.frame)
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.is_bigendian = "rgb8", 0
    message.step = CHANNELS * message.width
    message.data = pixels.tobytes()


def camera_info(message: Any, update: PictureUpdate) -> None:
    """Fill a sensor_msgs/CameraInfo of a pinhole without distortion.

    Its matrices are 0, which means that it is not calibrated, where nobody tells the field of view.
    """
    fill_header(message, update.stamp, update.frame)
    message.height, message.width = height, width = update.image.pixels.shape[:2]
    message.distortion_model, message.D = MODEL, list(PERFECT)
    message.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    message.K, message.P = [0.0] * 9, [0.0] * 12
    if update.view is None:
        return
    focal = width / 2 / tan(update.view / 2)
    x, y = (width - 1) / 2, (height - 1) / 2  # the middle of the first pixel is at 0, 0
    message.K = [focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0]
    message.P = [focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0]
