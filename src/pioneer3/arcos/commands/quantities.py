"""What the arguments of client commands stand for: SI values and the unit each has on the wire.

ARIA's arguments are signed 16-bit numbers, so a quantity without sign ends at 32767; a `Word` is
a plain number for which the robot uses all 16 bits.
"""

from typing import Annotated

from pioneer3.arcos.commands.arguments import Argument, Bits, Latin1, String
from pioneer3.arcos.commands.choices import Request
from pioneer3.arcos.wire import AllThatIsLeft, Enumerated, Scaled, Switch, Unit
from pioneer3.units import DECIVOLT, MM, MS, degrees, radians


def per_si(count: float) -> Unit:
    """Return the unit of which `count` make one SI unit."""
    # dividing, not multiplying by 0.001, gives back exactly the number a person would write
    return Unit(lambda raw: raw / count, lambda si: si * count)


MILLI = per_si(1 / MM)
DECI = per_si(1 / DECIVOLT)
ONE = per_si(1)
TWENTY_MS = per_si(1 / (20 * MS))
DEGREES = Unit(radians, degrees)
CENTIDEGREES = Unit(lambda raw: radians(raw / 100), lambda si: degrees(si) * 100)
HUNDREDTHS_OR_DEGREES = Unit(
    lambda raw: radians(raw if raw <= 5 else raw / 100), CENTIDEGREES.to_raw
)
"""For SIM_LRF_SET_RES, where sources disagree (arcos.md 13, row 15)."""

POSITIVE = Argument(0, 0x7FFF)
SIGNED = Argument(-0x8000, 0x7FFF)
WORD = Argument(0, 0xFFFF)

How = Annotated[Request, Enumerated(WORD, Request)]
On = Annotated[bool, Switch(WORD)]
Word = Annotated[int, WORD]
Number = Annotated[int, SIGNED]
Celsius = Annotated[int, Argument(-128, 127)]

Millis = Annotated[float, Scaled(POSITIVE, MILLI)]
SignedMillis = Annotated[float, Scaled(SIGNED, MILLI)]
Degrees = Annotated[float, Scaled(POSITIVE, DEGREES)]
SignedDegrees = Annotated[float, Scaled(SIGNED, DEGREES)]
Decivolts = Annotated[float, Scaled(POSITIVE, DECI)]
Seconds = Annotated[float, Scaled(POSITIVE, ONE)]

High = Annotated[int, Bits(8, 8)]
Low = Annotated[int, Bits(0, 8, continues=True)]
LowOn = Annotated[bool, Switch(Bits(0, 8, continues=True))]
SignedHigh = Annotated[int, Bits(8, 8, signed=True)]
SignedLow = Annotated[int, Bits(0, 8, signed=True, continues=True)]

Data = Annotated[bytes, String(AllThatIsLeft())]
Message = Annotated[str, String(Latin1(), tail=b"\0")]
