"""`pioneer3 setup`: prepares this computer for robots and lasers."""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from pioneer3.cli.process import write_line, write_warning

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
