"""The command line: which commands there are, and what an error means for the shell."""

import logging
import sys
from collections.abc import Sequence
from enum import IntEnum

from cyclopts import App, CycloptsError

from pioneer3 import __version__
from pioneer3.cli.access import access_app
from pioneer3.cli.demo import demo
from pioneer3.cli.doctor import doctor
from pioneer3.cli.drive import drive
from pioneer3.cli.find_port import find_port
from pioneer3.cli.follow import follow
from pioneer3.cli.info import info
from pioneer3.cli.map import map_app
from pioneer3.cli.monitor import monitor
from pioneer3.cli.motion import goto, move, turn
from pioneer3.cli.ros1 import ros1_app
from pioneer3.cli.run import run
from pioneer3.cli.sim import sim
from pioneer3.cli.sonar import sonar
from pioneer3.cli.wander import wander
from pioneer3.errors import (
    CommandError,
    ConfigError,
    LinkError,
    NoRobotError,
    PioneerError,
    PortBusyError,
    PortPermissionError,
)


class Exit(IntEnum):
    """Exit codes."""

    OK = 0
    FAILED = 1
    USAGE = 2
    NOT_REACHABLE = 3
    NO_PERMISSION = 4
    INTERRUPTED = 130


app = App(
    name="pioneer3",
    help="""Drive, simulate and program Pioneer 3 robots, with or without ROS.

    Example: pioneer3 run --port /dev/ttyUSB0
    """,
    help_format="plaintext",
    version=__version__,
)
for command in (
    run,
    sim,
    access_app,
    map_app,
    drive,
    demo,
    wander,
    follow,
    goto,
    move,
    turn,
    info,
    monitor,
    sonar,
    ros1_app,
    doctor,
    find_port,
):
    app.command(command)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code (:class:`Exit`)."""
    logging.basicConfig(format="%(levelname)s: %(message)s", level=logging.WARNING)
    raise SystemExit(execute(sys.argv[1:] if arguments is None else arguments))


def execute(arguments: Sequence[str]) -> int:
    """Run one command; return its exit code, errors told in one line."""
    try:
        result = app(
            arguments, exit_on_error=False, print_error=False, result_action="return_value"
        )
    except CycloptsError as error:
        return _tell(error, Exit.USAGE)
    except KeyboardInterrupt:
        return Exit.INTERRUPTED
    except PioneerError as error:
        return _tell(error, exit_code(error))
    except BrokenPipeError:  # the reader of our output has gone: that is its right
        sys.stdout = None
        return Exit.OK
    return result if isinstance(result, int) else Exit.OK


def _tell(error: Exception, code: Exit) -> Exit:
    print(f"pioneer3: {error}", file=sys.stderr)  # noqa: T201
    return code


def exit_code(error: PioneerError) -> Exit:
    """Return what `error` means for the shell."""
    match error:
        case PortPermissionError():
            return Exit.NO_PERMISSION
        case PortBusyError():
            return Exit.FAILED
        case LinkError() | NoRobotError():
            return Exit.NOT_REACHABLE
        case ConfigError() | CommandError():
            return Exit.USAGE
        case _:
            return Exit.FAILED
