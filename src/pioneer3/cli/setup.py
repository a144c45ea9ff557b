"""`pioneer3 setup`: prepares this computer for robots and lasers."""

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from pioneer3.cli.options import Flag
from pioneer3.cli.process import write_line, write_warning
from pioneer3.cli.ros2 import ros2_app
from pioneer3.cli.ros_arguments import gather_ros_arguments, separate_ros_arguments
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.doctor.facts import Finding
    from pioneer3.fleet.service import LocalService

setup_app = App(name="setup", help="Prepare this computer for robots and lasers.")


@setup_app.command
def udev(*, write: Annotated[Path | None, Parameter(metavar="FILE")] = None) -> int:
    """Write rules for udev: names that stay, such as /dev/pioneer3/laser-H1234567.

    Without them a laser is /dev/ttyACM0 today and /dev/ttyACM1 after it was plugged
    in again. Robots and lasers are told apart by the serial number of their USB
    adapter; Hokuyo lasers, whose USB has none, are asked for their own. The rules
    also let the group dialout use them. It shows the rules and the commands that
    put them in force; nothing is changed unless you run those.

    Example: pioneer3 setup udev
    Example: pioneer3 setup udev --write 70-pioneer3.rules

    Args:
        write: Put the rules into this file, too.
    """
    from pioneer3.doctor.ports import list_ports
    from pioneer3.doctor.udev import FILE, rules, written

    found = rules(list_ports(), str(Path(sys.argv[0]).resolve()))
    if not found:
        write_warning("no USB serial port is here: plug in the robots and lasers, then try again")
        return 1
    text = written(found)
    if write is not None:
        write.write_text(text, encoding="utf-8")
    write_line(text)
    name = write or "70-pioneer3.rules"
    if write is None:
        write_line(f"# To use them: pioneer3 setup udev --write {name}")
    write_line(f"# sudo cp {name} {FILE}")
    write_line("# sudo udevadm control --reload && sudo udevadm trigger --subsystem-match=tty")
    write_line("# Then: pioneer3 run --laser /dev/pioneer3/laser-..., with the name you see there")
    return 0


@setup_app.command
def service(
    *command: Annotated[str, Parameter(allow_leading_hyphen=True)],
    system: Flag = False,
    print_: Annotated[Flag, Parameter(name="--print")] = False,
    status: Flag = False,
    remove: Flag = False,
) -> int:
    """Let this computer start a robot's program when it is switched on (systemd).

    It is the command that follows: run, ros1, ros2 or bridge with its options, and
    the variables PIONEER3_... of this terminal. It comes back after a fault, and
    stops the robot on every way out. The exit code is 1 if it does not run.

    Example: pioneer3 setup service --print run --port /dev/ttyUSB0
    Example: pioneer3 setup service run --port /dev/ttyUSB0
    Example: pioneer3 setup service --status

    Args:
        command: What to start; names of files are those of this folder.
        system: A service of the system, for which you are root; else one of your own.
        print_: Show the unit and what is wrong with the ports; change nothing.
        status: Say whether it runs, and its last lines.
        remove: Stop it, and start it no more.
    """
    from pioneer3.fleet.service import LocalService, check_ports, unit_here

    if command and (status or remove):
        raise ConfigError(f"{command[0]!r}: --status and --remove take no command")
    found = LocalService.found()
    if status or remove:
        if found is None:
            write_line("no service of pioneer3 is installed here")
            return 1 if status else 0
        if status:
            return _show_service(found)
        found.remove()
        write_line(f"removed {found.path}")
        return 0
    words = separate_ros_arguments(command)
    unit = unit_here(words, with_root=system, environment=os.environ)
    _check(words)
    _warn_of(check_ports(words, with_root=system, runs=found is not None))
    chosen = LocalService(with_root=system)
    if print_:
        write_line(unit.text().rstrip("\n"))
        write_line(f"# To use it, without --print; it becomes {chosen.path}")
        return 0
    chosen.install(unit)
    return _show_service(chosen)


def _check(words: list[str]) -> None:
    """Refuse a command whose options are wrong now, not when the computer is switched on."""
    from pioneer3.cli.bridge import bridge
    from pioneer3.cli.ros1 import ros1_app
    from pioneer3.cli.run import run

    served = App(name="pioneer3")
    for each in (run, bridge, ros1_app, ros2_app):
        served.command(each)
    served.parse_args(gather_ros_arguments(words), exit_on_error=False, print_error=False)


def _warn_of(findings: "Iterable[Finding]") -> None:
    from pioneer3.cli.tables import findings_table
    from pioneer3.cli.terminal import Terminal

    if found := tuple(findings):
        Terminal(stderr=True).print(findings_table(found))


def _show_service(service: "LocalService") -> int:
    """Show the state of a service; return the exit code."""
    state = service.state()
    write_line(f"{state.path}: {state.active}, restarts: {state.restarts}")
    for line in state.lines:
        write_line(f"  {line}")
    if not state.starts:
        write_warning(f"it does not start with the computer yet; run: {service.how_to_start}")
    return 0 if state.active == "active" else 1
