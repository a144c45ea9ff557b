"""What is screwed onto one robot."""

from dataclasses import dataclass
from math import isfinite, pi
from typing import Literal

from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel

Camera = Literal["vcc4", "sony"]
TableWiring = Literal["old", "new"]
PORTS = (1, 2, 3)
GYRO_TYPES = (0, 1, 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Equipment:
    """The accessories of a robot; by default what every Pioneer 3 has and nothing else.

    Attributes:
        gripper: Two paddles on a lift, connected to the general inputs (type 2).
        compass: A TCM2.
        gyro_type: As in CONFIG: 0 none, 1 the host corrects the heading, 2 the controller does.
        joystick: One at the robot.
        table_ir: Table sensors, on the digital inputs ("old") or in the fourth byte of the
            IO report ("new"); `None` without.
        camera: Canon VC-C4 or Sony EVI-D30; `None` without.
        camera_port: The AUX port that the camera is connected to.
        north: Where magnetic north lies in the world, counter-clockwise from its x axis [rad].
        compass_noise: Standard deviation of the compass [rad].
        gyro_bias: What the gyro adds to every rate [rad/s].
        gyro_noise: Standard deviation of a sample of the gyro [rad/s].

    Raises:
        ConfigError: A value is none of those.
    """

    gripper: bool = False
    compass: bool = False
    gyro_type: int = 0
    joystick: bool = False
    table_ir: TableWiring | None = None
    camera: Camera | None = None
    camera_port: int = 1
    north: float = pi / 2
    compass_noise: float = 0.0
    gyro_bias: float = 0.0
    gyro_noise: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be built, naming the field."""
        _one_of("gyro_type", self.gyro_type, GYRO_TYPES)
        _one_of("camera_port", self.camera_port, PORTS)
        _one_of("camera", self.camera, (None, "vcc4", "sony"))
        _one_of("table_ir", self.table_ir, (None, "old", "new"))
        for field in ("north", "compass_noise", "gyro_bias", "gyro_noise"):
            if not isfinite(getattr(self, field)):
                raise ConfigError(f"{field}: {getattr(self, field)} is not finite")
        for field in ("compass_noise", "gyro_noise"):
            if getattr(self, field) < 0:
                raise ConfigError(f"{field}: {getattr(self, field)} is negative")

    @classmethod
    def of(cls, model: RobotModel) -> "Equipment":
        """Return what robots of this type come with: a PeopleBot senses tables."""
        return cls(table_ir="new" if model.table_irs else None)


def _one_of(field: str, value: object, choices: tuple[object, ...]) -> None:
    if value not in choices:
        raise ConfigError(f"{field}: {value!r} is none of {', '.join(map(str, choices))}")
