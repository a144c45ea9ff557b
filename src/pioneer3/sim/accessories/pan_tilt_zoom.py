"""The three axes of a pan-tilt-zoom camera, which move at constant speed."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PtzPosition:
    """The direction of a camera: `pan` to the left, `tilt` up [rad], `zoom` 0 wide to 1 tele."""

    pan: float
    tilt: float
    zoom: float


class PtzAxis:
    """One axis between two ends, which moves to its target at a positive rate [1/s]."""

    def __init__(self, low: float, high: float, rate: float) -> None:
        self.low, self.high, self.rate = low, high, rate
        self._from = self.target = self._since = 0.0

    def at(self, now: float) -> float:
        """Return the position at `now` [s]."""
        way = self.rate * max(0.0, now - self._since)
        if abs(self.target - self._from) <= way:
            return self.target
        return self._from + (way if self.target > self._from else -way)

    def go(self, target: float, now: float) -> None:
        """Move to `target`, or to the end that lies in between."""
        self._from, self._since = self.at(now), now
        self.target = max(self.low, min(self.high, target))

    def stop(self, now: float) -> None:
        """Stop."""
        self.go(self.at(now), now)

    def arrival(self, now: float) -> float:
        """Return when the target is reached [s], not before `now`."""
        return now + abs(self.target - self.at(now)) / self.rate


class PtzAxes:
    """The three axes of one camera."""

    def __init__(self, pan: PtzAxis, tilt: PtzAxis, zoom: PtzAxis) -> None:
        self.pan, self.tilt, self.zoom = pan, tilt, zoom

    def position(self, now: float) -> PtzPosition:
        """Return where the camera points."""
        return PtzPosition(self.pan.at(now), self.tilt.at(now), self.zoom.at(now))

    def look(self, pan: float, tilt: float, now: float) -> None:
        """Turn to `pan`, `tilt` [rad]."""
        self.pan.go(pan, now)
        self.tilt.go(tilt, now)

    def stop(self, now: float) -> None:
        """Stop turning; the zoom goes on."""
        self.pan.stop(now)
        self.tilt.stop(now)
