"""Reasons in words that a person understands."""

from math import degrees

from pioneer3.behaviors.surroundings import Echo

BLIND = "no range sensor works"


def ahead(distance: float, echo: Echo) -> str:
    """Return where an echo is: `distance` [m] from the robot's edge, in its direction."""
    return f"{distance:.2f} m ahead at {round(degrees(echo.bearing))} deg"


def behind(distance: float) -> str:
    """Return how far [m] behind the robot's edge something is."""
    return f"{distance:.2f} m behind"


def beside(distance: float, side: str) -> str:
    """Return how far [m] from the robot's edge something is, and on which side."""
    return f"{distance:.2f} m to the {side}"
