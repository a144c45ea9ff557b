"""Write the tables of docs/reference/protocol.md and facts.md from the classes of the package.

    uv run docs/reference/protocol_tables.py

A line `<!-- made: what -->` begins a table; whatever follows it up to `<!-- end -->` is replaced.
"""

import re
from collections.abc import Callable, Iterable
from enum import IntEnum, IntFlag
from math import degrees
from pathlib import Path

from pioneer3.arcos import commands, lists, reports, wire
from pioneer3.arcos.commands import arguments
from pioneer3.arcos.commands.table import DEVICES, DRIVING, OLD_SIMULATOR
from pioneer3.arcos.layout import layout
from pioneer3.arcos.reports import sip
from pioneer3.models import RobotModel, load_model, model_names
from pioneer3.units import MM

PAGES = tuple(Path(__file__).with_name(name) for name in ("protocol.md", "facts.md", "scip.md"))
BLOCK = re.compile(r"<!-- made: ([^>]+?) -->\n(?:(?!<!-- made).*?<!-- end -->\n)?", re.DOTALL)
ARCOS_NAME = re.compile(r" ?\(ARCOS (\d+)(?: of simulators)?(?:, ([^);]+))?(?:; [^)]*)?\)")
ATTRIBUTE = re.compile(r"^        (\w+): (.*(?:\n {10,}.*)*)", re.MULTILINE)
NOT_FOR_PAGES = re.compile(
    r" \((?:(?:arcos|protocol|facts)\.md [\d.,; to]+|(?:0x[0-9A-F]+(?:, )?)+)\)"
)
"""Citations and ids."""
CLASS = re.compile(r":class:`(?:[\w.]+\.)?(\w+)`")
UNITS = {
    arguments.MILLI: "0.001",
    arguments.DECI: "0.1",
    arguments.ONE: "1",
    arguments.TWENTY_MS: "0.02",
    arguments.DEGREES: "1 degree",
    arguments.CENTIDEGREES: "0.01 degree",
    arguments.HUNDREDTHS_OR_DEGREES: "0.01 degree",
}
SIZES = {"B": "u8", "b": "s8", "H": "u16", "h": "s16", "I": "u32"}
PARTS = {"driving": DRIVING, "devices": DEVICES, "simulators": OLD_SIMULATOR}
"""By module of `pioneer3.arcos.commands`: the lines of the table that belong to it."""


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a Markdown table."""
    lines = [
        "|" + "|".join(f" {cell} " if cell else " " for cell in map(str, row)) + "|"
        for row in (head, *rows)
    ]
    return "\n".join([lines[0], re.sub(r"[^|]+", "---", lines[0]), *lines[1:]])


def one_line(text: str | None) -> str:
    """Return the first paragraph of a docstring in one line, without what only code needs."""
    line = " ".join((text or "").split("\n\n")[0].split())
    return NOT_FOR_PAGES.sub("", CLASS.sub(r"`\1`", line))


def spelt(kind: wire.WireKind) -> str:  # noqa: PLR0911
    """Return how a value of `kind` is on the wire, for people."""
    match kind:
        case wire.Integer(size, signed):
            return f"{'s' if signed else 'u'}{8 * size}"
        case wire.PacketId():
            return "the id itself"
        case arguments.Argument():
            names = {(0, 0x7FFF): "positive", (-0x8000, 0x7FFF): "signed", (0, 0xFFFF): "word"}
            return names.get((kind.low, kind.high), f"{kind.low} to {kind.high}")
        case arguments.Bits(shift, width, signed):
            byte = {0: "low byte", 8: "high byte"}.get(shift) if width == 8 else None
            some = f"bits {shift} to {shift + width - 1}" if width > 1 else f"bit {shift}"
            return ("signed " * signed) + (byte or some)
        case wire.Scaled(inner, unit):
            return f"{spelt(inner)} [{UNITS[unit]}]"
        case wire.Enumerated(inner, choices):
            return f"{spelt(inner)}, {choices.__name__}"
        case wire.Switch(inner):
            return spelt(inner) if isinstance(inner, arguments.Bits) else f"{spelt(inner)}, 0 or 1"
        case arguments.Prefixed(inner):
            return f"any byte, {spelt(inner)}"
        case _:
            return spelt_several(kind)


def spelt_several(kind: wire.WireKind) -> str:  # noqa: PLR0911
    """Return how letters, bytes and lists are on the wire."""
    match kind:
        case wire.NulTerminated():
            return "text"
        case wire.AllThatIsLeft():
            return "bytes"
        case arguments.Latin1():
            return "letters"
        case arguments.String(content):
            return f"string of {spelt(content)}"
        case lists.CountedText(count):
            return f"{spelt(count)} length, letters"
        case lists.Record(cls):
            return ", ".join(f"{slot.name} {spelt(slot.kind)}" for slot in layout(cls))
        case lists.Repeated(item, length):
            return f"{length} times {spelt(item)}" if length else f"({spelt(item)}), repeated"
        case lists.Counted(count, item):
            return f"{spelt(count)} count, each: {spelt(item)}"
        case lists.CountedStructs(cls):
            return f"u8 count, each: {spelt(lists.Record(cls))}"
        case lists.SizedRecords(cls):
            return f"u8 count, u8 size, each: {spelt(lists.Record(cls))}"
    raise AssertionError(kind)


def command_table(part: str) -> str:
    """Return the commands of one of :data:`PARTS`, by number."""
    sources = {row.name: row.source for row in PARTS[part]}
    rows = []
    for cls in sorted(commands.every_command(), key=lambda cls: cls.ID):
        listed = cls.__name__ in sources
        if listed or cls.__module__ == f"pioneer3.arcos.commands.{part}":
            doc = one_line(cls.__doc__)
            name = ARCOS_NAME.search(doc)
            assert name, cls
            asked = "; ".join(f"{slot.name}: {spelt(slot.kind)}" for slot in layout(cls))
            meaning = ARCOS_NAME.sub("", doc)
            own = "" if listed else f"`{cls.__name__}`"
            rows.append((cls.ID, name[2] or "", own, asked, meaning, sources.get(cls.__name__, "")))
    return table(("no", "name", "class", "arguments", "meaning", "source"), rows)


def report_index() -> str:
    """Return every report with its ids."""
    rows = [
        (
            ", ".join(f"0x{number:02X}" for number in reports.numbers(cls)),
            f"`{cls.__name__}`",
            one_line(cls.__doc__),
        )
        for cls in sorted(reports.ALL, key=reports.numbers)
    ]
    return table(("id", "class", "meaning"), rows)


def report_table(name: str) -> str:
    """Return the fields of one report, in wire order."""
    cls = getattr(reports, name)
    told = {field: one_line(text) for field, text in ATTRIBUTE.findall(cls.__doc__ or "")}
    ids = ", ".join(f"0x{number:02X}" for number in reports.numbers(cls))
    slots = [slot for slot in layout(cls) if slot.name != "extra"] if cls is not reports.Sip else []
    kinds = [(slot.name, spelt(slot.kind)) for slot in slots]
    if cls is reports.Sip:
        sonar = ("sonar", "u8 count, each: number u8, range u16")
        head, tail = (
            [(name, SIZES[letter]) for name, letter in part] for part in (sip.HEAD[1:], sip.TAIL)
        )
        kinds = [*head, sonar, *tail]
    rows = [
        (number, f"`{field}`", kind, told.get(field, ""))
        for number, (field, kind) in enumerate(kinds, start=1)
    ]
    ends = next((slot.name for slot in slots if slot.optional), "")
    text = f"**{name}**, {ids}: {one_line(cls.__doc__)}\n\n"
    text += table(("no", "field", "type", "meaning"), rows) if rows else "No fields."
    if ends:
        text += f"\n\nA packet may end before `{ends}` and before every field after it."
    return text


def flag_table(name: str) -> str:
    """Return the bits of one bit field."""
    flags: type[IntFlag] = getattr(reports, name)
    rows = [(flag.value.bit_length() - 1, flag.name) for flag in flags]
    return f"**{name}**: {one_line(flags.__doc__)}\n\n" + table(("bit", "name"), rows)


def choice_table() -> str:
    """Return the values of the arguments that are choices."""
    found = {
        slot.kind.choices
        for cls in commands.every_command()
        for slot in layout(cls)
        if isinstance(slot.kind, wire.Enumerated)
    }
    rows = [
        (f"`{cls.__name__}`", one_line(cls.__doc__), ", ".join(f"{x.value} {x.name}" for x in cls))
        for cls in sorted(found, key=lambda cls: cls.__name__)
        if issubclass(cls, IntEnum)
    ]
    return table(("argument", "meaning", "values"), rows)


def mm(metres: float) -> str:
    """Return a length in millimetres."""
    return f"{metres / MM:g}"


def model_table() -> str:
    """Return the numbers in which the shipped models differ."""
    columns: dict[str, Callable[[RobotModel], str]] = {
        "model": lambda model: model.name,
        "robot": lambda model: model.title,
        "radius": lambda model: mm(model.radius),
        "width": lambda model: mm(model.width),
        "front, rear": lambda model: f"{mm(model.length_front)}, {mm(model.length_rear)}",
        "fastest": lambda model: mm(model.max_speed),
        "turn": lambda model: f"{degrees(model.max_turn_rate):g}",
        "wheel base": lambda model: mm(round(model.wheel_base, 3)),
        "x, y": lambda model: mm(model.distance_factor),
        "speed": lambda model: mm(model.speed_factor),
        "range": lambda model: mm(model.range_factor),
        "sonars": lambda model: str(len(model.sonars)),
        "bumpers": lambda model: f"{model.front_bumpers}, {model.rear_bumpers}",
        "laser, at x": lambda model: (
            f"{model.laser.kind}, {mm(model.laser.x)}" if model.laser else ""
        ),
    }
    models = [load_model(name) for name in model_names()]
    return table(tuple(columns), ((tell(model) for tell in columns.values()) for model in models))


def sonar_table() -> str:
    """Return where the sonars of the shipped models are."""
    models: dict[str, list[str]] = {}
    for name in model_names():
        sonars = load_model(name).sonars
        places = " ".join(f"({mm(s.x)}, {mm(s.y)}, {degrees(s.theta):g})" for s in sonars)
        models.setdefault(places, []).append(name)
    rows = ((", ".join(names), places) for places, names in models.items())
    return table(("model", "x, y, direction, from number 0"), rows)


MAKERS: dict[str, Callable[..., str]] = {
    "commands": command_table,
    "reports": report_index,
    "report": report_table,
    "flags": flag_table,
    "choices": choice_table,
    "models": model_table,
    "sonars": sonar_table,
}


def filled(text: str) -> str:
    """Return a page with its tables made anew."""

    def made(block: re.Match[str]) -> str:
        what, *arguments = block[1].split()
        return f"<!-- made: {block[1]} -->\n\n{MAKERS[what](*arguments)}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


if __name__ == "__main__":
    for page in PAGES:
        page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
