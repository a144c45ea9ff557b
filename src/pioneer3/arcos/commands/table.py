"""Commands that this package neither sends nor acts on: one line each, by number (protocol.md 3).

A line has the number, the name in manuals, the arguments with their kinds, the meaning, and the
source if it is not ARIA's list of commands. 94, 116, 119, 255 and 66 to 69 have no name there;
theirs are our own.
"""

from collections.abc import Mapping
from typing import Final, NamedTuple

from pioneer3.arcos.commands.arguments import (
    BaudCode,
    High,
    Low,
    LowOn,
    Message,
    On,
    RequestModeCode,
    Seconds,
    SignedDegrees,
    SignedMillis,
    Word,
)
from pioneer3.arcos.wire import Rest

CODA: Final = "AriaCoda"
SRISIM: Final = "SRISim"


class CommandRow(NamedTuple):
    """One command; `source` is the program that names it.

    `arguments` are annotations by name, in wire order; `meaning` is a sentence without full stop.
    """

    number: int
    name: str
    arguments: Mapping[str, object]
    meaning: str
    source: str = "ARIA"


NONE: Final[Mapping[str, object]] = {}
UNKNOWN: Final[Mapping[str, object]] = {"arguments": Rest}
HOW: Final[Mapping[str, object]] = {"how": RequestModeCode}
ON: Final[Mapping[str, object]] = {"on": On}
GAIN: Final[Mapping[str, object]] = {"gain": Word}
BAUD: Final[Mapping[str, object]] = {"baud": BaudCode}
JOINT: Final[Mapping[str, object]] = {"joint": Word}
IDLE: Final[Mapping[str, object]] = {"idle": Seconds}

DRIVING: Final = (
    CommandRow(
        20, "SETRVDIR", {"rate": SignedDegrees}, "Limit turns to the left, or (negative) right"
    ),
    CommandRow(22, "DCHEAD", {"heading": SignedDegrees}, "Set Colbert's heading set-point [rad]"),
    CommandRow(50, "HOSTBAUD", BAUD, "Change the speed of the host's serial line"),
    CommandRow(51, "AUX1BAUD", BAUD, "Change the speed of serial port AUX1"),
    CommandRow(52, "AUX2BAUD", BAUD, "Change the speed of serial port AUX2"),
    CommandRow(56, "ESTALL", UNKNOWN, "Undocumented"),
    CommandRow(82, "ROTKP", GAIN, "Set the proportional gain of the rotation controller"),
    CommandRow(83, "ROTKV", GAIN, "Set the velocity gain of the rotation controller"),
    CommandRow(84, "ROTKI", GAIN, "Set the integral gain of the rotation controller"),
    CommandRow(85, "TRANSKP", GAIN, "Set the proportional gain of the translation controller"),
    CommandRow(86, "TRANSKV", GAIN, "Set the velocity gain of the translation controller"),
    CommandRow(87, "TRANSKI", GAIN, "Set the integral gain of the translation controller"),
    CommandRow(
        110, "LATVEL", {"speed": SignedMillis}, "Drive sideways [m/s], left positive; Seekur"
    ),
    CommandRow(
        113, "LATACCEL", {"acceleration": SignedMillis}, "Set the lateral acceleration; Seekur"
    ),
    CommandRow(119, "SEEKUR_119", UNKNOWN, "Undocumented; Seekur"),
    CommandRow(120, "RECENTERWHEELS", NONE, "Straighten the wheels; Seekur", CODA),
    CommandRow(
        150, "ROTVEL_CLOSEDLOOP_ENABLE", ON, "Control the turn rate in closed loop; MTX", CODA
    ),
    CommandRow(213, "ABSOLUTE_MAXES", UNKNOWN, "Set the absolute maxima; MTX"),
)
"""Sessions, motion and set-up."""

