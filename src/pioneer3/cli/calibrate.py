"""`pioneer3 calibrate`: measure how wrong odometry and laser are, and write that down."""

from contextlib import suppress
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.live import announce, how_to_stop, show_while
from pioneer3.cli.options import LINK, NAVIGATION, Flag, Length, LinkOptions, NavigationOptions
from pioneer3.cli.places import MapName, StartPlace, require_place
from pioneer3.cli.process import (
    read_line,
    run_until_told_to_leave,
    write_error,
    write_line,
    write_warning,
)
from pioneer3.errors import CommandError, ConfigError, DeviceError, MotionError
from pioneer3.nav.place_text import pose_of
from pioneer3.units import ANGLE, LENGTH

if TYPE_CHECKING:
    from pioneer3.calibration.calibration import Calibration
    from pioneer3.calibration.course import StepDrive
    from pioneer3.calibration.procedure import Procedure
    from pioneer3.calibration.steps import CalibrationStep
    from pioneer3.runtime.robot import Robot

SHORTEST = 0.5
"""Shortest side of a square and length of a line [m]."""
LONGEST = 20.0
"""Longest ones [m]."""
KEYS = "Enter drives, s skips this step, u forgets the last one, q ends"
AFTER = "Enter keeps it, r drives this step again"
AGAIN = "Enter measures it once more, r drives this step again"


