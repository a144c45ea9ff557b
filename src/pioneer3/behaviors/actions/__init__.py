"""Stock actions: one small class each, parameters as fields."""

from pioneer3.behaviors.actions.aria import AvoidSide, Input, Stop, TurnAway
from pioneer3.behaviors.actions.avoid import AvoidFront, Bumpers
from pioneer3.behaviors.actions.explore import Explore
from pioneer3.behaviors.actions.follow import Blob, BlobSource, ColorFollow
from pioneer3.behaviors.actions.group import (
    FollowLeader,
    KeepFormation,
    SpreadOut,
)
from pioneer3.behaviors.actions.hold import Hold
from pioneer3.behaviors.actions.keep_apart import LimiterPeers
from pioneer3.behaviors.actions.limiters import (
    DeceleratingLimiter,
    LimiterBackwards,
    LimiterForwards,
    LimiterSweep,
    LimiterTableSensor,
)
from pioneer3.behaviors.actions.motion import ConstantVelocity, Goto, Move, Turn
from pioneer3.behaviors.actions.ratio_input import RatioInput
from pioneer3.behaviors.actions.recover import StallRecover, Unstick

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
    "FollowLeader",
    "Goto",
    "Hold",
    "Input",
    "KeepFormation",
    "LimiterBackwards",
    "LimiterForwards",
    "LimiterPeers",
    "LimiterSweep",
    "LimiterTableSensor",
    "Move",
    "RatioInput",
    "SpreadOut",
    "StallRecover",
    "Stop",
    "Turn",
    "TurnAway",
    "Unstick",
]
