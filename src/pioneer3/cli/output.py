"""Lines on stdout for programs, signs of life on stderr for people."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

DIGITS = 6
"""After the point of numbers in JSON."""


def write_line(text: str) -> None:
    """Write one line to stdout, at once.

    Raises:
        BrokenPipeError: nobody reads any more.
    """
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def write_warning(text: str) -> None:
    """Write one line to stderr."""
    print(f"WARNING: {text}", file=sys.stderr, flush=True)  # noqa: T201


def write_json(value: object, *, indent: int | None = None) -> None:
    """Write `value`, made of dataclasses and plain types, as JSON.

    Infinity and NaN are null; digits beyond a millionth are rounding, and left out.
    """
    import msgspec  # noqa: PLC0415

    data = msgspec.json.encode(_rounded(msgspec.to_builtins(value)))
    write_line((msgspec.json.format(data, indent=indent) if indent else data).decode())


def _rounded(value: object) -> object:
    match value:
        case float():
            return round(value, DIGITS) + 0.0  # no -0.0
        case dict():
            return {key: _rounded(item) for key, item in value.items()}
        case list() | tuple():
            return [_rounded(item) for item in value]
    return value


@contextmanager
def busy_sign(text: str) -> Iterator[None]:
    """Show on stderr, if that is a terminal, that something is going on."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console  # noqa: PLC0415

    with Console(stderr=True).status(text):
        yield
