"""The gripper, the compass and the input and output lines (facts.md 8.5, 8.10, 8.14)."""

from pioneer3.arcos.commands import Tcm2Mode
from pioneer3.demo.columns import ColumnCell, ColumnRow, bits, degrees_tenths, hundredths, tenths
from pioneer3.demo.mode import Context, DemoMode, Description
from pioneer3.robot.devices.compass import CompassReading
from pioneer3.robot.devices.gripper import GripperReading
from pioneer3.robot.devices.lines import LinesReading
from pioneer3.state import Words

WIDTH = 13


def gripper(context: Context, about: Description) -> DemoMode:
    """Return the mode that opens, closes and lifts."""
    hand = context.robot.devices.gripper

    def on_key(key: str) -> bool:
        match key:
            case "up":
                hand.lift_up()
            case "down":
                hand.lift_down()
            case "right":
                hand.open()
            case "left":
                hand.close()
            case "space":
                hand.halt()
            case "e" | "E":
                if not hand.exercising:
                    context.work(hand.exercise())
            case _:
                return False
        return True

    return DemoMode(
        about,
        presence=lambda: hand.presence,
        enter=hand.wanted,
        on_key=on_key,
        row=lambda: gripper_row(hand.latest) if hand.latest else None,
        details=lambda: ("exercising",) if hand.exercising else (),
    )


def gripper_row(reading: GripperReading) -> ColumnRow:
    """Return beams, paddles and lift."""
    return ColumnRow(
        (
            ColumnCell("BB outer", WIDTH, "blocked" if reading.outer_beam_broken else "clear"),
            ColumnCell("BB inner", WIDTH, "blocked" if reading.inner_beam_broken else "clear"),
            ColumnCell("Paddles", WIDTH, reading.paddles),
            ColumnCell("Lift", WIDTH, "maxed" if reading.lift_at_limit else "clear"),
            ColumnCell("LeftPaddle", WIDTH, "triggered" if reading.left_touches else "clear"),
            ColumnCell("RightPaddle", WIDTH, "triggered" if reading.right_touches else "clear"),
        )
    )


TCM2_KEYS = {str(int(mode)): mode for mode in Tcm2Mode}


def tcm2(context: Context, about: Description) -> DemoMode:
    """Return the mode that shows the compass module."""
    compass = context.robot.devices.compass

    def on_key(key: str) -> bool:
        if key not in TCM2_KEYS:
            return False
        compass.set_mode(TCM2_KEYS[key])
        context.say(f"TCM2 {key}: {TCM2_KEYS[key].name.lower().replace('_', ' ')}")
        return True

    return DemoMode(
        about,
        presence=lambda: compass.presence,
        enter=compass.wanted,
        on_key=on_key,
        row=lambda: tcm2_row(compass.latest, compass.rate) if compass.latest else None,
    )


def tcm2_row(reading: CompassReading, rate: float) -> ColumnRow:
    """Return the fields of a packet, and the number of packets in the last second."""
    magnetic = zip(("magX", "magY", "magZ"), reading.magnetic, strict=True)
    return ColumnRow(
        (
            ColumnCell("comp", 6, degrees_tenths(reading.heading)),
            ColumnCell("pitch", 5, degrees_tenths(reading.pitch)),
            ColumnCell("roll", 5, degrees_tenths(reading.roll)),
            *(ColumnCell(name, 6, hundredths(value)) for name, value in magnetic),
            ColumnCell("temp", 6, tenths(reading.temperature)),
            ColumnCell("error", 10, f"0x{reading.error:x}"),
            ColumnCell("calH", 4, str(reading.calibration_h)),
            ColumnCell("calV", 4, str(reading.calibration_v)),
            ColumnCell("calM", 6, hundredths(reading.calibration_m)),
            ColumnCell("cnt", 3, str(round(rate))),
        ),
        gap=" ",  # the widths alone would let names touch each other
    )


BYTE = 8
FLAGS = 19
"""Width of two groups of eight bits with room around them."""
VOLTS = 7
"""Width of a voltage."""


def io(context: Context, about: Description) -> DemoMode:
    """Return the mode that shows flags and lines."""
    lines = context.robot.devices.lines
    return DemoMode(
        about,
        presence=lambda: lines.presence,
        enter=lines.wanted,
        row=lambda: io_row(context.snapshot.words, lines.latest) if context.snapshot else None,
    )


def io_row(words: Words, reading: LinesReading | None) -> ColumnRow:
    """Return flags, fault flags if there are any, and the lines once they are known."""
    cells = [ColumnCell("flags", FLAGS, bits(words.flags, 16, group=BYTE))]
    if words.faults is not None:
        cells.append(ColumnCell("fault_flags", FLAGS, bits(words.faults, 16, group=BYTE)))
    if reading is not None:
        cells += _bytes("digin", reading.digital_in)
        cells += _bytes("digout", reading.digital_out)
        cells += [
            ColumnCell(f"a/d{port}", VOLTS, hundredths(volts))
            for port, volts in enumerate(reading.analog)
        ]
    return ColumnRow(tuple(cells))


def _bytes(name: str, lines: tuple[bool, ...]) -> list[ColumnCell]:
    groups = [lines[at : at + BYTE] for at in range(0, len(lines), BYTE)]
    return [
        ColumnCell(f"{name}{number}", BYTE + 2, "".join("1" if high else "0" for high in group))
        for number, group in enumerate(groups)
    ]
