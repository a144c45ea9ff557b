"""No faster than there is room for."""

from dataclasses import dataclass

from pioneer3.behaviors.actions.reasons import BLIND, ahead, behind
from pioneer3.behaviors.actions.table import table_seen
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.surroundings import Recall


@dataclass(slots=True)
class LimiterForwards:
    """Limits the speed forwards by what is ahead within the robot's width (arcos.md 7.6).

    Attributes:
        stop_distance: Nearer than this to the robot's front it may not go [m].
        slow_distance: Farther than this it may go at any speed [m].
        slow_speed: At `slow_distance` [m/s]; from there down to 0 at `stop_distance`.
        width_ratio: Width looked at over the robot's.
    """

    stop_distance: float = 0.25
    slow_distance: float = 1.0
    slow_speed: float = 0.2
    width_ratio: float = 1.0
    name: str = "limiter forwards"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit; without range sensors, no motion."""
        if not situation.around.sensing:
            return Desire(v_max=0.0, reason=BLIND)
        model = situation.model
        side, front = model.width / 2 * self.width_ratio, model.length / 2
        reach = max(self.stop_distance, self.slow_distance) + front
        echo = situation.around.nearest_in_box(0.0, -side, reach, side, Recall.LATELY)
        distance = echo.distance - front
        if distance > self.slow_distance:
            return None
        share = _share(distance, self.stop_distance, self.slow_distance)
        return Desire(v_max=self.slow_speed * share, reason=ahead(distance, echo))


@dataclass(slots=True)
class LimiterBackwards:
    """Limits the speed backwards by what is behind within one and a half widths (arcos.md 7.6).

    Distances are positive here. It looks as far as `slow_distance`; ARIA's box ends at
    `stop_distance` behind the robot, so that it slows down for nothing farther away.

    Attributes:
        stop_distance: Nearer than this to the robot's circle it may not go [m].
        slow_distance: Farther than this it may go at `max_speed` [m].
        max_speed: [m/s], even when nothing is seen; down to 0 at `stop_distance`.
        width_ratio: Width looked at over the robot's.
    """

    stop_distance: float = 0.25
    slow_distance: float = 0.6
    max_speed: float = 0.25
    width_ratio: float = 1.5
    name: str = "limiter backwards"

    def decide(self, situation: Situation) -> Desire:
        """Return the limit; without range sensors, no motion."""
        if not situation.around.sensing:
            return Desire(back_max=0.0, reason=BLIND)
        model = situation.model
        side = model.width / 2 * self.width_ratio
        reach = max(self.stop_distance, self.slow_distance) + max(model.length, model.radius)
        echo = situation.around.nearest_in_box(0.0, -side, -reach, side, Recall.LATELY)
        distance = echo.distance - model.radius
        if distance > self.slow_distance:
            return Desire(back_max=self.max_speed, reason="nothing behind")
        share = _share(distance, self.stop_distance, self.slow_distance)
        return Desire(back_max=self.max_speed * share, reason=behind(distance))


@dataclass(slots=True)
class LimiterTableSensor:
    """Lets nobody drive on under a table (arcos.md 7.6)."""

    name: str = "limiter table sensor"

    def decide(self, situation: Situation) -> Desire | None:
        """Return no speed forwards while a table is seen."""
        table = table_seen(situation)
        return Desire(v_max=0.0, reason=str(table)) if table else None


def _share(distance: float, stop: float, slow: float) -> float:
    """Return how far between the two `distance` is, 0 to 1."""
    return 0.0 if distance < stop or slow <= stop else (distance - stop) / (slow - stop)
