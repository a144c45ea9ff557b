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
CREDENTIALS: Final = re.compile(r"//.*@", re.DOTALL)
"""User and password in a URL; a password may have any letter, so more than these may go."""
SECRET: Final = re.compile(
    r"pas|pwd?\b|token|secret|key|auth|credential|cookie|session|sig\b|bearer|pin\b", re.IGNORECASE
)
"""In the name of an option or of a part of a URL whose value is nobody's business."""
VALUE: Final = re.compile(rf"((?:{SECRET.pattern})[\w-]*:?=)[^&;\s]*", re.IGNORECASE)
"""Such a name and its value, in a URL or as a parameter of ROS."""
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


def without_secrets(text: str) -> str:
    """Return a text or URL without the passwords and keys that may be in it."""
    return VALUE.sub(rf"\1{HIDDEN}", CREDENTIALS.sub(f"//{HIDDEN}@", text))
