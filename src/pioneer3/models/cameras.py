"""The makes of cameras that robots carry, as far as their pictures go."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan, pi, tan
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraModel:
    """A make of camera.

    `wide` is the angle from the left edge of the picture to the right one without zoom, `tele` that
    at the end of the zoom [rad].
    """

    title: str
    wide: float
    tele: float

    def view(self, zoom: float) -> float:
        """Return the angle from the left edge to the right one [rad] at `zoom`, 0 wide to 1 tele.

        Equal steps of zoom multiply the focal length by equal factors (an assumption).
        """
        wide, tele = tan(self.wide / 2), tan(self.tele / 2)
        return 2 * atan(wide * (tele / wide) ** zoom)


CAMERAS: Final[Mapping[str, CameraModel]] = MappingProxyType(
    {
        "vcc4": CameraModel(title="Canon VC-C4", wide=48 * pi / 180, tele=3 * pi / 180),
        "sony": CameraModel(title="Sony EVI-D30", wide=48.8 * pi / 180, tele=4.3 * pi / 180),
    }
)
"""By the names that `--fit camera=` takes. The ends are those of the data sheets, from memory."""
