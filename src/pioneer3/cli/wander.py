"""`pioneer3 wander`."""

from math import inf
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.flags import Flag
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

Positive = Annotated[float | None, Parameter(validator=Number(gt=0))]


def wander(
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    preset: Literal["lab", "aria", "explore"] = "lab",
    speed: Positive = None,
    seconds: Positive = None,
    json: Flag = False,
    record: Path | None = None,
) -> int:
    """Drive about and keep clear of what is in the way; Ctrl-C stops the robot.

    The robot MOVES: stand by its stop button.

    Example: pioneer3 wander --port /dev/ttyUSB0 --speed 0.2 --seconds 60

    Args:
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        preset: lab: slow, as its robotWander; aria: as ARIA's; explore: seeks new ground.
        speed: Where nothing is near [m/s]; 0.15 of lab, 0.4 of aria, 0.3 of explore.
        seconds: Stop after this time [s].
        json: One JSON object for each reading, a line each.
        record: New file for every byte on the wire and every decision.
    """
    from pioneer3.behaviors.modes import wander as wandering  # noqa: PLC0415

    mode = wandering(preset=preset, speed=speed)
    length = inf if seconds is None else seconds
    return carry_out(
        lambda robot: robot.run(mode, length), "wanders", port, baud, json=json, record=record
    )
