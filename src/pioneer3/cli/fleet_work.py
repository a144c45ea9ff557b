"""`pioneer3 fleet run` and its kin: work on the computers of many robots at once."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import SEVERAL, Flag, FleetFile, Seconds, fleet_of
from pioneer3.cli.process import run_until_told_to_leave, write_line

if TYPE_CHECKING:
    from pioneer3.fleet.spec import Robot
    from pioneer3.fleet.ssh import Login


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class RobotsOptions:
    """The robots, and how long to wait for one.

    Attributes:
        on: Names of robots or groups, such as p3at-1,front; once for each or with commas.
        fleet: The fleet file; else $PIONEER3_FLEET, ./fleet.toml, ~/.config/pioneer3/fleet.toml.
        timeout: Give up a robot that does not answer for so long.
    """

    on: Annotated[tuple[str, ...], Parameter(metavar="NAMES"), SEVERAL] = ("all",)
    fleet: FleetFile = None
    timeout: Seconds = 20.0

    def robots(self) -> "tuple[Robot, ...]":
        """Return the robots that are meant.

        Raises:
            ConfigError: The fleet file is wrong, or has no such robot.
        """
        names = [name.strip() for words in self.on for name in words.split(",")]
        return fleet_of(self.fleet).select(name for name in names if name)

    @property
    def login(self) -> "Login":
        """How to log in."""
        from pioneer3.fleet.ssh import Login

        return Login(patience=self.timeout)


ROBOTS = RobotsOptions()


def run(
    *command: Annotated[str, Parameter(metavar="CMD")],
    limit: Seconds | None = None,
    robots: RobotsOptions = ROBOTS,
) -> int:
    """Run a command on the robots' computers, on all at once.

    Each line of output begins with the name of its robot. Ctrl-C ends the command
    everywhere. Put the command in quotes, or after --. The exit code is 0 when it
    succeeded everywhere, 1 when it failed somewhere, 3 when no robot was reached.

    Example: pioneer3 fleet run uptime
    Example: pioneer3 fleet run --on front 'df -h / | tail -1'
    Example: pioneer3 fleet run --on p3at-2 -- journalctl -n 20

    Args:
        command: For the shell there.
        limit: Stop the command after this time.
        robots: Where.
    """
    from pioneer3.errors import ConfigError

    if not command:
        raise ConfigError("no command is given; for instance: pioneer3 fleet run uptime")
    return run_until_told_to_leave(_run(" ".join(command), limit, robots))


async def _run(command: str, limit: float | None, options: RobotsOptions) -> int:
    from pioneer3.cli.fleet_output import Lines, finish
    from pioneer3.fleet.run import run_on

    robots = options.robots()
    lines = Lines(robots)
    return finish(await run_on(robots, command, lines.show, login=options.login, limit=limit))


def push(
    *paths: Annotated[str, Parameter(metavar="FILE")],
    robots: RobotsOptions = ROBOTS,
) -> int:
    """Copy files or folders to the robots' computers, to all at once.

    The last argument is where to: a folder if it ends in a slash, is one there, or
    several files are given; relative to the home of the user there. A file that is
    already there is replaced only when all of the new one has arrived.

    Example: pioneer3 fleet push demo.launch catkin_ws/src/demo/launch/
    Example: pioneer3 fleet push --on p3at-1 .bashrc .bashrc

    Args:
        paths: Files and folders of this computer, then the place there.
        robots: Where.
    """
    from pioneer3.errors import ConfigError

    if len(paths) < 2:
        raise ConfigError("files and where to are needed: pioneer3 fleet push lab.map maps/")
    return run_until_told_to_leave(_push(paths[:-1], paths[-1], robots))


async def _push(files: "tuple[str, ...]", destination: str, options: RobotsOptions) -> int:
    from pioneer3.cli.fleet_output import finish
    from pioneer3.cli.process import busy_sign
    from pioneer3.fleet.copy import push as push_to

    robots = options.robots()
    with busy_sign(f"Copying to {len(robots)} robots ..."):
        outcomes = await push_to(robots, [*map(Path, files)], destination, login=options.login)
    return finish(outcomes)


def pull(
    *paths: Annotated[str, Parameter(metavar="PATH")],
    to: Annotated[Path, Parameter(metavar="FOLDER")] = Path(),
    robots: RobotsOptions = ROBOTS,
) -> int:
    """Copy files or folders from the robots' computers.

    Those of each robot go into a folder of its name.

    Example: pioneer3 fleet pull 'runs/*.mcap' --to monday
    Example: pioneer3 fleet pull --on p3at-1 /var/log/syslog

    Args:
        paths: Of files and folders there, relative to the home of the user; *, ? and [...] in
            quotes.
        to: The folder in which those of the robots are made.
        robots: Where.
    """
    from pioneer3.errors import ConfigError

    if not paths:
        raise ConfigError("no file is given; for instance: pioneer3 fleet pull 'runs/*.mcap'")
    return run_until_told_to_leave(_pull(paths, to, robots))


async def _pull(paths: "tuple[str, ...]", to: Path, options: RobotsOptions) -> int:
    from pioneer3.cli.fleet_output import finish
    from pioneer3.cli.process import busy_sign
    from pioneer3.fleet.copy import pull as pull_from

    robots = options.robots()
    with busy_sign(f"Copying from {len(robots)} robots ..."):
        outcomes = await pull_from(robots, paths, to, login=options.login)
    return finish(outcomes)


def key(
    *names: Annotated[str, Parameter(metavar="NAMES")],
    accept_new: Flag = False,
    no_passphrase: Flag = False,
    robots: RobotsOptions = ROBOTS,
) -> int:
    """Let yourself in on the robots' computers with a key in place of a password.

    It makes a key if you have none, shows the host keys that are new here, asks for
    the robots' password once, installs the key and tries it. The password is kept
    nowhere. Then it says how to switch passwords off.

    Example: pioneer3 fleet key
    Example: pioneer3 fleet key p3at-1

    Args:
        names: Robots and groups, as --on takes them.
        accept_new: Ask nothing about host keys that are new; another key than before is an error.
        no_passphrase: Make the key without a passphrase, if one has to be made.
        robots: Where.
    """
    if names:
        robots = replace(robots, on=names)
    return run_until_told_to_leave(
        _key(robots, accept_new=accept_new, passphrase=not no_passphrase)
    )


async def _key(options: RobotsOptions, *, accept_new: bool, passphrase: bool) -> int:
    from pioneer3.cli.fleet_output import Person, finish, show_password_advice
    from pioneer3.fleet import key

    robots = options.robots()
    public = key.public_key() or await key.agent_key()
    if public is None:
        write_line(f"Making you a key, {key.make_key(passphrase=passphrase)}.")
        public = key.public_key()
        assert public is not None
    person = Person(accept_new=accept_new)
    outcomes = await key.install_key(robots, public, person, login=options.login)
    code = finish(outcomes)
    well = [robot for robot, each in zip(robots, outcomes, strict=True) if each.ok]
    show_password_advice(await key.with_passwords(well, login=options.login))
    return code


WORK: tuple[tuple[str, Callable[..., object]], ...] = (
    ("key", key),
    ("run", run),
    ("push", push),
    ("pull", pull),
)
"""The commands, each with its name."""
