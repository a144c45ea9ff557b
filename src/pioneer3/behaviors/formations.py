"""Formations: the places of robots beside and behind their leader."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import dist
from typing import Final

Place = tuple[float, float]
"""x ahead of the leader, y to its left [m]."""


@dataclass(frozen=True, slots=True)
class Formation:
    """An arrangement of robots, its shape in a few words.

    `place` returns the place of a follower, in spacings; followers count from 1.
    """

    name: str
    doing: str
    place: Callable[[int], Place]

    def places(self, followers: int, spacing: float) -> list[Place]:
        """Return the places of so many followers, `spacing` [m] from each to the next."""
        places = [self.place(number) for number in range(1, followers + 1)]
        return [(x * spacing, y * spacing) for x, y in places]


def _side(number: int) -> tuple[int, int]:
    """Return the rank of a follower, from 1, and its side: the first goes to the left."""
    return (number + 1) // 2, 1 if number % 2 else -1


def _line(number: int) -> Place:
    rank, side = _side(number)
    return 0.0, float(side * rank)


def _wedge(number: int) -> Place:
    rank, side = _side(number)
    return -float(rank), float(side * rank)


def _column(number: int) -> Place:
    return -float(number), 0.0


FORMATIONS: Final = {
    each.name: each
    for each in (
        Formation("line", "side by side, the leader in the middle", _line),
        Formation("wedge", "in two rows that open behind the leader", _wedge),
        Formation("column", "one behind the other, on the leader's track", _column),
    )
}

MOST_TRIED: Final = 7
"""Robots of which all orders are tried at most: 5040 of them."""


def assigned(robots: Sequence[Place], places: Sequence[Place]) -> list[int]:
    """Return the number of the place for each robot, from 0, so that their ways are short.

    There are as many places, in the same frame. The sum of the squared distances is the least; ways
    that are the shortest together do not cross. Of more than :data:`MOST_TRIED` robots, the pairs
    that are nearest are matched first.
    """
    numbers = range(len(robots))
    if len(robots) <= MOST_TRIED:
        orders = permutations(numbers)
        best = min(
            orders,
            key=lambda order: sum(
                dist(robots[robot], places[place]) ** 2 for robot, place in enumerate(order)
            ),
        )
        return list(best)
    pairs = sorted((dist(robots[a], places[b]), a, b) for a in numbers for b in numbers)
    matched: dict[int, int] = {}
    for _, robot, place in pairs:
        if robot not in matched and place not in matched.values():
            matched[robot] = place
    return [matched[robot] for robot in numbers]
