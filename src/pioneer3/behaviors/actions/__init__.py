"""Stock actions: one small class each, parameters as fields.

===========  ======================================================================================
module       contents
===========  ======================================================================================
recover      actions that get a robot free
explore      goes where there is room, and rather where it has not been
motion       actions that drive: on, a distance, an angle, to a place
keep_apart   the limiter that keeps robots apart which know each other's places
limiters     actions that limit the speed by the room there is
group        actions of robots in a group: formations, the track of a leader, apart from each other
follow       actions that follow: a person by sonar or laser, a colour by camera
avoid        actions that turn away from obstacles, and from contacts of bumpers
ratio_input  drives by shares of full speed: keys, sticks, programs
hold         holds a velocity that a key, a stick, a finger or a program has set
aria         actions of ARIA that no mode here uses: for programs that are moved from ARIA
sensing      table sensors, and words for obstacles, as several actions use them
===========  ======================================================================================
"""

from pioneer3.behaviors.actions.aria import AvoidSide, Input, Stop, TurnAway
from pioneer3.behaviors.actions.avoid import AvoidFront, Bumpers
from pioneer3.behaviors.actions.explore import Explore
from pioneer3.behaviors.actions.follow import BlobSource, ColorFollow, ColorPatch
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
    "BlobSource",
    "Bumpers",
    "ColorFollow",
    "ColorPatch",
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
