"""The TCM2 compass (facts.md 8.14)."""

from pioneer3.arcos.commands import Tcm2Mode
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Cell, Row, degrees_tenths, hundredths, tenths
from pioneer3.robot.devices.compass import CompassReading

KEYS = {str(int(mode)): mode for mode in Tcm2Mode}


def tcm2(cockpit: Cockpit) -> Mode:
    """Return the mode that shows the compass module."""
    compass = cockpit.robot.devices.compass

    def on_key(key: str) -> bool:
        if key not in KEYS:
            return False
        compass.set_mode(KEYS[key])
        cockpit.say(f"TCM2 {key}: {KEYS[key].name.lower().replace('_', ' ')}")
        return True

    return Mode(
        key="m",
        name="tcm2",
        help=(
            "0: off",
            "1: in the standard report",
            "2: one packet",
            "3: packets",
            "4: user calibration",
            "5: auto calibration",
            "6: stop calibration",
            "7: soft reset",
        ),
        presence=lambda: compass.presence,
        enter=compass.wanted,
        on_key=on_key,
        row=lambda: tcm2_row(compass.latest, compass.rate) if compass.latest else None,
    )


def tcm2_row(reading: CompassReading, rate: float) -> Row:
    """Return what a packet holds, and the packets in the last second."""
    magnetic = zip(("magX", "magY", "magZ"), reading.magnetic, strict=True)
    return Row(
        (
            Cell("comp", 6, degrees_tenths(reading.heading)),
            Cell("pitch", 5, degrees_tenths(reading.pitch)),
            Cell("roll", 5, degrees_tenths(reading.roll)),
            *(Cell(name, 6, hundredths(value)) for name, value in magnetic),
            Cell("temp", 6, tenths(reading.temperature)),
            Cell("error", 10, f"0x{reading.error:x}"),
            Cell("calH", 4, str(reading.calibration_h)),
            Cell("calV", 4, str(reading.calibration_v)),
            Cell("calM", 6, hundredths(reading.calibration_m)),
            Cell("cnt", 3, str(round(rate))),
        ),
        gap=" ",  # the widths alone would let names touch each other
    )
