"""`pioneer3 fleet`: the robots of a fleet file; its commands are listed at the end."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Group, Parameter

from pioneer3.cli.fleet_discover import discover
from pioneer3.cli.fleet_drive import drive, stop
from pioneer3.cli.fleet_group import GROUP_COMMANDS
from pioneer3.cli.fleet_network import aliases, hosts, ssh_config, tell_applied
from pioneer3.cli.fleet_tables import list_
from pioneer3.cli.fleet_work import WORK
from pioneer3.cli.options import UNITS, Flag, FleetFile
from pioneer3.cli.process import ask, write_error, write_line
from pioneer3.errors import ConfigError

fleet_app = App(
    name="fleet",
    help="""Many robots: one file describes them, and commands work on all.

    The file is fleet.toml here, else ~/.config/pioneer3/fleet.toml; --fleet FILE or
    PIONEER3_FLEET names another one.

    Example: pioneer3 fleet init
    Example: pioneer3 fleet list
    """,
    help_epilogue=UNITS,
)


def init(
    *robot: Annotated[str, Parameter(negative=(), metavar="NAME=ADDRESS")],
    fleet: Annotated[
        FleetFile, Parameter(help="The new file; fleet.toml here if it is not given.")
    ] = None,
    operator: str | None = None,
    user: str = "pioneer",
    model: str = "",
    ros: Literal["", "1", "2"] = "",
    yes: Flag = False,
) -> int:
    """Write a fleet file; asks for all that is not given.

    A file that is there is replaced only after a question, and kept as a backup.
    Robots without ROS get bridge = 8101, where others reach them once they have
    the service of fleet deploy.

    Example: pioneer3 fleet init
    Example: pioneer3 fleet init p3at-1=192.168.1.113 p3at-2=192.168.1.114 --yes

    Args:
        robot: NAME=ADDRESS of each, such as p3at-1=192.168.1.113.
        operator: NAME=ADDRESS of this computer; its own if it is not given.
        user: Account on the robots' computers.
        model: Type of the robots, if they do not tell it themselves: p3dx-sh, mine.p.
        ros: Version of ROS on the robots' computers.
        yes: Ask nothing; a file that is there is an error.
    """
    from pioneer3.fleet.edit import Change, text_of
    from pioneer3.fleet.inventory import FILE, draft, here, robot_of, to_toml
    from pioneer3.fleet.spec import Defaults, OperatorComputer
    from pioneer3.links.urls import TCP_PORT

    path = fleet or Path(FILE)
    if yes and text_of(path):
        raise ConfigError(f"{path}: it is there already; name another file with --fleet")
    robots = list(robot)
    if not yes:
        user = ask("User on the robots", user)
        model = ask("Model of the robots, if they do not tell it", model)
        ros = _version(ask("Version of ROS on the robots: 1, 2 or none", ros or "none"))
        while word := ask("Robot as NAME=ADDRESS, or Enter to end", ""):
            try:
                draft(path, OperatorComputer(), Defaults(), [*robots, word])
            except ConfigError as error:
                write_error(str(error))
            else:
                robots.append(word)
    me = here(robots)
    if operator is not None:
        given = robot_of(operator, Defaults())
        me = OperatorComputer(name=given.name, address=given.address)
    if not yes:
        name = ask("This computer's name", me.name)
        me = OperatorComputer(name=name, address=ask("This computer's address", me.address))
    defaults = Defaults(user=user, model=model, ros=ros, bridge=0 if ros else TCP_PORT)
    fleet_ = draft(path, me, defaults, robots)
    change = Change.of(path, to_toml(fleet_))
    if change.old and change.is_needed:
        write_line(change.diff())
        if not ask(f"Replace {path}? yes or no", "no").startswith("y"):
            write_line(f"{path} stays as it is.")
            return 1
    tell_applied(change)
    write_line("Next: pioneer3 fleet list, and pioneer3 fleet hosts for the names of all.")
    return 0


def _version(answer: str) -> Literal["", "1", "2"]:
    match answer:
        case "1" | "2":
            return answer
        case "none" | "":
            return ""
    raise ConfigError(f"{answer}: expected 1, 2 or none")


COMMANDS: dict[str, tuple[tuple[str, Callable[..., object]], ...]] = {
    "The file": (("init", init), ("discover", discover), ("list", list_)),
    "Driving": (("drive", drive), *GROUP_COMMANDS, ("stop", stop)),
    "Names on this computer": (("hosts", hosts), ("ssh-config", ssh_config), ("aliases", aliases)),
    "Work on the robots": WORK,
}
"""The commands in their groups, each with its name; others are added here."""

for number, (title, commands) in enumerate(COMMANDS.items()):
    group = Group(title, sort_key=number)
    for place, (name, command) in enumerate(commands):
        fleet_app.command(command, name=name, group=group, sort_key=place)
