"""What every camera can be told."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Aim:
    """Where a camera looks: `pan` to the left and `tilt` up [rad], `zoom` 0 wide to 1 tele."""

    pan: float = 0.0
    tilt: float = 0.0
    zoom: float = 0.0


@dataclass(frozen=True, slots=True)
class Reach:
    """How far an axis goes, from `low` to `high` [rad]."""

    low: float
    high: float

    def bound(self, angle: float) -> float:
        """Return the angle in reach that is nearest to `angle`."""
        return max(self.low, min(self.high, angle))


class CameraKind(Protocol):
    """The bytes of one make; angles in reach, zoom from 0 to 1.

    Attributes:
        title: For people.
        pan: To the left [rad].
        tilt: Up [rad].
        position_size: Bytes of the answer to :attr:`where`.
    """

    title: str
    pan: Reach
    tilt: Reach
    position_size: int

    @property
    def where(self) -> bytes:
        """Ask for the position."""

    def begin(self) -> Sequence[bytes]:
        """Return what makes the camera obey, one packet after the other."""

    def look(self, aim: Aim) -> bytes:
        """Turn to pan and tilt of `aim`."""

    def zoom(self, aim: Aim) -> bytes:
        """Zoom to that of `aim`."""

    def position_in(self, received: bytes) -> bytes | None:
        """Return the answer to :attr:`where` in `received`, or `None`."""

    def read_position(self, answer: bytes) -> tuple[float, float]:
        """Return pan and tilt [rad] of an answer that :meth:`position_in` found."""
