"""The bit fields of reports (arcos.md 4.4 to 4.7, 5.13). Bits without a name are kept."""

from enum import IntFlag

__all__ = ["Fault", "GripperSwitch", "SimFlag", "SipFlag", "SipFlag3"]


class SipFlag(IntFlag):
    """The robot's own state (arcos.md 4.4)."""

    MOTORS_ENABLED = 1 << 0
    SONAR_1 = 1 << 1
    SONAR_2 = 1 << 2
    SONAR_3 = 1 << 3
    SONAR_4 = 1 << 4
    STOP_BUTTON = 1 << 5
    LEGACY_IR_1 = 1 << 7
    LEGACY_IR_2 = 1 << 8
    JOYSTICK_BUTTON = 1 << 9
    CHARGER_POWER_GOOD = 1 << 10
    HIGH_TEMPERATURE = 1 << 11


class Fault(IntFlag):
    """What is wrong (arcos.md 4.5)."""

    PDB_LASER_STATUS_ERROR = 1 << 0
    HIGH_TEMPERATURE = 1 << 1
    PDB_ERROR = 1 << 2
    UNDERVOLTAGE = 1 << 3
    GYRO_FAULT = 1 << 4
    BATTERY_OVERTEMPERATURE = 1 << 5
    BATTERY_BALANCE_REQUIRED = 1 << 6
    ENCODER_DEGRADATION = 1 << 7
    ENCODER_FAILURE = 1 << 8
    CRITICAL_GENERAL_DRIVING_FAULT = 1 << 9
    ESTOP_MISMATCH_WARNING = 1 << 10
    ESTOP_SAFETY_FAULT = 1 << 11
    ZONE_SAFETY_FAULT = 1 << 12
    UNKNOWN_SAFETY_FAULT = 1 << 13
    BACKED_UP_TOO_FAST = 1 << 14
    JOYDRIVE_UNSAFE = 1 << 15


class SipFlag3(IntFlag):
    """More state of MTX robots (arcos.md 4.6)."""

    JOYSTICK_OVERRIDE = 1 << 0
    AMPLIFIER_COMMUNICATION_ERROR = 1 << 1
    SILENT_ESTOP = 1 << 2
    LASER_SAFETY_CIRCUIT_ERROR = 1 << 3
    ROTATION_LOOP_ENABLED = 1 << 4
    ROTATION_INTEGRATOR_SATURATED = 1 << 5


class GripperSwitch(IntFlag):
    """The gripper as ARIA reads it; LOW marks those that mean something when they are 0."""

    OPEN_LOW = 1 << 0
    LIFT_LIMIT_LOW = 1 << 1
    OUTER_BEAM_BROKEN = 1 << 2
    INNER_BEAM_BROKEN = 1 << 3
    LEFT_PADDLE_LOW = 1 << 4
    RIGHT_PADDLE_LOW = 1 << 5
    LIFT_MOVING = 1 << 6
    GRIP_MOVING = 1 << 7


class SimFlag(IntFlag):
    """What a SIMSTAT report tells about the simulation (arcos.md 5.13)."""

    HAS_MAP = 1 << 0
    HAS_GEO_REFERENCE = 1 << 1
    HAS_ODOMETRY_ERROR = 1 << 2
