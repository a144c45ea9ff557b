"""Pan-tilt-zoom cameras: what they are told, as bytes; pure."""

from pioneer3.runtime.devices.cameras.base import Aim, CameraKind
from pioneer3.runtime.devices.cameras.canon import CanonVcc4
from pioneer3.runtime.devices.cameras.sony import SonyEvi

__all__ = ["Aim", "CameraKind", "CanonVcc4", "SonyEvi"]
