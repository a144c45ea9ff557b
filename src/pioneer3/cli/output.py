"""Lines on stdout for programs, signs of life on stderr for people."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager


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
    """Write `value`, made of dataclasses and plain types, as JSON; infinity and NaN are null."""
    import msgspec  # noqa: PLC0415

    data = msgspec.json.encode(value)
    write_line((msgspec.json.format(data, indent=indent) if indent else data).decode())


@contextmanager
def busy_sign(text: str) -> Iterator[None]:
    """Show on stderr, if that is a terminal, that something is going on."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console  # noqa: PLC0415

    with Console(stderr=True).status(text):
        yield