DEVICES: Final = (
    CommandRow(26, "IMUREQUEST", HOW, "Ask for the inertial sensor; Seekur", CODA),
    CommandRow(41, "PTUPOS", {"port": High, "pulse_width_raw": Low}, "Set a pan-tilt servo"),
    CommandRow(47, "JOYDRIVE", ON, "Let the joystick at the robot drive it"),
    CommandRow(49, "MOVINGBLINK", ON, "Blink a lamp before moving; PatrolBot"),
    CommandRow(65, "CALCOMP", {"step": Word}, "Calibrate the compass; the steps are undocumented"),
    CommandRow(70, "ARM_INFO", NONE, "Ask once for the arm's description"),
    CommandRow(71, "ARM_STATUS", HOW, "Ask for the arm's state"),
    CommandRow(72, "ARM_INIT", NONE, "Initialise the arm"),
    CommandRow(73, "ARM_CHECK", NONE, "Check whether the arm is connected"),
    CommandRow(74, "ARM_POWER", ON, "Switch the power of the servos"),
    CommandRow(75, "ARM_HOME", JOINT, "Move a joint 1 to 6, or all with 7, to its home"),
    CommandRow(76, "ARM_PARK", NONE, "Move all joints home, then switch them off"),
    CommandRow(
        77, "ARM_POS", {"joint": High, "position_raw": Low}, "Move a joint to a servo position"
    ),
    CommandRow(78, "ARM_SPEED", {"joint": High, "step_ms": Low}, "Set the time of one servo step"),
    CommandRow(79, "ARM_STOP", JOINT, "Stop a joint, or all with 7"),
    CommandRow(80, "ARM_AUTOPARK", IDLE, "Park after so long without commands [s]"),
    CommandRow(81, "ARM_GRIPPARK", IDLE, "Relax the gripper after so long [s]"),
    CommandRow(90, "SOUND", {"number": Word}, "Play a sound; AmigoBot"),
    CommandRow(
        91, "PLAYLIST", {"number": Word}, "Ask for the name of a sound, 0 for all; AmigoBot"
    ),
    CommandRow(92, "SOUNDTOG", ON, "Switch sounds; AmigoBot"),
    CommandRow(94, "LASER_LOG_TEXT", {"text": Message}, "Put a text into the laser log"),
    CommandRow(95, "POWER_PC", ON, "Switch the computer"),
    CommandRow(96, "POWER_LRF", ON, "Switch the laser range finder"),
    CommandRow(97, "POWER_5V", ON, "Switch the 5 V supply"),
    CommandRow(98, "POWER_12V", ON, "Switch the 12 V supply, on some robots 24 V"),
    CommandRow(
        116, "SEEKUR_POWER_PORT", {"port": High, "on": LowOn}, "Switch a power port; Seekur"
    ),
    CommandRow(123, "ACCELINFO", HOW, "Ask for accelerations; Seekur, MTX", CODA),
    CommandRow(124, "TORQUEINFO", HOW, "Ask for torques; Seekur, MTX", CODA),
    CommandRow(125, "POWER_AUX_PC", ON, "Switch the second computer"),
    CommandRow(126, "POWER_TOUCHSCREEN", ON, "Switch the touch screen"),
    CommandRow(127, "POWER_PTZ", ON, "Switch the camera"),
    CommandRow(128, "POWER_AUDIO", ON, "Switch the loudspeakers"),
    CommandRow(129, "POWER_LRF2", ON, "Switch the second laser range finder"),
    CommandRow(149, "HEADINGINFO", HOW, "Ask for headings; Seekur, MTX", CODA),
    CommandRow(210, "SRECORD", {"byte": Word}, "Download one byte of firmware"),
    CommandRow(211, "MARCDEBUG", {"text": Message}, "Send a text to the firmware for debugging"),
    CommandRow(212, "WHEEL_LIGHT", UNKNOWN, "Set the wheel lamps; MTX"),
    CommandRow(
        215, "SAFETY_SET_STATE", {"system": High, "state": Low}, "System 0 stop, 1 laser; MTX"
    ),
    CommandRow(216, "SAFETY_DISABLE_POWER_OFF_TIMER", UNKNOWN, "Keep the power on; MTX"),
    CommandRow(217, "SAFETY_ZONE_ACTIVE", UNKNOWN, "Choose a safety zone; MTX", CODA),
    CommandRow(218, "WHEELINFO_REQUEST", UNKNOWN, "Ask for wheel states; MTX", CODA),
    CommandRow(219, "MARC_CONFIG_SET", UNKNOWN, "Set firmware parameters; MTX", CODA),
    CommandRow(220, "MARC_CONFIG_GET", UNKNOWN, "Read firmware parameters; MTX", CODA),
    CommandRow(253, "POWERONLIKE_RESET", NONE, "Restart the firmware", CODA),
    CommandRow(255, "MAINTENANCE", NONE, "Restart the firmware for maintenance"),
)
"""Sensors, accessories, power and service."""

OLD_SIMULATOR: Final = (
    CommandRow(61, "LOADPARAM", {"name": Message}, "Load a parameter file", SRISIM),
    CommandRow(62, "END_SIM", NONE, "End the simulator", SRISIM),
    CommandRow(63, "LOADWORLD", {"name": Message}, "Load a world file", SRISIM),
    CommandRow(64, "STEP", UNKNOWN, "Simulate one step", SRISIM),
    CommandRow(66, "SET_TRUE_X", {"x": SignedMillis}, "Set the true x [m]", SRISIM),
    CommandRow(67, "SET_TRUE_Y", {"y": SignedMillis}, "Set the true y [m]", SRISIM),
    CommandRow(68, "SET_TRUE_TH", {"heading": SignedDegrees}, "Set the true heading [rad]", SRISIM),
    CommandRow(69, "RESET", UNKNOWN, "Put the robot back to the origin", SRISIM),
)
"""Old simulators; to robots these numbers mean something else."""
