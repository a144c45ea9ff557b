"""Pan-tilt-zoom cameras on a serial port, without picture and without the port."""

from pioneer3.sim.firmware.accessories.cameras.canon import CanonVcc4
from pioneer3.sim.firmware.accessories.cameras.mechanism import Gaze, PanTiltZoom
from pioneer3.sim.firmware.accessories.cameras.sony import SonyEvi

__all__ = ["CanonVcc4", "Gaze", "PanTiltZoom", "SonyEvi"]
