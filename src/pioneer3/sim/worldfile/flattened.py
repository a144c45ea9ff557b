"""Solids of a world as a plane treats them, in words."""

from collections import Counter
from collections.abc import Iterable

from pioneer3.sim.relief import Solid
from pioneer3.sim.worldfile.spec import WorldFile

_PLURALS = {"mesh": "meshes"}


def flattened(world: WorldFile) -> str:
    """Return the line for a person whose world has solids, but no physics; empty without solids.

    Such as `on a plane 1 ramp and 3 steps are flat floor, and 4 tables are their legs; --physics
    has them in three dimensions`.
    """
    said = []
    if ground := solids_in_words(solid for solid in world.solids if solid.is_ground):
        said.append(_joined(ground) + _are(ground) + "flat floor")
    upright = solids_in_words(solid for solid in world.solids if not solid.is_ground)
    tables = [words for words in upright if words.endswith(("table", "tables"))]
    outlines = [words for words in upright if words not in tables]
    if outlines:
        said.append(_joined(outlines) + _are(outlines) + "walls")
    if tables:
        said.append(f"{tables[0]}{_are(tables)}{'its' if _is_one(tables) else 'their'} legs")
    if not said:
        return ""
    return f"on a plane {_joined(said, ', and ')}; --physics has them in three dimensions"


def solids_in_words(solids: Iterable[Solid]) -> list[str]:
    """Return the number of solids of each kind, such as `3 steps`."""
    counts = Counter(solid.table for solid in solids)
    return [
        f"{count} {table if count == 1 else _PLURALS.get(table, table + 's')}"
        for table, count in counts.items()
    ]


def _joined(parts: list[str], last: str = " and ") -> str:
    return last.join([", ".join(parts[:-1])] * bool(parts[:-1]) + parts[-1:])


def _are(parts: list[str]) -> str:
    return " is " if _is_one(parts) else " are "


def _is_one(parts: list[str]) -> bool:
    return len(parts) == 1 and parts[0].startswith("1 ")