def calibrate(
    *,
    link: LinkOptions = LINK,
    side: Annotated[Length | None, Parameter(validator=Number(gte=SHORTEST, lte=LONGEST))] = None,
    length: Annotated[Length | None, Parameter(validator=Number(gte=SHORTEST, lte=LONGEST))] = None,
    rounds: Annotated[int, Parameter(validator=Number(gte=1, lte=10))] = 2,
    map_: MapName = None,
    start: StartPlace = None,
    by_tape: Flag = False,
    yes: Flag = False,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Measure how wrong odometry is, and write that into the robot's own file.

    It takes a tape measure, something to mark the floor with, two by two metres of
    free floor, and a quarter of an hour. The robot turns, and drives squares both
    ways and a line; you measure where each ends. With a laser it needs no tape: it
    measures by its scans, or on a map, and finds where the laser is mounted and how
    late its scans are, too.

    The robot MOVES, and stops before whatever its sonars or laser see: stand by its
    stop button. Any key stops it, k is the emergency stop.

    Example: pioneer3 calibrate --port /dev/ttyUSB0
    Example: pioneer3 calibrate --map office --start home
    Example: pioneer3 calibrate --side 3m --length 5m

    Args:
        link: The robot.
        side: Of the squares; without it, as long as two by two metres allow.
        length: Of the line; without it as long as a side.
        rounds: Squares each way: more of them make it more certain.
        map_: Measure by a laser on this map: a file, or the name of one that ships.
        start: Where the robot is on it: a name, `x,y,heading`, or `unknown`.
        by_tape: Measure by tape although there is a laser.
        yes: Ask nothing but the numbers that are to be measured: drive and write.
        navigation: Settings.
    """
    if map_ is not None and by_tape:
        raise ConfigError("calibrate: --map measures by a laser, and --by-tape without one")
    options = _Options(side=side, length=length, rounds=rounds, by_tape=by_tape, yes=yes)

    async def command() -> int:
        place = None if start is None else pose_of(start, "calibrate")
        async with link.connect(line_map=map_, start=place, navigation=navigation) as robot:
            return await _calibrate(robot, options)

    return run_until_told_to_leave(command())


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options:
    side: float | None
    length: float | None
    rounds: int
    by_tape: bool
    yes: bool


class _EndError(Exception):
    """Nobody answers any more, or somebody wants to end."""


async def _calibrate(robot: "Robot", options: _Options) -> int:
    from pioneer3.calibration.procedure import Procedure
    from pioneer3.calibration.steps import By

    by_laser = bool(robot.laser.presence.there) and not options.by_tape
    procedure = Procedure(
        robot.info,
        await _calibration(robot, by_laser=by_laser),
        by_laser=by_laser,
        side=options.side,
        length=options.length,
        rounds=options.rounds,
    )
    announce(robot, f"is calibrated by {By.LASER if by_laser else By.TAPE}; {how_to_stop()}")
    reach = procedure.reach
    floor = f"{reach:.1f} x {reach:.1f} m of free floor, mostly ahead of the robot and to its left"
    needs = "" if by_laser else ", a tape measure, and something to mark the floor with"
    write_line(f"It takes {floor}{needs}.")
    whole = False
    try:
        await _take_all(robot, procedure, options)
        whole = True
    except _EndError:
        write_line("")
    for line in procedure.told.lines():
        write_line(line)
    if options.yes and not whole:
        write_warning("nothing is written: not all steps were measured")
        return 1
    return await _write(procedure, options)


async def _calibration(robot: "Robot", *, by_laser: bool) -> "Calibration":
    """Return an empty calibration of a robot, on its map if it has one.

    Raises:
        DeviceError: There is a map and no laser.
        MotionError: It is not sure where the robot is on it.
    """
    from pioneer3.calibration.calibration import Calibration

    model, navigator = robot.info.model, robot.navigator
    if not by_laser:
        if navigator is not None:
            raise DeviceError(f"calibrate: a map needs a laser: {robot.laser.presence}")
        return Calibration(model)
    from pioneer3.navigation.connect import prepare_navigation

    await prepare_navigation()
    laser = (await robot.laser.reading()).sensor_in_robot
    if navigator is None:
        return Calibration(model, laser)
    await require_place(navigator, "calibrate", looks=False)
    here = navigator.estimate.robot_in_map
    assert here is not None
    return Calibration(model, laser, navigator.line_map, here)


async def _take_all(robot: "Robot", procedure: "Procedure", options: _Options) -> None:
    """Drive and measure each step, or what somebody wants in place of it."""
    failed = False
    while (step := procedure.step) is not None:
        write_line(f"\nStep {procedure.number + 1} of {len(procedure.steps)}: {step.title}.")
        write_line(step.needs)
        answer = "" if options.yes and not failed else (await _asked(KEYS)).lower()
        if answer.startswith("q") or (options.yes and failed):
            raise _EndError
        if answer.startswith("s"):
            procedure.skip()
        elif answer.startswith("u"):
            forgotten = procedure.undo()
            write_line(f"forgot {forgotten.name}" if forgotten else "nothing was measured yet")
        else:
            failed = not await _take(robot, procedure, step, options)


async def _take(
    robot: "Robot", procedure: "Procedure", step: "CalibrationStep", options: _Options
) -> bool:
    """Drive and measure the present step; return whether it is to be kept."""
    driven: list[StepDrive] = []

    async def going() -> None:
        driven.append(await procedure.drive(robot))

    try:
        await show_while(robot, going())
        while procedure.step is step:
            try:
                await procedure.take(driven[0], await _answers(step))
            except CommandError as error:
                if options.yes or not step.asks:
                    raise
                write_warning(str(error))
                if (await _asked(AGAIN)).lower().startswith("r"):
                    return False
    except (CommandError, DeviceError, MotionError) as error:
        write_warning(str(error))
        return False
    if options.yes or not step.asks or not (await _asked(AFTER)).lower().startswith("r"):
        return True
    procedure.undo(step)
    return False


async def _answers(step: "CalibrationStep") -> dict[str, float]:
    """Return the measurements of a person [m, rad]; NaN where there is no answer."""
    from pioneer3.calibration.steps import ANGLES, OPTIONAL, QUESTIONS

    answers: dict[str, float] = {}
    for name in step.asks:
        quantity, unit = (ANGLE, "degrees") if name in ANGLES else (LENGTH, "m, or with its unit")
        hint = "; Enter if you do not know" if name in OPTIONAL else ""
        while name not in answers:
            said = await _asked(f"{QUESTIONS[name]}? [{unit}{hint}]")
            if not said and name in OPTIONAL:
                answers[name] = nan
                break
            try:
                answers[name] = quantity.read(said.replace(",", "."))
            except ValueError as error:
                write_warning(str(error))
    return answers


async def _asked(question: str) -> str:
    """Return the answer of a person; _EndError if nobody is there any more."""
    write_error(f"{question}: ", end="")
    line = await read_line()
    if not line:
        raise _EndError
    return line.strip()


async def _write(procedure: "Procedure", options: _Options) -> int:
    """Write the numbers, if they are worth it and somebody wants it; return the exit code."""
    from pioneer3.calibration.own_file import write_numbers

    estimate, numbers = procedure.told.estimate(), procedure.numbers()
    if numbers is None:
        return int(estimate is None or not estimate.is_known)
    write_line(f"\nFor {procedure.path}:\n{numbers.text.rstrip()}")
    if not options.yes:
        answer = ""
        with suppress(_EndError):
            answer = await _asked(f"Write them into {procedure.path}? yes or no")
        if not answer.lower().startswith("y"):
            write_line(f"{procedure.path} stays as it is")
            return 0
    path, before = write_numbers(procedure.info, numbers)
    write_line(f"wrote {path}; it counts from the next connection on")
    if before is not None:
        write_line(f"the file as it was before is {before}")
    return 0
