"""Who looks at the page, and who has which wheel."""

from collections.abc import Mapping
from itertools import count
from typing import Any

import msgspec

from pioneer3.web import messages
from pioneer3.web.guest import Guest, Somebody
from pioneer3.web.station import Station


class People:
    """The guests of a page.

    Attributes:
        guests: By number; a number is given once.
        version: Counts the changes of who is here and who has which wheel.
    """

    def __init__(self, stations: Mapping[int, Station]) -> None:
        self.guests: dict[int, Guest] = {}
        self.version = 0
        self._stations = stations
        self._count = count(1)
        self._known: tuple[msgspec.Raw, msgspec.Raw] | None = None

    def enter(self, guest: Guest) -> int:
        """Let `guest` in; return their number."""
        number = next(self._count)
        self.guests[number] = guest
        return number

    def leave(self, number: int) -> Guest:
        """Show a guest out; return them."""
        return self.guests.pop(number)

    def look(self) -> bool:
        """Take note of how it stands now; return whether that is news."""
        guests = [
            {"id": number, "name": guest.name, "role": guest.role.value}
            for number, guest in self.guests.items()
        ]
        wheels = [
            {"robot": station.number, **self.tell_of(holder)}
            for station in self._stations.values()
            if (holder := station.wheel.holder) is not None
        ]
        now = _raw(wheels), _raw(guests)
        if now == self._known:
            return False
        self._known = now
        self.version += 1
        return True

    def told_to(self, number: int) -> str:
        """Return the message for the guest of this number."""
        if self._known is None:
            self.look()
        assert self._known is not None
        return messages.encode(messages.people(self.guests[number], number, *self._known))

    def tell_of(self, who: Somebody | str) -> dict[str, Any]:
        """Say who it is, by number if it is a guest."""
        if isinstance(who, str):
            return messages.somebody(who, None)
        for number, guest in self.guests.items():
            if guest is who:
                return messages.somebody(who.name, number)
        return messages.somebody(who.name, None)

    def guest(self, who: object) -> Guest | None:
        """Return `who` if they are a guest."""
        return next((guest for guest in self.guests.values() if guest is who), None)


def _raw(value: object) -> msgspec.Raw:
    return msgspec.Raw(msgspec.json.encode(value))
