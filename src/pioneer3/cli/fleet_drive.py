"""`pioneer3 fleet drive` and `pioneer3 fleet stop`: all robots at one keyboard."""

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.fleet_ros import connecting
from pioneer3.cli.options import (
    Flag,
    FleetFile,
    Json,
    Length,
    MaxSpeed,
    Patience,
    Seconds,
    Speed,
    TurnRate,
    fleet_of,
)
from pioneer3.cli.process import until_told_to_leave, write_json
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.fleet.stop import Stopped

TO_SAY = 0.2
"""Part of a robot's time [s] that is left to say that its node is missing."""
Names = Annotated[str, Parameter(negative=(), metavar="NAME")]


@until_told_to_leave
async def drive(
    *names: Names,
    fleet: FleetFile = None,
    speed: Speed = 0.1,
    turn_rate: TurnRate = 0.1,
    max_speed: MaxSpeed | None = None,
    latch: Flag = False,
    patience: Patience = 10.0,
    lined_up: Length | None = None,
) -> int:
    """Drive several robots with one keyboard: one, some or all of them together.

    Arrows drive those chosen: q goes on to the next robot, a number chooses one, a
    all, s several: mark them, then y. A click does, too. The others stand. Space
    stops ALL robots, k is the emergency stop of all, Ctrl-R releases it, Ctrl-D
    quits, and all stand. A key acts for 0.6 s, and its repeats extend that.
    Robots that know where the others are keep apart: those of one simulator do.

    Example: pioneer3 fleet drive
    Example: pioneer3 fleet drive front p3at-5 --speed 0.3

    Args:
        names: Robots or groups; all if none is given.
        speed: Of the forward key; + and - change it.
        turn_rate: Of the turning keys; + and - change it.
        latch: One press keeps moving until another key, as in the lab's rob_key_multi.
        patience: Time after which --latch stops them without a key; 10 at most.
        lined_up: The robots stand side by side, so far apart, from left to right by their
            numbers, all looking ahead: then they know where the others are.
    """
    from pioneer3.fleet.drive import FleetDrive
    from pioneer3.fleet.screen import run_screen
    from pioneer3.teleop.keyboard import Manner

    given = fleet_of(fleet)
    robots = given.select(names or ("all",))
    if not (sys.stdin and sys.stdin.isatty() and sys.stdout and sys.stdout.isatty()):
        raise ConfigError("fleet drive needs a terminal: its keys and its table are on it")
    manner = Manner(
        speed=speed, turn_rate=turn_rate, max_speed=max_speed, latch=latch, patience=patience
    )

    async with connecting(given, "fleet_drive", manner.max_speed) as connect:
        return await run_screen(FleetDrive(robots, connect, manner, lined_up=lined_up))


@until_told_to_leave
async def stop(
    *names: Names,
    fleet: FleetFile = None,
    emergency: Flag = False,
    patience: Annotated[Seconds, Parameter(name="--timeout")] = 3.0,
    json: Json = False,
) -> int:
    """Stop all robots now, from any computer that reaches them.

    All are told at once; one that is off delays nobody. It names those that
    have confirmed it: their own reports say that they stand. A robot takes one
    program at a time: where another one is connected to its port, the robot is not
    reached; stop it there, with k. A bridge (bridge = 8101 in the fleet file) lets
    stops in all the same; the other program has to switch the motors on again. A
    node of ROS is reached, too, and goes on as soon as another program drives it.
    Its motors are off afterwards with --emergency, or if it was reached by its own
    port; a node of ROS 2 then keeps its emergency stop latched, until Ctrl-R in
    fleet drive or its e_stop_reset. The exit code is 1 if a robot has not
    confirmed, and 3 if none was reached.

    Example: pioneer3 fleet stop
    Example: pioneer3 fleet stop --emergency

    Args:
        names: Robots or groups; all if none is given.
        emergency: As hard as they can, and motors off.
        patience: For each robot.
    """
    from pioneer3.fleet.run import exit_code
    from pioneer3.fleet.stop import stop_all

    given = fleet_of(fleet)
    robots = given.select(names or ("all",))
    waits = patience - TO_SAY
    async with connecting(given, "fleet_stop", None, patience=waits, at_once=True) as connect:
        answers = await stop_all(robots, connect, emergency=emergency, patience=patience)
        if json:
            write_json(answers)
        else:
            _print(answers)
    return exit_code(answers)


def _print(answers: "tuple[Stopped, ...]") -> None:
    from rich.table import Table
    from rich.text import Text

    from pioneer3.cli.terminal import Terminal

    made = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("robot", "state", "after", "why"):
        made.add_column(title, overflow="fold")
    for each in answers:
        state = "stands" if each.ok else "NOT CONFIRMED" if each.reached else "NOT REACHED"
        shown = Text(state, "green" if each.ok else "bold red")
        made.add_row(each.robot, shown, f"{each.seconds:.2f} s", each.why or _note(each))
    console = Terminal(wide=True)
    console.print(made)
    missed = sum(not each.ok for each in answers)
    if missed:
        words = f"{missed} of {len(answers)} robots may still move: go there, or press their button"
        console.print(Text(words, "bold red"))


def _note(answer: "Stopped") -> str:
    if not answer.taken:
        return ""
    return "another program drove it, and has to switch the motors on before it drives on"
