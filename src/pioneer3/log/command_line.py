"""The command line that a log tells, without its secrets."""

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Final

OUR_COMMANDS: Final = {"pioneer3", "p3", "__main__.py"}
"""Names of our own command, as Python tells them."""
WORD: Final = re.compile(r"[a-z][a-z0-9-]*")
"""A word of a command, as opposed to its options, numbers and files."""
CREDENTIALS: Final = re.compile(r"//[^/@\s]*@")
"""User and password in a URL."""
SECRET: Final = re.compile(r"pass|pwd|token|secret|key|auth|credential|pin\b", re.IGNORECASE)
"""In the name of an option or of a part of a URL whose value is nobody's business."""
URL_VALUE: Final = re.compile(r"([?&;])([^=&;\s]*)=([^&;\s]*)")
"""Name and value in a URL."""
HIDDEN: Final = "***"
"""Stands for a secret."""


def started(arguments: Sequence[str]) -> tuple[str, str]:
    """Return the title of what was started, such as `map build`, and all of it without secrets."""
    program, *rest = arguments or [""]
    name = Path(program).name
    if name in OUR_COMMANDS:
        name = "pioneer3"
        words = []
        for word in rest[:2]:
            if not WORD.fullmatch(word):
                break
            words.append(word)
        title = " ".join(words) or name
    else:
        title = Path(name).stem or "python"
    shown, hide = [name or "python"], False
    for argument in rest:
        option, equals, _ = argument.partition("=")
        is_option = option.startswith("-")
        if hide and not is_option:
            shown.append(HIDDEN)
        elif is_option and equals and SECRET.search(option):
            shown.append(f"{option}={HIDDEN}")
        else:
            shown.append(without_secrets(argument))
        hide = is_option and not equals and bool(SECRET.search(option))
    return title, shlex.join(shown)


def without_secrets(url: str) -> str:
    """Return a URL without the password and keys that may be in it."""

    def hidden(found: re.Match[str]) -> str:
        value = HIDDEN if SECRET.search(found[2]) else found[3]
        return f"{found[1]}{found[2]}={value}"

    return URL_VALUE.sub(hidden, CREDENTIALS.sub(f"//{HIDDEN}@", url))
