"""Stock actions: one small class each, parameters as fields."""

from pioneer3.behaviors.actions.avoid_front import AvoidFront
from pioneer3.behaviors.actions.avoid_side import AvoidSide
from pioneer3.behaviors.actions.bumpers import Bumpers
from pioneer3.behaviors.actions.color_follow import Blob, BlobSource, ColorFollow
from pioneer3.behaviors.actions.constant_velocity import ConstantVelocity
from pioneer3.behaviors.actions.decelerating_limiter import DeceleratingLimiter
from pioneer3.behaviors.actions.explore import Explore
from pioneer3.behaviors.actions.goto import Goto
from pioneer3.behaviors.actions.hold import Hold
from pioneer3.behaviors.actions.joy_drive import JoyDrive, Stick
from pioneer3.behaviors.actions.key_drive import KeyDrive
from pioneer3.behaviors.actions.limiter_sweep import LimiterSweep
from pioneer3.behaviors.actions.limiters import (
    LimiterBackwards,
    LimiterForwards,
    LimiterTableSensor,
)
from pioneer3.behaviors.actions.move import Move
from pioneer3.behaviors.actions.program_input import Input
from pioneer3.behaviors.actions.ratio_input import RatioInput
from pioneer3.behaviors.actions.stall_recover import StallRecover
from pioneer3.behaviors.actions.stop import Stop
from pioneer3.behaviors.actions.turn import Turn
from pioneer3.behaviors.actions.turn_away import TurnAway
from pioneer3.behaviors.actions.unstick import Unstick

__all__ = [
    "AvoidFront",
    "AvoidSide",
    "Blob",
    "BlobSource",
    "Bumpers",
    "ColorFollow",
    "ConstantVelocity",
    "DeceleratingLimiter",
    "Explore",
    "Goto",
    "Hold",
    "Input",
    "JoyDrive",
    "KeyDrive",
    "LimiterBackwards",
    "LimiterForwards",
    "LimiterSweep",
    "LimiterTableSensor",
    "Move",
    "RatioInput",
    "StallRecover",
    "Stick",
    "Stop",
    "Turn",
    "TurnAway",
    "Unstick",
]
