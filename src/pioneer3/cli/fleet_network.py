"""`pioneer3 fleet hosts`, `ssh-config` and `aliases`: names of the robots on this computer."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, FleetFile, fleet_of
from pioneer3.cli.process import write_line
from pioneer3.errors import ConfigError, FilePermissionError

if TYPE_CHECKING:
    from pioneer3.doctor.facts import Finding
    from pioneer3.fleet.edit import Change


def hosts(
    *,
    fleet: FleetFile = None,
    apply: Flag = False,
    file: Path = Path("/etc/hosts"),
    name: str | None = None,
) -> int:
    """Check the names of all computers on this one, and print their entries.

    With --apply it writes them as a block into /etc/hosts, which needs root: it
    shows the difference and keeps a backup. Lines that say something else of the
    same names lose those. The same entries belong on every computer of the fleet.
    The exit code is 1 if something is wrong and stays so.

    Example: pioneer3 fleet hosts

    Args:
        apply: Write the entries.
        file: The file with the names.
        name: Host name of the computer it is of; this one's if it is not given.
    """
    import socket

    from pioneer3.doctor.facts import Level
    from pioneer3.fleet.edit import Change, text_of
    from pioneer3.fleet.hosts import check_hosts, entries, with_entries

    given, text = fleet_of(fleet), text_of(file)
    found = check_hosts(text, given, name or socket.gethostname())
    _print(found)
    change = Change.of(file, with_entries(text, given))
    if not apply:
        for entry in entries(given):
            write_line(str(entry))
        return int(any(finding.level is Level.FAIL for finding in found))
    try:
        show_applied(change)
    except FilePermissionError:
        words = [sys.argv[0], "fleet", "hosts", "--apply", "--fleet", str(given.path.resolve())]
        words += [] if file == Path("/etc/hosts") else ["--file", str(file)]
        raise FilePermissionError(
            f"{file}: only root may change it; run: sudo {shlex.join(words)}"
        ) from None
    return 0


def ssh_config(*, fleet: FleetFile = None, apply: Flag = False) -> int:
    """Let ssh p3at-1 find the robot: address and user come from the fleet file.

    It prints a file for ssh to include. With --apply it is written, and the line
    that includes it goes to the top of ~/.ssh/config: it shows the difference and
    keeps a backup.

    Example: pioneer3 fleet ssh-config

    Args:
        apply: Write ~/.ssh/config.d/pioneer3, and include it.
    """
    from pioneer3.fleet.edit import Change, text_of
    from pioneer3.fleet.ssh_config import INCLUDE, INCLUDED, ssh_hosts, with_include

    given, folder = fleet_of(fleet), Path.home() / ".ssh"
    if not apply:
        write_line(ssh_hosts(given).rstrip())
        write_line(f"\n# Save it as {folder / INCLUDED}, and begin {folder / 'config'} with:")
        write_line(f"# {INCLUDE}")
        write_line("# Or let that be done: pioneer3 fleet ssh-config --apply")
        return 0
    main = folder / "config"
    show_applied(Change.of(folder / INCLUDED, ssh_hosts(given), mode=0o600))
    show_applied(Change.of(main, with_include(text_of(main), folder), mode=0o600))
    return 0


def aliases(
    *,
    fleet: FleetFile = None,
    prefix: Annotated[str, Parameter(metavar="PREFIX")] = "CR_",
    apply: Flag = False,
    file: Path | None = None,
) -> int:
    """Print an alias for each robot: CR_113 opens ssh on the one at 192.168.1.113.

    fleet ssh-config is the better way for most: ssh p3at-1 works with scp, rsync
    and editors too.

    Example: pioneer3 fleet aliases
    Example: pioneer3 fleet aliases --apply

    Args:
        prefix: Beginning of each alias.
        apply: Write them as a block into ~/.bashrc, with the difference and a backup.
        file: Another start-up file than ~/.bashrc.
    """
    from pioneer3.fleet.edit import Change, text_of
    from pioneer3.fleet.ssh_config import aliases as made
    from pioneer3.fleet.ssh_config import with_aliases

    if not prefix.isidentifier():
        raise ConfigError(f"--prefix {prefix!r}: letters, digits and _ only, such as CR_")
    given = fleet_of(fleet)
    if not apply:
        for line in made(given, prefix):
            write_line(line)
        return 0
    path = file or Path.home() / ".bashrc"
    show_applied(Change.of(path, with_aliases(text_of(path), given, prefix)))
    write_line("They are there in the next shell.")
    return 0


def show_applied(change: "Change") -> None:
    """Show a change of a file, make it, and tell that it was made."""
    if change.is_needed:
        write_line(change.diff())
    tell_applied(change)


def tell_applied(change: "Change") -> None:
    """Make a change of a file, and tell that it was made."""
    if not change.is_needed:
        write_line(f"{change.path} is so already.")
        return
    backup = change.apply()
    kept = f"; the old one is {backup}" if backup else ""
    write_line(f"{change.path} is written{kept}.")


def _print(findings: "Sequence[Finding]") -> None:
    """Print findings to stderr: stdout has the entries alone."""
    if not findings:
        return
    from pioneer3.cli.tables import findings_table
    from pioneer3.cli.terminal import Terminal

    Terminal(stderr=True).print(findings_table(findings))
