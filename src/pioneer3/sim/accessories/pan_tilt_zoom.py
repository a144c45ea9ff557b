"""Where a pan-tilt-zoom camera looks: three axes that move at constant speed."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Gaze:
    """Where a camera looks: `pan` to the left and `tilt` up [rad], `zoom` 0 wide to 1 tele."""

    pan: float
    tilt: float
    zoom: float


class Slew:
    """One axis between two ends.

    Attributes:
        low: Lower end.
        high: Upper end.
        rate: Speed [1/s], positive.
    """

    def __init__(self, low: float, high: float, rate: float) -> None:
        self.low, self.high, self.rate = low, high, rate
        self._from = self._to = 0.0
        self._since = 0.0

    def at(self, now: float) -> float:
        """Return the position at `now` [s]."""
        way = self.rate * max(0.0, now - self._since)
        if abs(self._to - self._from) <= way:
            return self._to
        return self._from + (way if self._to > self._from else -way)

    @property
    def target(self) -> float:
        """Where it moves to."""
        return self._to

    def go(self, target: float, now: float) -> None:
        """Move to `target`, or to the end that lies in between."""
        self._from, self._since = self.at(now), now
        self._to = max(self.low, min(self.high, target))

    def stop(self, now: float) -> None:
        """Stand."""
        self.go(self.at(now), now)

    def arrival(self, now: float) -> float:
        """Return when the target is reached [s], not before `now`."""
        return now + abs(self._to - self.at(now)) / self.rate


class PanTiltZoom:
    """The three axes of one camera."""

    def __init__(self, pan: Slew, tilt: Slew, zoom: Slew) -> None:
        self.pan, self.tilt, self.zoom = pan, tilt, zoom

    def gaze(self, now: float) -> Gaze:
        """Return where the camera looks."""
        return Gaze(self.pan.at(now), self.tilt.at(now), self.zoom.at(now))

    def look(self, pan: float, tilt: float, now: float) -> None:
        """Turn to `pan`, `tilt` [rad]."""
        self.pan.go(pan, now)
        self.tilt.go(tilt, now)

    def stop(self, now: float) -> None:
        """Stop turning; the zoom goes on."""
        self.pan.stop(now)
        self.tilt.stop(now)
