"""Places as people write them: a name, or numbers."""

from collections.abc import Sequence

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.units import ANGLE, LENGTH

UNITS = LENGTH, LENGTH, ANGLE


def numbers_of(words: Sequence[str], where: str) -> dict[str, float] | None:
    """Return x, y and heading, or `None` where the words are a name.

    Raises:
        ConfigError: They are too few or too many, or one of them is no number.
    """
    if not words or not words[0].lstrip(" +-.")[:1].isdigit():
        return None
    if not 2 <= len(words) <= len(UNITS):
        raise ConfigError(f"{where} {' '.join(words)}: give x and y, or x, y and a heading")
    try:
        values = [quantity.read(word) for quantity, word in zip(UNITS, words, strict=False)]
    except ValueError as error:
        raise ConfigError(f"{where} {' '.join(words)}: {error}") from None
    return dict(zip(("x", "y", "heading"), values, strict=False))


def pose_of(text: str, where: str) -> Pose2 | str:
    """Return the pose `x,y,heading`, or the name of a place.

    Raises:
        ConfigError: A number is wrong.
    """
    numbers = numbers_of(text.split(","), where)
    if numbers is None:
        return text
    return Pose2(numbers["x"], numbers["y"], numbers.get("heading", 0.0))
