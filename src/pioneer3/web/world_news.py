"""What has changed in the simulated world, for pages that are more or less up to date."""

from dataclasses import dataclass
from typing import Any

from pioneer3.web.messages import encode
from pioneer3.web.world import Placed, WorldView

MOST_GONE = 1000
"""So many things that are gone are remembered; who missed more of them is told all anew."""


@dataclass(slots=True)
class _Known:
    """A thing, where it is, and since which versions it is so."""

    thing: dict[str, Any]
    place: Placed
    described: int
    moved: int


class WorldNews:
    """Looks at a world, and tells what is new since any of its looks."""

    def __init__(self, view: WorldView) -> None:
        self.version = 0
        self._view = view
        self._known: dict[int, _Known] = {}
        self._gone: dict[int, int] = {}
        self._complete_since = 0
        self._clock: dict[str, Any] | None = None
        self._texts: dict[int, list[str]] = {}

    def look(self) -> bool:
        """Take note of how the world is now; return whether that is news."""
        clock, next_ = self._view.clock(), self.version + 1
        changed = clock != self._clock
        self._clock = clock
        there = self._view.items
        for item, number in there.items():
            changed |= self._note(number, self._view.describe(item), self._view.placed(item), next_)
        for number in self._known.keys() - there.values():
            del self._known[number]
            self._gone[number] = next_
            changed = True
        if changed:
            self.version = next_
            self._texts.clear()
            self._forget_long_gone()
        return changed

    def since(self, seen: int) -> list[str]:
        """Return the message for who knows version `seen`; nothing if that is this one."""
        if seen == self.version:
            return []
        if seen not in self._texts:
            self._texts[seen] = [encode(self._message(seen))]
        return self._texts[seen]

    def _message(self, seen: int) -> dict[str, Any]:
        """`things` are new or have changed, `moved` are only elsewhere; the first has them all."""
        first = seen == 0 or seen < self._complete_since
        things, moved = [], []
        for number, known in self._known.items():
            if first or known.described > seen:
                things.append({"id": number, **known.thing, "pose": known.place})
            elif known.moved > seen:
                moved.append((number, *known.place))
        gone = [number for number, version in self._gone.items() if version > seen]
        return {
            "type": "world",
            "all": first,
            "things": things,
            "moved": moved,
            "gone": [] if first else gone,
            "clock": self._clock,
        }

    def _note(self, number: int, thing: dict[str, Any], place: Placed, version: int) -> bool:
        known = self._known.get(number)
        if known is None or known.thing != thing:
            self._known[number] = _Known(thing, place, version, version)
        elif known.place != place:
            known.place, known.moved = place, version
        else:
            return False
        return True

    def _forget_long_gone(self) -> None:
        while len(self._gone) > MOST_GONE:
            number = next(iter(self._gone))
            self._complete_since = self._gone.pop(number)
