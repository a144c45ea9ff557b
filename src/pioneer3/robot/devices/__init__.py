"""The devices of a robot besides wheels and sonars, each used in SI units.

===========  ========================================================================
module       contents
===========  ========================================================================
sensor       the base of all sensors: readings on demand
gripper      paddles, lift, beams
lines        digital and analog inputs and outputs
compass      TCM2
gyro         heading from samples, where the robot sends them
laser        scans of a simulator's laser, and the interface of every laser
camera       pan, tilt and zoom; canon and sony encode the bytes, aux_port sends them
pictures     the pictures of a camera, and its pan, tilt and zoom in one place
status       flags and faults by name, safety systems, CONFIG on demand
acts         blobs of colour, from the ACTS server
presence     whether the robot has a device, and the evidence
aux_port     a serial port of the robot's controller
camera_kind  makes of cameras: the interface of all, Sony's EVI-D30 and Canon's VC-C4
===========  ========================================================================

Devices never move the wheels: motion belongs to the arbiter.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

from pioneer3.arcos.commands import Command, from_payload
from pioneer3.arcos.commands.arguments import put_argument
from pioneer3.arcos.reports import Config
from pioneer3.errors import CommandError
from pioneer3.robot.devices.acts import Acts
from pioneer3.robot.devices.camera import Camera, CameraName
from pioneer3.robot.devices.compass import TcmCompass
from pioneer3.robot.devices.gripper import Gripper
from pioneer3.robot.devices.gyro import Gyro
from pioneer3.robot.devices.laser import Laser
from pioneer3.robot.devices.lines import Lines
from pioneer3.robot.devices.pictures import Image, PictureSource, RobotCamera
from pioneer3.robot.devices.presence import Presence, bumpers_of, sonars_of
from pioneer3.robot.devices.sensor import Sensor
from pioneer3.robot.devices.status import DetailedStatus, Safety, ask_configuration, detailed_status
from pioneer3.robot.supervisor import RobotInfo, Supervisor

GREATEST = 32767
BYTES = range(-128, 256)
HOW = "type a command's number, and nothing, one number or two bytes after it"


def parse_typed(line: str) -> Command:
    """Return the command in `line`, such as `4 1`, `11 -200` or `32 10 -10`.

    One number is a command without argument, two are one with an integer (-32767 to 32767), three
    are one with two bytes (-128 to 255 each).

    Raises:
        CommandError: it is no command; the message has the reason and the form to type.
    """
    words = line.split()
    if not words:
        raise CommandError(HOW)
    numbers = [_number(word) for word in words]
    if not 0 <= numbers[0] <= 255:
        raise CommandError(f"command {numbers[0]}: there are 0 to 255")
    payload = bytearray([numbers[0]])
    match numbers[1:]:
        case []:
            pass
        case [argument]:
            if abs(argument) > GREATEST:
                raise CommandError(f"argument {argument}: it must be -{GREATEST} to {GREATEST}")
            put_argument(argument, payload)
        case [high, low]:
            for byte in (high, low):
                if byte not in BYTES:
                    raise CommandError(f"byte {byte}: it must be -128 to 255")
            word = (high & 0xFF) << 8 | low & 0xFF
            # two bytes are sent as one signed 16-bit number (protocol.md 1.3)
            put_argument(word - 0x10000 if word & 0x8000 else word, payload)
        case _:
            raise CommandError(f"{len(words)} numbers are too many: {HOW}")
    return from_payload(bytes(payload))


def _number(word: str) -> int:
    digits = word.removeprefix("-")
    if not (digits.isascii() and digits.isdecimal() and len(digits) <= 9):
        raise CommandError(f"{word!r} is not a whole number: {HOW}")
    return int(word)


__all__ = [
    "Acts",
    "Camera",
    "CameraName",
    "DetailedStatus",
    "Devices",
    "Gripper",
    "Gyro",
    "Image",
    "Laser",
    "Lines",
    "PictureSource",
    "Presence",
    "RobotCamera",
    "Safety",
    "TcmCompass",
    "detailed_status",
    "parse_typed",
]


class Devices:
    """The devices of one robot, each made at its first use."""

    def __init__(self, supervisor: Supervisor, pictures: PictureSource | None = None) -> None:
        self._supervisor = supervisor
        self._pictures = pictures

    @cached_property
    def gripper(self) -> Gripper:
        """Paddles, lift and beams."""
        return Gripper(self._supervisor)

    @cached_property
    def lines(self) -> Lines:
        """Digital and analog inputs and outputs."""
        return Lines(self._supervisor)

    @cached_property
    def compass(self) -> TcmCompass:
        """The TCM2."""
        return TcmCompass(self._supervisor)

    @cached_property
    def gyro(self) -> Gyro:
        """The gyro, where the host corrects the heading."""
        return Gyro(self._supervisor)

    @cached_property
    def camera(self) -> RobotCamera:
        """The camera's pictures; `camera.ptz("vcc4")` turns and zooms it."""
        return RobotCamera(self._supervisor, self._pictures)

    @cached_property
    def laser(self) -> Laser:
        """The laser of a simulator."""
        return Laser(self._supervisor)

    @cached_property
    def safety(self) -> Safety:
        """The safety systems of MTX robots; texts of the firmware."""
        return Safety(self._supervisor)

    @property
    def sensors(self) -> tuple[Sensor[Any], ...]:
        """The sensors with readings to show, in this order."""
        return self.compass, self.gyro, self.gripper

    @property
    def bumpers(self) -> Presence:
        """Whether there are bumpers; their contacts are in the snapshots."""
        return self._built_in(bumpers_of)

    @property
    def sonars(self) -> Presence:
        """Whether there are sonars; their ranges are in the snapshots."""
        return self._built_in(sonars_of)

    async def configuration(self) -> Config:
        """Ask for CONFIG again and return it; `info.config` is this one from then on.

        Raises:
            DeviceError: the robot does not answer.
            CommandError: no robot is connected.
        """
        return await ask_configuration(self._supervisor)

    def _built_in(self, presence_of: Callable[[RobotInfo], Presence]) -> Presence:
        info = self._supervisor.info
        return presence_of(info) if info else Presence(None, "No robot has been connected yet.")
