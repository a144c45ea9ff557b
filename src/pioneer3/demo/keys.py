"""The keys that mean the same in every mode, and what terminals send for keys."""

from collections.abc import Mapping
from types import MappingProxyType

HELP_KEYS = frozenset("hH?/")
EMERGENCY_KEYS = frozenset("kK")
"""ARIA uses neither."""
STOP_KEY = "space"
RESET_KEY = "ctrl+r"
QUIT_KEYS = frozenset({"escape", "ctrl+c", "ctrl+d", "ctrl+q"})

ESCAPE = "\x1b"
NAMES: Mapping[str, str] = MappingProxyType(
    {
        **{
            f"{ESCAPE}{form}{letter}": name
            for form in "[O"
            for letter, name in zip("ABCD", ("up", "down", "right", "left"), strict=True)
        },
        f"{ESCAPE}[5~": "pageup",
        f"{ESCAPE}[6~": "pagedown",
        ESCAPE: "escape",
        " ": "space",
        "\r": "enter",
        "\n": "enter",
        "\x7f": "backspace",
        "\x08": "backspace",
        "\x03": "ctrl+c",
        "\x04": "ctrl+d",
        "\x12": RESET_KEY,
    }
)
"""By what a terminal sends."""


def named(token: str) -> str:
    """Return the name of the key that sent `token`, or the character that it is."""
    return NAMES.get(token, token)
