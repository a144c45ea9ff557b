"""`pioneer3 fleet form`, `follow-leader` and `spread`: a command for each mode of groups."""

import sys
from collections.abc import Callable
from inspect import Parameter as Argument
from textwrap import fill
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.behaviors.modes.group import GROUP_MODES, GroupMode
from pioneer3.cli.fleet_ros import connecting
from pioneer3.cli.motion import keyword, mode_options, positional, with_signature
from pioneer3.cli.options import FleetFile, Length, MaxSpeed, Seconds, Speed, TurnRate, fleet_of
from pioneer3.cli.process import run_until_told_to_leave
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.fleet.group import GroupKey
    from pioneer3.fleet.spec import Fleet, FleetRobot
    from pioneer3.teleop.keyboard import Manner

WIDTH = 79
KEYS = (
    "The robots MOVE once g is pressed: it starts the mode, and again after a stop. The table is "
    "that of fleet drive, and so are its keys: space stops ALL robots, k is the emergency stop."
)
LEADS = "The arrows drive the leader, which is chosen."
PLACES = (
    "Robots of one simulator know where the others are. Real ones have to be lined up: side by "
    "side, all looking ahead, from left to right by their numbers; --lined-up is how far apart."
)


def group_command(mode: type[GroupMode]) -> Callable[..., int]:
    """Return the function of the command that drives robots in `mode`."""

    def run(
        *given: str,
        leader: str | None = None,
        lined_up: float | None = None,
        fleet: FleetFile = None,
        key_speed: float = 0.3,
        key_turn_rate: float = 0.3,
        max_speed: float | None = None,
        seconds: float = 600.0,
        **named: Any,
    ) -> int:
        values = {**dict(zip(mode.arguments, given, strict=False)), **named}
        return _run(
            mode(**values, seconds=seconds),
            given[len(mode.arguments) :] or ("all",),
            fleet_of(fleet),
            leader=leader,
            lined_up=lined_up,
            speeds=(key_speed, key_turn_rate, max_speed),
        )

    words = [mode.advice(), KEYS, LEADS if mode.led else "", PLACES]
    text = "\n\n".join(fill(part, WIDTH) for part in words if part)
    example = f"Example: pioneer3 fleet {mode.name()} {mode.example}"
    run.__doc__ = f"{mode.summary()}\n\n{text}\n\n{example}"
    return with_signature(run, mode.name().replace("-", "_"), _arguments(mode))


def _arguments(mode: type[GroupMode]) -> list[Argument]:
    robots = "Robots or groups; all if none is given."
    names = Argument(
        "names",
        Argument.VAR_POSITIONAL,
        annotation=Annotated[str, Parameter(negative=(), metavar="NAME", help=robots)],
    )
    leads = Annotated[str | None, Parameter(help="Its name; the first robot if not given.")]
    apart = "They stand in line, so far apart from middle to middle."
    options = [
        *mode_options(mode),
        *([keyword("leader", leads, None)] if mode.led else []),
        keyword("lined_up", Annotated[Length | None, Parameter(help=apart)], None),
        keyword("fleet", FleetFile, None),
        keyword("key_speed", Annotated[Speed, Parameter(help="Of the forward key.")], 0.3),
        keyword("key_turn_rate", Annotated[TurnRate, Parameter(help="Of turning keys.")], 0.3),
        keyword("max_speed", MaxSpeed | None, None),
        keyword("seconds", Annotated[Seconds, Parameter(help="The mode ends after this.")], 600.0),
    ]
    return [*positional(mode), names, *options]


def _run(
    mode: GroupMode,
    names: tuple[str, ...],
    fleet: "Fleet",
    *,
    leader: str | None,
    lined_up: float | None,
    speeds: tuple[float, float, float | None],
) -> int:
    from pioneer3.fleet.group import GroupKey
    from pioneer3.teleop.keyboard import Manner

    robots = fleet.select(names)
    known = [robot.name for robot in robots]
    if len(robots) < 2:
        raise ConfigError(f"fleet {mode.name()}: one robot is no group; name two or more")
    if mode.led:
        leader = leader or known[0]
        if leader not in known:
            raise ConfigError(f"--leader {leader}: it is not one of {', '.join(known)}")
    if not (sys.stdin and sys.stdin.isatty() and sys.stdout and sys.stdout.isatty()):
        raise ConfigError(f"fleet {mode.name()} needs a terminal: its keys and table are on it")
    manner = Manner(speed=speeds[0], turn_rate=speeds[1], max_speed=speeds[2])
    together = GroupKey(mode=mode, leader=leader)
    return run_until_told_to_leave(_drive(fleet, robots, manner, together, lined_up))


async def _drive(
    fleet: "Fleet",
    robots: "tuple[FleetRobot, ...]",
    manner: "Manner",
    together: "GroupKey",
    lined_up: float | None,
) -> int:
    from pioneer3.fleet.drive import FleetDrive
    from pioneer3.fleet.screen import run_screen

    name = f"fleet_{together.mode.name().replace('-', '_')}"
    async with connecting(fleet, name, manner.max_speed, sonar=True) as connect:
        drive = FleetDrive(robots, connect, manner, together=together, lined_up=lined_up)
        return await run_screen(drive)


GROUP_COMMANDS = tuple((mode.name(), group_command(mode)) for mode in GROUP_MODES)
"""Names and functions of the commands."""
