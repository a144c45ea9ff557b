"""`pioneer3 follow`."""

from math import inf
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.flags import Flag
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

Positive = Annotated[float | None, Parameter(validator=Number(gt=0))]


def follow(
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    rule: Literal["tracking", "lab"] = "tracking",
    keep: Positive = None,
    seconds: Positive = None,
    json: Flag = False,
    record: Path | None = None,
) -> int:
    """Follow the person in front with the front sonars; Ctrl-C stops the robot.

    The robot MOVES, and backs up from who comes nearer. Stand 0.6 m in front of it, then walk, not
    faster than 0.4 m/s.

    Example: pioneer3 follow --port /dev/ttyUSB0

    Args:
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        rule: tracking: remembers who it follows; lab: goes to the nearest echo, as the lab's node.
        keep: Distance to keep [m]; 0.3 unless given.
        seconds: Stop after this time [s].
        json: One JSON object for each reading, a line each.
        record: New file for every byte on the wire and every decision.
    """
    from pioneer3.behaviors.follow import follow as following  # noqa: PLC0415

    mode = following(rule, keep=keep)
    length = inf if seconds is None else seconds
    return carry_out(
        lambda robot: robot.run(mode, length), "follows", port, baud, json=json, record=record
    )
