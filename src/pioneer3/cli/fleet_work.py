"""`pioneer3 fleet run` and its kin: work on the computers of many robots at once."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import SEVERAL, Flag, FleetFile, Json, Seconds, fleet_of
from pioneer3.cli.process import busy_sign, until_told_to_leave, write_json, write_line
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.fleet.spec import FleetRobot
    from pioneer3.fleet.ssh import Login


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class RobotsOptions:
    """The robots, and how long to wait for one.

    Attributes:
        on: Names of robots or groups, such as p3at-1,front; once for each or with commas.
        timeout: Give up a robot that does not answer for so long.
    """

    on: Annotated[tuple[str, ...], Parameter(metavar="NAMES"), SEVERAL] = ("all",)
    fleet: FleetFile = None
    timeout: Seconds = 20.0

    def robots(self) -> "tuple[FleetRobot, ...]":
        """Return the robots that are meant; ConfigError for none, or a wrong fleet file."""
        names = [name.strip() for words in self.on for name in words.split(",")]
        return fleet_of(self.fleet).select(name for name in names if name)

    @property
    def login(self) -> "Login":
        """How to log in."""
        from pioneer3.fleet.ssh import Login

        return Login(patience=self.timeout)


ROBOTS = RobotsOptions()
FollowFlag = Annotated[bool, Parameter(name=["--follow", "-f"], negative=(), show_default=False)]


@until_told_to_leave
async def run(
    *command: Annotated[str, Parameter(metavar="CMD")],
    limit: Seconds | None = None,
    which: RobotsOptions = ROBOTS,
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
    """
    if not command:
        raise ConfigError("no command is given; for instance: pioneer3 fleet run uptime")
    return await _run(" ".join(command), limit, which)


async def _run(command: str, limit: float | None, which: RobotsOptions) -> int:
    from pioneer3.cli.fleet_output import RobotLines, finish
    from pioneer3.fleet.run import run_on

    robots = which.robots()
    lines = RobotLines(robots)
    return finish(await run_on(robots, command, lines.show, login=which.login, limit=limit))


@until_told_to_leave
async def push(
    *paths: Annotated[str, Parameter(metavar="FILE")], which: RobotsOptions = ROBOTS
) -> int:
    """Copy files or folders to the robots' computers, to all at once.

    The last argument is where to: a folder if it ends in a slash, is one there, or
    several files are given; relative to the home of the user there. A file that is
    already there is replaced only when all of the new one has arrived.

    Example: pioneer3 fleet push demo.launch catkin_ws/src/demo/launch/
    Example: pioneer3 fleet push --on p3at-1 .bashrc .bashrc

    Args:
        paths: Files and folders of this computer, then the place there.
    """
    from pioneer3.cli.fleet_output import finish
    from pioneer3.fleet.copy import push as push_to

    if len(paths) < 2:
        raise ConfigError("files and where to are needed: pioneer3 fleet push lab.map maps/")
    robots = which.robots()
    with busy_sign(f"Copying to {len(robots)} robots ..."):
        *files, destination = paths
        outcomes = await push_to(robots, [*map(Path, files)], destination, login=which.login)
    return finish(outcomes)


@until_told_to_leave
async def pull(
    *paths: Annotated[str, Parameter(metavar="PATH")],
    to: Annotated[Path, Parameter(metavar="FOLDER")] = Path(),
    which: RobotsOptions = ROBOTS,
) -> int:
    """Copy files or folders from the robots' computers.

    Those of each robot go into a folder of its name.

    Example: pioneer3 fleet pull 'runs/*.mcap' --to monday
    Example: pioneer3 fleet pull --on p3at-1 /var/log/syslog

    Args:
        paths: Of files and folders there, relative to the home of the user; *, ? and [...] in
            quotes.
        to: The folder in which those of the robots are made.
    """
    from pioneer3.cli.fleet_output import finish
    from pioneer3.fleet.copy import pull as pull_from

    if not paths:
        raise ConfigError("no file is given; for instance: pioneer3 fleet pull 'runs/*.mcap'")
    robots = which.robots()
    with busy_sign(f"Copying from {len(robots)} robots ..."):
        outcomes = await pull_from(robots, paths, to, login=which.login)
    return finish(outcomes)


