"""Where an action is going to, for people to look at."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """A place in odometry's frame.

    Attributes:
        x: [m].
        y: [m].
        heading: To turn to there [rad], or `None`.
        person: Somebody is taken to be there, and is followed.
    """

    x: float
    y: float
    heading: float | None = None
    person: bool = False
