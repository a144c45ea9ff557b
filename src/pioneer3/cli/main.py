"""The command line: its commands, and the exit codes of errors."""

import errno
import logging
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from enum import IntEnum
from threading import Thread

from cyclopts import App, CycloptsError, Group, Parameter, UnusedCliTokensError

from pioneer3 import __version__
from pioneer3.cli.access import access_app
from pioneer3.cli.aria_options import in_our_words
from pioneer3.cli.bridge import bridge
from pioneer3.cli.calibrate import calibrate
from pioneer3.cli.classroom import class_
from pioneer3.cli.config import config_app
from pioneer3.cli.demo import demo
from pioneer3.cli.diagnosis import doctor, find_port, info
from pioneer3.cli.docs import docs
from pioneer3.cli.drive import drive
from pioneer3.cli.fleet import fleet_app
from pioneer3.cli.goto import goto, patrol
from pioneer3.cli.laser import laser_app
from pioneer3.cli.log import log_app
from pioneer3.cli.map import map_app
from pioneer3.cli.model import model_app
from pioneer3.cli.monitor import monitor
from pioneer3.cli.motion import MODE_COMMANDS, move, turn
from pioneer3.cli.options import UNITS, shown_default
from pioneer3.cli.process import LogFormatter, write_error, write_warning
from pioneer3.cli.replay import replay
from pioneer3.cli.robot import robot_app
from pioneer3.cli.ros1 import ros1_app
from pioneer3.cli.ros2 import gather_ros_arguments, ros2_app
from pioneer3.cli.run import run
from pioneer3.cli.setup import setup_app
from pioneer3.cli.sim import sim
from pioneer3.cli.sonar import sonar
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
GROUPS: dict[str, tuple[Callable[..., object], ...]] = {
    "Start": (run, sim, docs),
    "Drive with your hands": (drive, demo),
    "Let the robot drive": (*MODE_COMMANDS, goto, move, patrol, turn),
    "Look at the robot": (info, config_app, monitor, sonar, laser_app, log_app, replay),
    "When something is wrong": (doctor, find_port, setup_app),
    "Many robots": (fleet_app, bridge, class_),
    "Maps, models, ROS, and who may use the page": (
        map_app,
        model_app,
        robot_app,
        calibrate,
        ros1_app,
        ros2_app,
        access_app,
    ),
}
WITHOUT_UNITS = (
    sim,
    docs,
    class_,
    info,
    config_app,
    find_port,
    log_app,
    replay,
    setup_app,
    map_app,
    model_app,
    robot_app,
    access_app,
)
for number, (name, commands) in enumerate(GROUPS.items()):
    group = Group(name, sort_key=number)
    for place, command in enumerate(commands):
        below = None if command in WITHOUT_UNITS else UNITS
        if isinstance(command, App):
            command.group, command.sort_key, command.help_epilogue = (group,), place, below
            app.command(command)
        else:
            app.command(
                command,
                name=command.__name__.rstrip("_").replace("_", "-"),
                group=group,
                sort_key=place,
                help_epilogue=below,
            )


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
