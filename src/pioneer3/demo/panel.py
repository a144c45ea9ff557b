"""What the active mode has to show on a screen: its keys, bars, texts."""

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text
from textual.renderables.digits import Digits

from pioneer3.demo.modes import Gauge, Mode

EIGHTHS = " ▏▎▍▌▋▊▉█"
NAME, TEXT = 6, 12
"""Columns of a gauge's name and of its words."""


def panel(
    mode: Mode, gauges: Sequence[Gauge], details: Sequence[str], width: int, *, cropped: bool
) -> RenderableType:
    """Return the panel of `mode`, `width` characters wide; `cropped` details do not wrap."""
    parts: list[RenderableType] = [Text(f" {mode.name.upper()} ", "bold reverse"), _keys(mode.help)]
    presence = mode.presence()
    if presence.there is not True:
        style = "bold yellow" if presence.there is False else "yellow"
        parts.append(Text(presence.reason, style))
    for gauge in gauges:
        parts += _big(gauge, width) if gauge.big else [_small(gauge, width)]
    parts += [Text(line, no_wrap=cropped, overflow="ellipsis") for line in details]
    return Group(*parts)


def _keys(lines: Sequence[str]) -> RenderableType:
    """Return keys and what they do in two columns; notes go across, warnings in red."""
    grid = Table.grid(padding=(0, 1))
    grid.add_column(style="bold cyan", no_wrap=True)
    grid.add_column(style="grey62")
    notes = []
    for line in lines:
        keys, colon, meaning = line.partition(": ")
        if colon:
            grid.add_row(keys, meaning)
        else:
            notes.append(Text(line, "bold red" if line.isupper() else "grey62"))
    return Group(*notes, grid)


def _big(gauge: Gauge, width: int) -> list[RenderableType]:
    style = "bold yellow" if gauge.alarm else "bold"
    number, _, words = gauge.text.partition(" ")
    return [
        Digits(number, style),
        Text.assemble((f"{gauge.name} {words}".rstrip(), style)),
        bar(gauge, width, style),
    ]


def _small(gauge: Gauge, width: int) -> Text:
    style = "bold red" if gauge.alarm else ""
    text = Text(f"{gauge.name:{NAME}}", no_wrap=True)
    text.append(bar(gauge, max(4, width - NAME - TEXT), style or "cyan"))
    return text.append(f"{gauge.text:>{TEXT}}", style)


def bar(gauge: Gauge, width: int, style: str = "") -> Text:
    """Return a bar of `width` characters, to both sides of its middle where there are two."""
    text = Text(no_wrap=True)
    if not gauge.signed:
        return _filled(text, max(0.0, gauge.share), width, style)
    half = (width - 1) // 2
    # blocks grow from the left only: on the left side they are whole ones
    left = round(min(max(0.0, -gauge.share), 1.0) * half)
    text.append("·" * (half - left), "bright_black").append("█" * left, style)
    text.append("│", "bright_black")
    return _filled(text, max(0.0, gauge.share), width - half - 1, style)


def _filled(text: Text, share: float, width: int, style: str) -> Text:
    whole, part = divmod(round(min(share, 1.0) * width * 8), 8)
    drawn = "█" * whole + (EIGHTHS[part] if part else "")
    return text.append(drawn, style).append("·" * (width - len(drawn)), "bright_black")
