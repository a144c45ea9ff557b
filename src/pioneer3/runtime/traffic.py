"""The robots of this program on one map, which keep out of each other's ways."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.nav.traffic import Traveller


class Navigating(Protocol):
    """A robot that takes part in the traffic."""

    @property
    def line_map(self) -> "LineMap":
        """Its map."""

    @property
    def traveller(self) -> "Traveller | None":
        """Where it is and goes; `None` while it is not sure where it is."""


class Traffic:
    """All robots that know of each other."""

    def __init__(self) -> None:
        self._members: list[Navigating] = []

    @contextmanager
    def joined(self, member: Navigating) -> Iterator[None]:
        """Let `member` take part during the block."""
        self._members.append(member)
        try:
            yield
        finally:
            self._members.remove(member)

    def others(self, member: Navigating) -> "list[Traveller]":
        """Return the other robots on the same map, those of which it is known where they are."""
        return [other for each in self._members if (other := self._beside(member, each))]

    def ahead_of(self, member: Navigating) -> "list[Traveller]":
        """Return the other robots that are on their way and go before `member`.

        The one that set out first does; of two that set out at once, the one that joined first.
        """
        mine = member.traveller
        if mine is None:
            return []
        number = self._members.index(member)
        return [
            other
            for at, each in enumerate(self._members)
            if (other := self._beside(member, each))
            and len(other.way)
            and (other.since, at) < (mine.since, number)
        ]

    def _beside(self, member: Navigating, each: Navigating) -> "Traveller | None":
        same = each is not member and each.line_map is member.line_map
        return each.traveller if same else None
