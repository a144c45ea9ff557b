"""The values that an argument may take where it picks one of a few things (arcos.md 3.2)."""

from enum import IntEnum

__all__ = [
    "Baud",
    "GripperAction",
    "GyroMode",
    "Request",
    "SafetySystem",
    "SimLaserMode",
    "SimOperation",
    "Tcm2Mode",
]


class Request(IntEnum):
    """How often a report is wanted."""

    STOP = 0
    ONCE = 1
    STREAM = 2


class Baud(IntEnum):
    """Baud codes of HOSTBAUD, AUX1BAUD, AUX2BAUD and CONFIG (arcos.md 1.1)."""

    B9600 = 0
    B19200 = 1
    B38400 = 2
    B57600 = 3
    B115200 = 4


class GyroMode(IntEnum):
    """What the heading is corrected with."""

    OFF = 0
    ON = 1
    ONLY = 2


class GripperAction(IntEnum):
    """What the gripper shall do."""

    OPEN = 1
    CLOSE = 2
    STOP = 3
    LIFT_UP = 4
    LIFT_DOWN = 5
    LIFT_STOP = 6
    STORE = 7
    DEPLOY = 8
    HALT = 15
    PRESSURE = 16
    LIFT_CARRY = 17


class Tcm2Mode(IntEnum):
    """What the compass module shall do."""

    OFF = 0
    SIP_ONLY = 1
    ONCE = 2
    STREAM = 3
    USER_CALIBRATION = 4
    AUTO_CALIBRATION = 5
    STOP_CALIBRATION = 6
    SOFT_RESET = 7


class SafetySystem(IntEnum):
    """What SAFETY_SET_STATE is about."""

    ESTOP = 0
    LASER = 1


class SimLaserMode(IntEnum):
    """Which packets the simulated laser sends."""

    OFF = 0
    RANGES = 1
    """Packets 0x60."""
    EXTENDED = 2
    """Packets 0x61, with reflectance."""


class SimOperation(IntEnum):
    """What SIM_CTRL shall do."""

    LOAD_MAP = 1
    LOAD_MASTER_MAP = 2
    CLEAR_MASTER_MAP = 3
    ROTATE_LOGS = 4
    LOG_STATE = 5
    REQUEST_INFO = 6
    GHOST = 7
    SNAPSHOT = 8
