"""Steps of a calibration: what each drives, the room it takes, and what is measured after it."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import floor, pi

from pioneer3.calibration.course import CLEARANCE, CourseLeg, ground_of
from pioneer3.geometry import Extent
from pioneer3.models import RobotModel

ROOM = 2.0
"""Side of the free floor that is asked for [m]."""
FULL_TURNS = 3
"""Full turns each way beside a wall."""
LOOKS = 6
"""Stands of a full turn in which a laser looks."""


class By(StrEnum):
    """Means to measure the end of a step."""

    TAPE = "tape"
    SONAR = "sonar"
    LASER = "laser"


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationStep:
    """A step of a calibration.

    Attributes:
        name: Unique in its plan.
        title: For people.
        by: What measures it.
        legs: To drive.
        room: Ground that has to be free, ahead and to the left of the robot [m].
        asks: The numbers that a person measures, of :data:`QUESTIONS`.
        square: Side of the square that it is [m], or 0.
        left: Whether the square is driven counter-clockwise.
    """

    name: str
    title: str
    by: By
    legs: Sequence[CourseLeg]
    room: Extent
    asks: Sequence[str] = ()
    square: float = 0.0
    left: bool = True

    @property
    def needs(self) -> str:
        """The sentences about its room and its preparations."""
        room = self.room
        words = (
            f"It takes {max(0.0, room.x_max):.1f} m ahead, {max(0.0, -room.x_min):.1f} m behind, "
            f"{room.y_max:.1f} m to the left and {-room.y_min:.1f} m to the right of its middle."
        )
        if self.by is By.TAPE:
            words += " Mark where the robot's middle is and where it looks: measure from that mark."
        return words


QUESTIONS = {
    "way": "How far did it drive in truth",
    "aside": "How far is it beside the line, to the left (to the right: with a minus)",
    "ahead": "How far is it ahead of the mark (behind it: with a minus)",
    "left": "How far is it to the left of the mark (to the right: with a minus)",
    "turned": "By how many degrees does it look to the left of the mark (to the right: minus)",
}
"""Questions about the end of a step, all about its beginning."""
OPTIONAL = {"aside", "turned"}
"""Those that need no answer."""
ANGLES = {"turned"}
"""Those that are about angles; the others are about lengths."""


def usual_side(model: RobotModel) -> float:
    """Return the side of a square that fits the floor that is asked for [m]."""
    return floor(10 * (ROOM - 2 * (model.corner + CLEARANCE))) / 10


def plan(
    model: RobotModel, side: float, length: float, rounds: int, *, by_laser: bool, by_sonar: bool
) -> tuple[CalibrationStep, ...]:
    """Return the steps for a robot: a line of some `length`, and squares of one `side` [m].

    Squares are driven so many `rounds`, each both ways, over the same ground.
    """
    reach = model.corner + CLEARANCE
    around = ground_of(model, 0.0)
    ground = Extent(-reach, -reach, side + reach, side + reach)
    steps = []
    for left, word in ((True, "left"), (False, "right")):
        sign = 1 if left else -1
        if by_laser:
            legs = [CourseLeg(turn=sign * 2 * pi / LOOKS)] * LOOKS
            title = f"a full turn to the {word}, in parts"
            steps.append(
                CalibrationStep(
                    name=f"turn {word}", title=title, by=By.LASER, legs=legs, room=around
                )
            )
        elif by_sonar:
            legs = [CourseLeg(turn=sign * 2 * pi * FULL_TURNS)]
            title = f"{FULL_TURNS} full turns to the {word}, with its side half a metre from a wall"
            steps.append(
                CalibrationStep(
                    name=f"turn {word}", title=title, by=By.SONAR, legs=legs, room=around
                )
            )
    by, asks = (By.LASER, ()) if by_laser else (By.TAPE, ("ahead", "left", "turned"))
    corner = [CourseLeg(way=side), CourseLeg(turn=-pi / 2)] * 4
    ways = (
        (True, "left", [CourseLeg(way=side), CourseLeg(turn=pi / 2)] * 4),
        (False, "right", [CourseLeg(turn=pi / 2), *corner, CourseLeg(turn=-pi / 2)]),
    )
    for number in range(1, rounds + 1):
        for left, word, legs in ways:
            steps.append(
                CalibrationStep(
                    name=f"square {word} {number}" if rounds > 1 else f"square {word}",
                    title=f"a square of {side:g} m to the {word}, back to the mark",
                    by=by,
                    legs=legs,
                    room=ground,
                    asks=asks,
                    square=side,
                    left=left,
                )
            )
    steps.append(
        CalibrationStep(
            name="straight",
            title=f"{length:g} m straight ahead",
            by=by,
            legs=[CourseLeg(way=length)],
            room=Extent(0.0, -reach, length + model.length_front + CLEARANCE, reach),
            asks=() if by_laser else ("way", "aside"),
        )
    )
    return tuple(steps)
