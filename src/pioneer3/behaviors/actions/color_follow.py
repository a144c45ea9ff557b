"""Drive after something of one colour."""

from dataclasses import dataclass, field
from math import inf, radians
from typing import Protocol

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation


@dataclass(frozen=True, slots=True, kw_only=True)
class Blob:
    """A patch of one colour in a picture.

    Attributes:
        x: Of its middle, -1 at the left edge to 1 at the right.
        y: -1 at the lower edge to 1 at the upper.
        area: Share of the picture, 0 to 1.
        stamp: When the picture was taken [s, monotonic].
    """

    x: float
    y: float = 0.0
    area: float = 0.0
    stamp: float


class BlobSource(Protocol):
    """Whoever finds patches of colour in the picture of the robot's camera."""

    def largest(self, channel: int) -> Blob | None:
        """Return the largest patch of a trained colour last seen, or `None`."""


@dataclass(slots=True)
class ColorFollow:
    """Drives on and keeps a patch of colour in the middle; ARIA's example of ACTS, in our figures.

    It moves only while `moving`. When nothing is seen it stands, or turns to look for it while
    `acquiring`, towards where it was last.

    Attributes:
        source: Finds the patches.
        channel: Which colour.
        speed: [m/s].
        turn_max: With the patch at the edge of the picture, ahead of the present heading [rad].
        dead_band: Nearer to the middle it drives straight ahead; share of half a picture.
        patience: A patch not seen for this long is lost [s].
        search_rate: When looking for one [rad/s].
        moving: Whether it drives.
        acquiring: Whether it looks for what it has lost.
    """

    source: BlobSource
    channel: int = 1
    speed: float = 0.2
    turn_max: float = radians(10)
    dead_band: float = 0.2
    patience: float = 2.0
    search_rate: float = radians(10)
    moving: bool = False
    acquiring: bool = False
    name: str = "color follow"
    _seen: float = field(default=-inf, init=False)
    _side: int = field(default=1, init=False)

    def decide(self, situation: Situation) -> Desire:
        """Return speed and turn towards the patch."""
        blob = self.source.largest(self.channel)
        if blob is not None and situation.now - blob.stamp <= self.patience:
            return self._follow(blob)
        if self.moving and self.acquiring:
            return Desire(v=0.0, w=self._side * self.search_rate, reason="looking for the colour")
        return Desire(v=0.0, turn=0.0, reason="no blob in sight")

    def _follow(self, blob: Blob) -> Desire:
        if blob.x:
            self._side = -1 if blob.x > 0 else 1
        if not self.moving:
            return Desire(v=0.0, turn=0.0, reason="blob in sight, movement off")
        turn = -blob.x * self.turn_max if abs(blob.x) > self.dead_band else 0.0
        return Desire(v=self.speed, turn=turn, reason=f"blob at {round(100 * blob.x)} %")
