"""The five-axis arm: joints 1..5 and the gripper as joint 6 (arcos.md 3.2)."""

from dataclasses import dataclass
from typing import ClassVar

from pioneer3.arcos.commands.quantities import High, How, Low, On, Seconds, Word

__all__ = [
    "ArmAutoPark",
    "ArmCheck",
    "ArmGripPark",
    "ArmHome",
    "ArmInit",
    "ArmPark",
    "ArmPos",
    "ArmPower",
    "ArmSpeed",
    "ArmStop",
    "RequestArmInfo",
    "RequestArmStatus",
]


@dataclass(frozen=True, slots=True)
class RequestArmInfo:
    """Ask once what the arm is (ARCOS 70, ARM_INFO)."""

    ID: ClassVar[int] = 70


@dataclass(frozen=True, slots=True)
class RequestArmStatus:
    """Ask for the state of the arm (ARCOS 71, ARM_STATUS)."""

    ID: ClassVar[int] = 71
    how: How


@dataclass(frozen=True, slots=True)
class ArmInit:
    """Initialise the arm (ARCOS 72, ARM_INIT)."""

    ID: ClassVar[int] = 72


@dataclass(frozen=True, slots=True)
class ArmCheck:
    """Check whether the arm is connected (ARCOS 73, ARM_CHECK)."""

    ID: ClassVar[int] = 73


@dataclass(frozen=True, slots=True)
class ArmPower:
    """Switch the power of the servos (ARCOS 74, ARM_POWER)."""

    ID: ClassVar[int] = 74
    on: On


@dataclass(frozen=True, slots=True)
class ArmHome:
    """Move a `joint`, or all of them with 7, to its home (ARCOS 75, ARM_HOME)."""

    ID: ClassVar[int] = 75
    joint: Word


@dataclass(frozen=True, slots=True)
class ArmPark:
    """Move all joints home, then switch them off (ARCOS 76, ARM_PARK)."""

    ID: ClassVar[int] = 76


@dataclass(frozen=True, slots=True)
class ArmPos:
    """Move a `joint` to a servo position [raw] (ARCOS 77, ARM_POS)."""

    ID: ClassVar[int] = 77
    joint: High
    position_raw: Low


@dataclass(frozen=True, slots=True)
class ArmSpeed:
    """Set how long a `joint` takes for one servo step [ms] (ARCOS 78, ARM_SPEED)."""

    ID: ClassVar[int] = 78
    joint: High
    step_ms: Low


@dataclass(frozen=True, slots=True)
class ArmStop:
    """Stop a `joint`, or all of them with 7 (ARCOS 79, ARM_STOP)."""

    ID: ClassVar[int] = 79
    joint: Word


@dataclass(frozen=True, slots=True)
class ArmAutoPark:
    """Park after `idle` [s] without commands (ARCOS 80, ARM_AUTOPARK)."""

    ID: ClassVar[int] = 80
    idle: Seconds


@dataclass(frozen=True, slots=True)
class ArmGripPark:
    """Relax the gripper after `idle` [s] (ARCOS 81, ARM_GRIPPARK)."""

    ID: ClassVar[int] = 81
    idle: Seconds
