"""Write the tables of docs/reference/lasers.md from the models of lasers.

    uv run python -m docs.reference.laser_tables

A line `<!-- made: what -->` begins a table; whatever follows it up to `<!-- end -->` is replaced.
"""

import re
from math import degrees, isinf
from pathlib import Path

from docs.reference.protocol_tables import BLOCK, mm, table
from pioneer3.models.lasers import LASERS, LaserModel, RangeError
from pioneer3.robot.lasers.search import SPEEDS

PAGE = Path(__file__).with_name("lasers.md")
MODELS = tuple(LASERS.values())


def name(model: LaserModel) -> str:
    """Return the name in options."""
    return f"`{model.name}`"


def fields() -> str:
    """Return the field, ranges and times of each model."""
    rows = [
        (
            name(model),
            model.title,
            f"{degrees(model.first):.5g} to {degrees(model.last):.5g}",
            f"{degrees(model.step):.4g}",
            model.count,
            f"{model.near:g} to {model.far:g}",
            f"{model.far_dark:g}" if model.far_dark else "",
            f"{1000 * model.turn:.3g}",
        )
        for model in MODELS
    ]
    head = ("name", "laser", "field °", "step °", "readings", "range m", "10 % m", "turn ms")
    return table(head, rows)


def errors() -> str:
    """Return the errors of each model, by range."""
    rows = [
        (name(model), *(("; ".join(part)) for part in zip(*map(error, model.errors), strict=True)))
        for model in MODELS
    ]
    return table(("name", "up to m", "systematic, at most mm", "standard deviation mm"), rows)


def error(part: RangeError) -> tuple[str, str, str]:
    """Return the bound, the systematic error and the standard deviation."""
    share = f"{100 * part.share:g} %" if part.share else ""
    lasting = " + ".join(filter(None, (mm(part.systematic) if part.systematic else "", share)))
    return ("any" if isinf(part.up_to) else f"{part.up_to:g}"), lasting, mm(part.sigma)


def interfaces() -> str:
    """Return the interfaces of each model, and ARIA's names for it."""
    rows = [
        (
            name(model),
            model.protocol.value,
            ", ".join(map(str, model.speeds)),
            "yes" if model.usb else "",
            ", ".join(map(str, model.tcp_ports)),
            ", ".join(f"`{kind}`" for kind in model.kinds),
        )
        for model in MODELS
    ]
    return table(("name", "protocol", "serial speeds", "USB", "TCP ports", "ARIA's types"), rows)


def speeds() -> str:
    """Return the speeds that a search tries, in their order."""
    return f"{', '.join(map(str, SPEEDS))} baud."


MAKERS = {"fields": fields, "errors": errors, "interfaces": interfaces, "speeds": speeds}


def filled(text: str) -> str:
    """Return the page with its tables made anew."""

    def made(block: re.Match[str]) -> str:
        return f"<!-- made: {block[1]} -->\n\n{MAKERS[block[1]]()}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
