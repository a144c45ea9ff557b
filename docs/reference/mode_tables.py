"""Write the tables of modes in docs/how-to from the modes' descriptions.

uv run docs/reference/mode_tables.py
"""

import re
from pathlib import Path

from docs.reference.protocol_tables import table
from pioneer3.behaviors.modes import MODES
from pioneer3.behaviors.modes.group import GROUP_MODES
from pioneer3.behaviors.modes.mode import Described, ModeParameter
from pioneer3.demo.modes import MODES as DEMO_MODES

PAGES = tuple(
    Path(__file__).parents[1] / "how-to" / name for name in ("behave.md", "demo.md", "together.md")
)
BLOCK = re.compile(r"<!-- made: ([\w ]+) -->\n.*?<!-- end -->\n", re.DOTALL)


def filled(text: str) -> str:
    """Return a page with its table made anew."""

    def made(block: re.Match[str]) -> str:
        return f"<!-- made: {block[1]} -->\n\n{MAKERS[block[1]]()}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


def modes() -> str:
    """Return the modes with their parameters."""
    rows = [row for mode in MODES for row in _rows(mode)]
    return table(("mode", "parameter", "", "default", "range"), rows)


def modes_of_groups() -> str:
    """Return the modes of groups with their parameters."""
    rows = [row for mode in GROUP_MODES for row in _rows(mode)]
    return table(("mode", "parameter", "", "default", "range"), rows)


def modes_of_the_demo() -> str:
    """Return the modes of the demo with their keys."""
    rows = [(f"`{one.key}`", f"{one.name}: {one.hint}", one.needs) for one in DEMO_MODES]
    return table(("key", "mode", "needs, and how the demo knows"), rows)


def _rows(mode: type[Described]) -> list[tuple[str, ...]]:
    first = f"`{mode.name()}`: {mode.summary()}"
    rows = [_parameter(parameter) for parameter in mode.parameters()]
    return [(first if number == 0 else "", *row) for number, row in enumerate(rows)]


def _parameter(one: ModeParameter) -> tuple[str, str, str, str]:
    if one.quantity is None:
        hints = "; ".join(f"`{choice.name}`: {choice.hint}" for choice in one.choices)
        return f"`{one.name}`", hints, str(one.default), ""
    unit = one.quantity.bare
    scale = one.quantity.units[unit]

    def shown(value: float | str | None) -> str:
        return "" if value is None else f"{float(value) / scale:.6g} {unit}"

    low = "above 0" if one.positive else shown(one.low)
    return f"`{one.name}`", one.help, shown(one.default), f"{low} to {shown(one.high)}"


MAKERS = {
    "modes": modes,
    "modes of groups": modes_of_groups,
    "modes of the demo": modes_of_the_demo,
}

if __name__ == "__main__":
    for page in PAGES:
        page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
