"""Parses a command that a person types: a number and its arguments (facts.md 8.13)."""

from pioneer3.arcos.commands import Command, from_payload
from pioneer3.arcos.commands.arguments import put_argument
from pioneer3.errors import CommandError

GREATEST = 32767
BYTES = range(-128, 256)
HOW = "type a command's number, and nothing, one number or two bytes after it"


def parse_typed(line: str) -> Command:
    """Return the command in `line`, such as `4 1`, `11 -200` or `32 10 -10`.

    One number is a command without argument, two are one with an integer (-32767 to 32767), three
    are one with two bytes (-128 to 255 each).

    Raises:
        CommandError: it is no command; the message has the reason and the form to type.
    """
    words = line.split()
    if not words:
        raise CommandError(HOW)
    numbers = [_number(word) for word in words]
    if not 0 <= numbers[0] <= 255:
        raise CommandError(f"command {numbers[0]}: there are 0 to 255")
    payload = bytearray([numbers[0]])
    match numbers[1:]:
        case []:
            pass
        case [argument]:
            if abs(argument) > GREATEST:
                raise CommandError(f"argument {argument}: it must be -{GREATEST} to {GREATEST}")
            put_argument(argument, payload)
        case [high, low]:
            for byte in (high, low):
                if byte not in BYTES:
                    raise CommandError(f"byte {byte}: it must be -128 to 255")
            word = (high & 0xFF) << 8 | low & 0xFF
            # two bytes are sent as one signed 16-bit number (protocol.md 1.3)
            put_argument(word - 0x10000 if word & 0x8000 else word, payload)
        case _:
            raise CommandError(f"{len(words)} numbers are too many: {HOW}")
    return from_payload(bytes(payload))


def _number(word: str) -> int:
    digits = word.removeprefix("-")
    if not (digits.isascii() and digits.isdecimal() and len(digits) <= 9):
        raise CommandError(f"{word!r} is not a whole number: {HOW}")
    return int(word)
