"""What a page may ask for: checked when decoded, told apart by `type`."""

from typing import Annotated

import msgspec
from msgspec import Meta

from pioneer3.web.hands import Input
from pioneer3.web.modes import Mode

Metre = Annotated[float, Meta(ge=-1e4, le=1e4)]
"""A coordinate in the map [m]."""
Radian = Annotated[float, Meta(ge=-100.0, le=100.0)]
Side = Annotated[float, Meta(ge=0.1, le=20.0)]
"""Of a box [m]."""
Speed = Annotated[float, Meta(gt=0.0, le=5.0)]
"""At most so fast [m/s]."""
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Path = Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=1, max_length=20)]


class Request(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """Anything the page asks for."""


class RobotRequest(Request, kw_only=True):
    """Anything asked of a robot: its number on the page; without one the first is meant."""

    robot: int | None = None


class Drive(RobotRequest, tag="drive"):
    """Hold this velocity [m/s, rad/s] with `input` until it expires; 0, 0 lets go."""

    v: float
    w: float
    input: Input = "touch"


class Stop(RobotRequest, tag="stop"):
    """Stand still, whoever drives."""


class EmergencyStop(RobotRequest, tag="emergency_stop"):
    """Stop hard, latched; without a number all robots do: nobody has to pick first."""


class ResetEmergencyStop(RobotRequest, tag="reset_emergency_stop"):
    """Release the latch."""


class SwitchMotors(RobotRequest, tag="motors"):
    """Switch the motors' power."""

    on: bool


class TakeWheel(RobotRequest, tag="take_wheel"):
    """Take the wheel if it is free, and keep it."""


class TakeOver(RobotRequest, tag="take_over"):
    """Stop the robot, then have the wheel, whoever has it now."""


class HandOver(RobotRequest, tag="hand_over"):
    """Stop the robot, and give the wheel to another guest."""

    to: int


class GiveUpWheel(RobotRequest, tag="give_up_wheel"):
    """Leave the wheel to whoever wants it."""


class StartMode(RobotRequest, tag="start_mode"):
    """Stop, then let the robot drive by itself for who asks; `goto` in odometry's frame."""

    mode: Mode


class Goto(RobotRequest, tag="goto"):
    """Drive straight to a place of the map, and turn to a heading there if one is given."""

    x: Metre
    y: Metre
    heading: Radian | None = None
    speed: Speed = 0.3


class EndMode(RobotRequest, tag="end_mode"):
    """End what the robot does by itself; its motion ends at once."""


class WatchDetails(RobotRequest, tag="watch_details"):
    """Open the details of the robot in place of any other's, or close them."""

    on: bool


class AskConfig(RobotRequest, tag="ask_config"):
    """Ask the robot for its CONFIG."""


class WatchLasers(Request, tag="watch_lasers"):
    """Asks to be told what lasers see, or not any more; they are on while anybody wants it."""

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


class SetCharge(Request, tag="charge"):
    """Drain or fill the battery of a simulated robot, to this share of its capacity."""

    id: int
    charge: Share


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
"""What concerns robots alone, be they real or simulated."""
WheelRequest = TakeWheel | TakeOver | HandOver | GiveUpWheel
"""What concerns who drives."""
ModeRequest = StartMode | Goto | EndMode
"""What concerns driving by itself."""
Look = WatchDetails | AskConfig | WatchLasers
"""What concerns this page alone."""
FOR_ALL = (Stop, EmergencyStop, Ping, WatchDetails, AskConfig, WatchLasers)
"""What everybody may ask who sees the page; the rest is for drivers."""
Edit = (
    AddBox
    | AddPerson
    | AddRobot
    | Move
    | Remove
    | PressStopButton
    | PlugCable
    | SetCharge
    | Pause
    | Step
    | SetSpeed
)
"""What concerns the simulated world."""
AnyRequest = Wish | WheelRequest | ModeRequest | Look | Edit
TOO_DEEP = "nested too deeply"
_decoder: msgspec.json.Decoder[AnyRequest] = msgspec.json.Decoder(AnyRequest)


def decode(text: str) -> AnyRequest:
    """Return the request in `text`.

    Raises:
        msgspec.MsgspecError: it is none; the message says what is wrong with it.
    """
    try:
        return _decoder.decode(text)
    except RecursionError:
        raise msgspec.ValidationError(TOO_DEEP) from None
