"""`pioneer3 move` and `turn`, and a command for each mode: the robot drives by itself."""

from collections.abc import Callable, Coroutine, Sequence
from inspect import Parameter as Argument
from inspect import Signature
from math import radians
from textwrap import fill
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from pioneer3.behaviors.modes import MODES, Mode
from pioneer3.behaviors.modes.mode import Described, ModeParameter
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import (
    LINK,
    MOTION,
    Angle,
    Length,
    LinkOptions,
    MaxSpeed,
    MotionOptions,
    Speed,
    TurnRate,
    reads,
)

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot

TURN_RATE = radians(45)
MOVES = "The robot MOVES: stand by its stop button. Any key stops it, k is the emergency stop."
WIDTH = 78
"""Width of a help's paragraphs [characters]."""


def move(
    distance: Length,
    /,
    *,
    link: LinkOptions = LINK,
    speed: Speed = 0.3,
    max_speed: MaxSpeed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Drive straight ahead, or backwards, and stop.

    The robot MOVES, and looks out for nothing but its bumpers: see that the way
    is free. Any key stops it, k is the emergency stop.

    Example: pioneer3 move -0.5 --speed 0.2

    Args:
        distance: How far; negative is backwards.
        speed: At most.
    """
    return carry_out(
        lambda robot: motion.bounded(robot.move(distance, speed)),
        "drives",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
    )


def turn(
    angle: Angle,
    /,
    *,
    link: LinkOptions = LINK,
    turn_rate: Annotated[TurnRate, Parameter(name=["--turn-rate", "--rate"])] = TURN_RATE,
    motion: MotionOptions = MOTION,
) -> int:
    """Turn on the spot and stop.

    The robot MOVES: see that its corners are free. Any key stops it, k is the
    emergency stop.

    Example: pioneer3 turn -90
    Example: pioneer3 turn 1.57rad --turn-rate 20

    Args:
        angle: How far; positive is to the left.
        turn_rate: At most.
    """
    return carry_out(
        lambda robot: motion.bounded(robot.turn(angle, turn_rate)),
        "turns",
        link,
        motion,
        turn_rate=turn_rate,
    )


def mode_command(mode: type[Mode]) -> Callable[..., int]:
    """Return the function of the command that runs `mode`."""

    def run(
        *given: float,
        link: LinkOptions = LINK,
        max_speed: float | None = None,
        motion: MotionOptions = MOTION,
        **named: Any,
    ) -> int:
        values = {**dict(zip(mode.arguments, given, strict=False)), **named}

        def going(robot: "Robot") -> Coroutine[Any, Any, None]:
            stack = mode(**values).stack(robot.info.limits)
            if mode.finishes:
                return motion.bounded(robot.run(stack))
            return robot.run(stack, motion.length)

        speed = values.get("speed")
        return carry_out(going, mode.doing, link, motion, speed=speed, max_speed=max_speed)

    text = fill(f"{mode.advice()} {MOVES}".strip(), WIDTH)
    example = f"Example: pioneer3 {mode.name()} {mode.example}"
    run.__doc__ = f"{mode.summary()}\n\n{text}\n\n{example}"
    common = [
        keyword("link", LinkOptions, LINK),
        *mode_options(mode),
        keyword("max_speed", MaxSpeed | None, None),
        keyword("motion", MotionOptions, MOTION),
    ]
    return with_signature(run, mode.name(), [*positional(mode), *common])


def mode_options(mode: type[Described]) -> list[Argument]:
    """Return the options of a command that runs `mode`."""
    return [
        keyword(one.name, _annotation(one), Argument.empty if one.required else one.default)
        for one in mode.parameters()
        if one.name not in mode.arguments
    ]


def keyword(name: str, annotation: Any, default: object) -> Argument:
    """Return an option of a command."""
    return Argument(name, Argument.KEYWORD_ONLY, default=default, annotation=annotation)


def with_signature(
    run: Callable[..., int], name: str, arguments: Sequence[Argument]
) -> Callable[..., int]:
    """Return `run` as a function with a name and arguments of its own."""
    run.__name__ = name
    run.__annotations__ = {one.name: one.annotation for one in arguments} | {"return": int}
    run.__signature__ = Signature(arguments)  # type: ignore[attr-defined]
    return run


def positional(mode: type[Described]) -> list[Argument]:
    """Return the arguments that a command takes by their order."""
    known = {one.name: one for one in mode.parameters()}
    return [
        Argument(
            name,
            Argument.POSITIONAL_ONLY,
            default=Argument.empty if known[name].required else known[name].default,
            annotation=_annotation(known[name]),
        )
        for name in mode.arguments
    ]


def _annotation(parameter: ModeParameter) -> Any:
    """Return how the command line reads a parameter of a mode."""
    if parameter.quantity is None:
        hints = "; ".join(f"{choice.name}: {choice.hint}" for choice in parameter.choices)
        words = Literal[tuple(choice.name for choice in parameter.choices)]  # type: ignore[valid-type]
        return Annotated[words, Parameter(help=f"{parameter.help} {hints}.".strip())]
    read = reads(parameter.quantity, check=parameter.check)
    optional = not parameter.required and parameter.default is None
    kind: Any = float | None if optional else float
    return Annotated[kind, read, Parameter(help=parameter.help)]


def __getattr__(name: str) -> Callable[..., int]:
    """Return the command of a mode by its name."""
    for mode in MODES:
        if mode.name() == name:
            return mode_command(mode)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
