"""`pioneer3 move`, `turn` and `goto`: one motion, then the robot stands."""

from collections.abc import Coroutine
from math import radians
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.flags import Flag
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot

Signed = Annotated[float, Parameter(allow_leading_hyphen=True)]
Speed = Annotated[float, Parameter(validator=Number(gt=0))]


def move(
    metres: Signed,
    /,
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    speed: Speed = 0.3,
    json: Flag = False,
) -> int:
    """Drive straight ahead, or backwards, and stop.

    The robot MOVES, and looks out for nothing but its bumpers: see that the way is free.

    Example: pioneer3 move -0.5 --speed 0.2

    Args:
        metres: How far [m]; negative is backwards.
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        speed: At most [m/s].
        json: One JSON object for each reading, a line each.
    """
    return carry_out(lambda robot: robot.move(metres, speed), "drives", port, baud, json=json)


def turn(
    degrees: Signed,
    /,
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    rate: Speed = 45.0,
    json: Flag = False,
) -> int:
    """Turn on the spot and stop.

    The robot MOVES: see that its corners are free.

    Example: pioneer3 turn -90

    Args:
        degrees: How far [deg]; positive is to the left.
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        rate: At most [deg/s].
        json: One JSON object for each reading, a line each.
    """

    def turning(robot: "Robot") -> Coroutine[Any, Any, None]:
        return robot.turn(radians(degrees), radians(rate))

    return carry_out(turning, "turns", port, baud, json=json)


def goto(
    x: Signed,
    y: Signed,
    heading: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
    /,
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    speed: Speed = 0.4,
    json: Flag = False,
) -> int:
    """Drive to a place and stop; slow down and turn aside for what is in the way.

    The place counts from where the robot is and looks when the connection opens. It is found by
    the wheels, which drift. The robot MOVES: stand by its stop button.

    Example: pioneer3 goto 2 -0.5 90

    Args:
        x: Ahead of where it starts [m].
        y: To the left of where it starts [m].
        heading: To look in the end, as against the start [deg]; without it, as it arrives.
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        speed: At most [m/s].
        json: One JSON object for each reading, a line each.
    """

    def going(robot: "Robot") -> Coroutine[Any, Any, None]:
        theta = None if heading is None else radians(heading)
        return robot.goto(x, y, theta, speed=speed)

    return carry_out(going, "goes there", port, baud, json=json)
