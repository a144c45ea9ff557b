"""Write the tables of the fleet file and of `fleet list` in docs/reference/fleet.md.

uv run python -m docs.reference.fleet_tables
"""

import re
from inspect import getdoc
from pathlib import Path

from docs.reference.protocol_tables import table
from pioneer3.fleet.columns import COLUMNS, LIVE_COLUMNS
from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import Defaults, FleetRobot, OperatorComputer
from pioneer3.tables import keys

PAGE = Path(__file__).parent / "fleet.md"
BLOCK = re.compile(r"<!-- made: ([\w ]+) -->\n.*?<!-- end -->\n", re.DOTALL)
USUAL = {
    "name": "",
    "address": "",
    "host": "`name`",
    "node": "`RosAria_` and `name`, in ROS 2 `name` and `/pioneer3`, `-` as `_`",
}
"""Defaults of robots' keys that are not in `[defaults]`."""


def filled(text: str) -> str:
    """Return the page with its tables made anew."""

    def made(block: re.Match[str]) -> str:
        return f"<!-- made: {block[1]} -->\n\n{MAKERS[block[1]]()}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


def meanings(described: type) -> dict[str, str]:
    """Return the meaning of each attribute, as its class has it."""
    text = (getdoc(described) or "").partition("Attributes:\n")[2]
    entries = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", text, re.MULTILINE)
    return {name: " ".join(told.split()) for name, told in entries}


def robot() -> str:
    """Return the keys of `[[robot]]`."""
    told, usual = meanings(FleetRobot), Defaults()
    rows = []
    for key in keys(FleetRobot):
        default = getattr(usual, key, "")
        shown = USUAL.get(key, f"`{default}`" if default else "")
        rows.append((f"`{key}`", told[key], "needed" if key in {"name", "address"} else shown))
    return table(("key", "meaning", "default"), rows)


def operator() -> str:
    """Return the keys of `[operator]`."""
    told = meanings(OperatorComputer)
    return table(("key", "meaning"), [(f"`{key}`", told[key]) for key in keys(OperatorComputer)])


def network() -> str:
    """Return the keys of `[[network]]`."""
    told, usual = meanings(FleetNetwork), FleetNetwork(name="")
    rows = []
    for key in keys(FleetNetwork):
        default = getattr(usual, key)
        shown = f"`{default}`" if isinstance(default, str) and default else ""
        rows.append((f"`{key}`", told[key], "needed" if key == "name" else shown))
    return table(("key", "meaning", "default"), rows)


def defaults() -> str:
    """Return the keys of `[defaults]`."""
    return ", ".join(f"`{key}`" for key in keys(Defaults))


def columns() -> str:
    """Return the columns of `fleet list`."""
    rows = [(one.title, one.meaning) for one in COLUMNS]
    rows += [(one.title, one.meaning) for one in LIVE_COLUMNS]
    return table(("column", "meaning"), rows)


MAKERS = {
    "robot": robot,
    "operator": operator,
    "network": network,
    "defaults": defaults,
    "columns": columns,
}

if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
