"""The command line: its commands, and the exit codes of errors."""

import errno
import logging
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from enum import IntEnum
from threading import Thread

from cyclopts import App, CycloptsError, Group, Parameter, UnusedCliTokensError

from pioneer3 import __version__
from pioneer3.behaviors.modes import MODES
from pioneer3.cli.aria_options import in_our_words
from pioneer3.cli.options import UNITS, shown_default
from pioneer3.cli.process import LogFormatter, write_error, write_warning
from pioneer3.cli.ros_arguments import gather_ros_arguments
from pioneer3.errors import (
    CommandError,
    ConfigError,
    FilePermissionError,
    LinkError,
    NoRobotError,
    PioneerError,
    PortBusyError,
    PortPermissionError,
)
from pioneer3.runtime.signals import die_of


class Exit(IntEnum):
    """Exit codes."""

    OK = 0
    FAILED = 1
    USAGE = 2
    NOT_REACHABLE = 3
    NO_PERMISSION = 4
    INTERRUPTED = 130
    QUIT = 131


app = App(
    name="pioneer3",
    help="""Drive, simulate and program Pioneer 3 robots, with or without ROS.

    Start here: pioneer3 run simulates a robot and names the page to open.

    Example: pioneer3 run
    Example: pioneer3 run --port /dev/ttyUSB0
    """,
    help_format="plaintext",
    version=__version__,
    group_commands=Group("This program", sort_key=100),
    default_parameter=Parameter(show_default=shown_default),
)
app.register_install_completion_command(help="Let the Tab key complete commands and options.")
OWN_COMMANDS = {"goto", "turn"}
"""Modes with commands of their own: `turn` is a motion, as `move` is: it fails where it sticks."""
GROUPS: dict[str, tuple[str, ...]] = {
    "Start": ("run:run", "sim:sim", "docs:docs"),
    "Drive with your hands": ("drive:drive", "demo:demo"),
    "Let the robot drive": (
        *(f"motion:{mode.name()}" for mode in MODES if mode.name() not in OWN_COMMANDS),
        *("goto:goto", "motion:move", "goto:patrol", "motion:turn"),
    ),
    "Look at the robot": (
        *("diagnosis:info", "config:config_app", "monitor:monitor", "sonar:sonar"),
        *("laser:laser_app", "log:log_app", "replay:replay"),
    ),
    "When something is wrong": ("diagnosis:doctor", "diagnosis:find_port", "setup:setup_app"),
    "Many robots": ("fleet:fleet_app", "bridge:bridge", "classroom:class_"),
    "Maps, models, ROS, and who may use the page": (
        *("map:map_app", "model:model_app", "robot:robot_app", "calibrate:calibrate"),
        *("ros1:ros1_app", "ros2:ros2_app", "access:access_app"),
    ),
}
"""Each command: its module here, which is loaded where it is called, and its function or app."""
WITHOUT_UNITS = {"sim", "docs", "class", "info", "find-port", "replay"}
"""Functions in whose help no number has a unit."""
for number, (title, commands) in enumerate(GROUPS.items()):
    group = Group(title, sort_key=number)
    for place, path in enumerate(commands):
        name = path.partition(":")[2].removesuffix("_app").rstrip("_").replace("_", "-")
        of_function = (
            {} if path.endswith("_app") or name in WITHOUT_UNITS else {"help_epilogue": UNITS}
        )
        where = f"pioneer3.cli.{path}"
        app.command(where, name=name, group=group, sort_key=place, **of_function)


HELP = app.help_flags
"""Options that show the help of the program where they come first."""
FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
"""Errors of a disk that takes no more."""
LAST_WORDS = 1.0
"""After it, a command ends though its terminal takes nothing: stopped by Ctrl-S, or hung [s]."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code (:class:`Exit`)."""
    told = logging.StreamHandler()
    told.setFormatter(LogFormatter("%(levelname)s: %(message)s"))
    logging.basicConfig(handlers=[told], level=logging.WARNING)
    code = execute(sys.argv[1:] if arguments is None else arguments)
    if code == Exit.QUIT:
        die_of(code - 128)
    failures: list[OSError] = []
    writing = Thread(target=_write_what_is_left, args=(failures,), daemon=True)
    writing.start()
    at_terminal = any(map(os.isatty, (1, 2)))
    writing.join(LAST_WORDS if at_terminal else None)
    if writing.is_alive():
        os._exit(code)
    full = next((failure for failure in failures if failure.errno in FULL), None)
    if full is not None and code == Exit.OK:
        code = _tell_full(full)
    raise SystemExit(code)


def _write_what_is_left(failures: list[OSError]) -> None:
    for name in ("stdout", "stderr"):
        with suppress(AttributeError, ValueError):  # there is none, or it is closed
            try:
                getattr(sys, name).flush()
            except OSError as error:  # its reader has gone, say: Python itself would exit by 120
                setattr(sys, name, None)
                failures.append(error)


def execute(arguments: Sequence[str]) -> int:
    """Run one command; return its exit code, errors told in one line."""
    if not arguments or arguments[0] in HELP:
        _load_commands()
    try:
        result = app(
            gather_ros_arguments(in_our_words(arguments, write_warning)),
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
    except CycloptsError as error:
        return _tell(_usage(error), Exit.USAGE)
    except KeyboardInterrupt:
        return Exit.INTERRUPTED
    except PioneerError as error:
        see = f"; see: {error.symptom.command}" if error.symptom else ""
        return _tell(f"{error}{see}", exit_code(error))
    except BrokenPipeError:  # the reader of our output has gone: that is its right
        sys.stdout = None
        return Exit.OK
    except OSError as error:
        if error.errno not in FULL:
            raise
        return _tell_full(error)
    return result if isinstance(result, int) else Exit.OK


def _load_commands(program: App = app) -> None:
    """Load the modules of all commands, for the summaries in the program's help."""
    for name in program:
        _ = program[name]


def _usage(error: CycloptsError) -> Exception:
    """Return an error of usage in words of ours where cyclopts has none for people."""
    if not isinstance(error, UnusedCliTokensError):
        return error
    words = " ".join(error.unused_tokens or ())
    command = " ".join(("pioneer3", *(error.command_chain or ())))
    return ConfigError(f"{words!r}: {command} takes no further words; see: {command} --help")


def _tell_full(error: OSError) -> Exit:
    words = f"{error.strerror}: the output is not complete; make room there, or write elsewhere"
    return _tell(OSError(words), Exit.FAILED)


def _tell(error: Exception | str, code: Exit) -> Exit:
    write_error(f"pioneer3: {error}")
    return code


def exit_code(error: PioneerError) -> Exit:
    """Return the exit code for `error`."""
    match error:
        case PortPermissionError() | FilePermissionError():
            return Exit.NO_PERMISSION
        case PortBusyError():
            return Exit.FAILED
        case LinkError() | NoRobotError():
            return Exit.NOT_REACHABLE
        case ConfigError() | CommandError():
            return Exit.USAGE
        case _:
            return Exit.FAILED