@until_told_to_leave
async def key(
    *names: Annotated[str, Parameter(metavar="NAMES")],
    accept_new: Flag = False,
    no_passphrase: Flag = False,
    which: RobotsOptions = ROBOTS,
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
    """
    from pioneer3.cli.fleet_output import TerminalAsker, finish, show_password_advice
    from pioneer3.fleet import key

    if names:
        which = replace(which, on=names)
    robots = which.robots()
    public = key.public_key() or await key.agent_key()
    if public is None:
        write_line(f"Making you a key, {key.make_key(passphrase=not no_passphrase)}.")
        public = key.public_key()
        assert public is not None
    person = TerminalAsker(accept_new=accept_new)
    outcomes = await key.install_key(robots, public, person, login=which.login)
    code = finish(outcomes)
    well = [robot for robot, each in zip(robots, outcomes, strict=True) if each.ok]
    show_password_advice(await key.with_passwords(well, login=which.login))
    return code


@until_told_to_leave
async def status(*, json: Json = False, which: RobotsOptions = ROBOTS) -> int:
    """Show the robots' computers: clocks, disks, load, versions, and our service.

    It asks over ssh; fleet list asks the robots themselves, without.

    Example: pioneer3 fleet status
    """
    from pioneer3.cli.fleet_output import finish, print_json, status_table
    from pioneer3.cli.terminal import Terminal
    from pioneer3.fleet.doctor import gather

    robots = which.robots()
    with busy_sign(f"Asking {len(robots)} robots ..."):
        fleet = fleet_of(which.fleet)
        facts, outcomes = await gather(fleet, robots, login=which.login)
    if json:
        return print_json({each.robot: facts.get(each.robot) for each in outcomes}, outcomes)
    Terminal().print(status_table(facts))
    return finish(outcomes, quiet=True)


@until_told_to_leave
async def logs(
    *, follow: FollowFlag = False, lines: int = 20, which: RobotsOptions = ROBOTS
) -> int:
    """Show the output of the service that drives the robot, on all robots.

    Example: pioneer3 fleet logs
    Example: pioneer3 fleet logs -f --on p3at-2

    Args:
        follow: Show new lines as they come, until Ctrl-C.
        lines: Number of old lines to show of each.
    """
    from pioneer3.fleet.host_facts import logs_command

    return await _run(logs_command(lines, follow=follow), None, which)


@until_told_to_leave
async def doctor(
    *,
    every: Annotated[bool, Parameter(name="--all", negative=(), show_default=False)] = False,
    json: Json = False,
    which: RobotsOptions = ROBOTS,
) -> int:
    """Check the robots' computers; name faults and remedies.

    Disks, names, firewalls, clocks, serial ports, ROS variables, versions and
    passwords. Nothing is changed. The exit code is 0 unless a check failed.

    Example: pioneer3 fleet doctor
    Example: pioneer3 fleet doctor --on p3at-1 --all

    Args:
        every: Show the checks that went well, too.
    """
    from pioneer3.cli.fleet_output import print_diagnoses
    from pioneer3.fleet.doctor import diagnose, exit_code

    robots = which.robots()
    with busy_sign(f"Asking {len(robots)} robots ..."):
        diagnoses = await diagnose(fleet_of(which.fleet), robots, login=which.login)
    if json:
        write_json(diagnoses, indent=2)
    else:
        print_diagnoses(diagnoses, every=every)
    return exit_code(diagnoses)


@until_told_to_leave
async def deploy(
    *,
    with_: Annotated[tuple[str, ...], Parameter(name="--with", metavar="EXTRA"), SEVERAL] = (),
    no_service: Flag = False,
    which: RobotsOptions = ROBOTS,
) -> int:
    """Install pioneer3 on the robots' computers, as it is here, with a service.

    The robots need no internet. A service drives the robot when its computer is
    switched on: the node of ROS for ros = "1" or "2", else pioneer3 run; as the
    user of the fleet file. A version that does not start gives way to the one
    before it.

    Example: pioneer3 fleet deploy
    Example: pioneer3 fleet deploy --on p3at-1 --with nav

    Args:
        with_: An optional part, such as nav; once for each.
        no_service: Only install; leave the service as it is.
    """
    from pioneer3.cli.fleet_output import finish
    from pioneer3.fleet import deploy as deployment

    robots = which.robots()
    with busy_sign(f"Installing on {len(robots)} robots ..."):
        outcomes = await deployment.deploy(
            fleet_of(which.fleet), robots, login=which.login, extras=with_, service=not no_service
        )
    return finish(outcomes)


WORK: tuple[tuple[str, Callable[..., object]], ...] = (
    ("key", key),
    ("run", run),
    ("push", push),
    ("pull", pull),
    ("deploy", deploy),
    ("status", status),
    ("logs", logs),
    ("doctor", doctor),
)
"""The commands, each with its name."""
