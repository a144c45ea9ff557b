"""`python -m pioneer3` and the `pioneer3` and `p3` commands."""

import os
import sys

TYPE_CHECKING = False  # the module typing takes a while, in which Ctrl-C is not quiet yet

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

INTERRUPTED = 130
"""Exit code after Ctrl-C."""


def main(arguments: list[str] | None = None) -> None:
    """Run one command and exit with its code; Ctrl-C is quiet from the first import on."""
    sys.unraisablehook = _end_if_interrupted
    try:
        from pioneer3.cli.main import main as run

        run(arguments)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _end_if_interrupted(unraisable: "UnraisableHookArgs") -> None:
    """End after a Ctrl-C that came into a destructor or the like: those swallow exceptions."""
    if issubclass(unraisable.exc_type, KeyboardInterrupt):
        os._exit(INTERRUPTED)
    sys.__unraisablehook__(unraisable)


if __name__ == "__main__":
    main()
