"""Digital and analog lines, bit by bit (facts.md 8.10)."""

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Cell, Row, bits, hundredths
from pioneer3.robot.devices.lines import LinesReading
from pioneer3.state import Words

BYTE = 8
FLAGS, VOLTS = 19, 7
"""Widths: two groups of eight bits with room around them; a voltage."""


def io(cockpit: Cockpit) -> Mode:
    """Return the mode that shows flags and lines."""
    lines = cockpit.robot.devices.lines
    return Mode(
        key="i",
        name="io",
        help=("bits: bit 0 first", "a/d: volts"),
        presence=lambda: lines.presence,
        enter=lines.wanted,
        row=lambda: io_row(cockpit.snapshot.words, lines.latest) if cockpit.snapshot else None,
    )


def io_row(words: Words, reading: LinesReading | None) -> Row:
    """Return flags, fault flags if there are any, and the lines once they are known."""
    cells = [Cell("flags", FLAGS, bits(words.flags, 16, group=BYTE))]
    if words.faults is not None:
        cells.append(Cell("fault_flags", FLAGS, bits(words.faults, 16, group=BYTE)))
    if reading is not None:
        cells += _bytes("digin", reading.digital_in)
        cells += _bytes("digout", reading.digital_out)
        cells += [
            Cell(f"a/d{port}", VOLTS, hundredths(volts))
            for port, volts in enumerate(reading.analog)
        ]
    return Row(tuple(cells))


def _bytes(name: str, lines: tuple[bool, ...]) -> list[Cell]:
    groups = [lines[at : at + BYTE] for at in range(0, len(lines), BYTE)]
    return [
        Cell(f"{name}{number}", BYTE + 2, "".join("1" if high else "0" for high in group))
        for number, group in enumerate(groups)
    ]
