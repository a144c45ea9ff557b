"""What a page may ask for: checked when decoded, told apart by `type`."""

from typing import Annotated

import msgspec
from msgspec import Meta

Metre = Annotated[float, Meta(ge=-1e4, le=1e4)]
"""A coordinate in the map [m]."""
Radian = Annotated[float, Meta(ge=-100.0, le=100.0)]
Side = Annotated[float, Meta(ge=0.1, le=20.0)]
"""Of a box [m]."""
Path = Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=1, max_length=20)]


class Request(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """Anything the page asks for."""


class Drive(Request, tag="drive"):
    """Hold this velocity [m/s, rad/s] until it expires; 0, 0 lets go."""

    v: float
    w: float


class Stop(Request, tag="stop"):
    """Stand still, whoever drives."""


class EmergencyStop(Request, tag="emergency_stop"):
    """Stop hard, latched."""


class ResetEmergencyStop(Request, tag="reset_emergency_stop"):
    """Release the latch."""


class SwitchMotors(Request, tag="motors"):
    """Switch the motors' power."""

    on: bool


class Ping(Request, tag="ping"):
    """Asks for a pong with the same `t`."""

    t: float


class AddBox(Request, tag="add_box"):
    """Put a box into the simulated world; x, y is its middle."""

    x: Metre
    y: Metre
    theta: Radian
    length: Side
    width: Side


class AddPerson(Request, tag="add_person"):
    """Let somebody stand at a point, or walk to and fro along several."""

    path: Path


class AddRobot(Request, tag="add_robot"):
    """Put one more robot, of a shipped model, into the simulated world."""

    model: str
    x: Metre
    y: Metre
    theta: Radian


class Move(Request, tag="move"):
    """Put a thing somewhere else."""

    id: int
    x: Metre
    y: Metre
    theta: Radian


class Remove(Request, tag="remove"):
    """Take a thing out of the simulated world."""

    id: int


class PressStopButton(Request, tag="stop_button"):
    """Press or release the red button on a simulated robot."""

    id: int
    pressed: bool


class PlugCable(Request, tag="cable"):
    """Pull the cable out of a simulated robot, or put it in again."""

    id: int
    plugged: bool


class Pause(Request, tag="pause"):
    """Stop simulated time, or let it pass again."""

    paused: bool


class Step(Request, tag="step"):
    """Let some simulated time pass [s], then stand still."""

    seconds: Annotated[float, Meta(ge=0.02, le=1.0)]


class SetSpeed(Request, tag="speed"):
    """Let simulated time pass so many times as fast as real time."""

    speed: Annotated[float, Meta(ge=0.25, le=10.0)]


Wish = Drive | Stop | EmergencyStop | ResetEmergencyStop | SwitchMotors | Ping
"""What concerns the robot alone, be it real or simulated."""
Edit = (
    AddBox
    | AddPerson
    | AddRobot
    | Move
    | Remove
    | PressStopButton
    | PlugCable
    | Pause
    | Step
    | SetSpeed
)
"""What concerns the simulated world."""
AnyRequest = Wish | Edit
_decoder: msgspec.json.Decoder[AnyRequest] = msgspec.json.Decoder(AnyRequest)


def decode(text: str) -> AnyRequest:
    """Return the request in `text`.

    Raises:
        msgspec.MsgspecError: it is none; the message says what is wrong with it.
    """
    return _decoder.decode(text)
