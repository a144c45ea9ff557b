"""The interface of every make of camera."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Aim:
    """Direction and zoom: `pan` to the left and `tilt` up [rad], `zoom` 0 wide to 1 tele."""

    pan: float = 0.0
    tilt: float = 0.0
    zoom: float = 0.0


@dataclass(frozen=True, slots=True)
class Reach:
    """The range of an axis, from `low` to `high` [rad]."""

    low: float
    high: float

    def bound(self, angle: float) -> float:
        """Return the nearest angle in range."""
        return max(self.low, min(self.high, angle))


class CameraKind(Protocol):
    """The bytes of one make; angles are in range, zoom is 0 to 1.

    Attributes:
        title: For people.
        pan: Range to the left [rad].
        tilt: Range up [rad].
        position_size: Bytes of the answer to :attr:`where`.
    """

    title: str
    pan: Reach
    tilt: Reach
    position_size: int

    @property
    def where(self) -> bytes:
        """The question for the position."""

    def begin(self) -> Sequence[bytes]:
        """Return the packets that initialise the camera, in order."""

    def look(self, aim: Aim) -> bytes:
        """Return the packet that turns to pan and tilt of `aim`."""

    def zoom(self, aim: Aim) -> bytes:
        """Return the packet that zooms to that of `aim`."""

    def position_in(self, received: bytes) -> bytes | None:
        """Return the answer to :attr:`where` in `received`, or `None`."""

    def read_position(self, answer: bytes) -> tuple[float, float]:
        """Return pan and tilt [rad] of an answer that :meth:`position_in` found."""
