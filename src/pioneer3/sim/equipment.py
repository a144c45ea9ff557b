"""The accessories of a robot: those it has, and the choices of people about them."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import isfinite, pi, radians, tau
from types import MappingProxyType
from typing import Annotated, Any, Literal

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel
from pioneer3.models.lasers import LASERS, load_laser
from pioneer3.models.model import BUMPERS
from pioneer3.tables import FieldForm, in_degrees

Camera = Literal["vcc4", "sony"]
TableWiring = Literal["old", "new"]
PORTS = (1, 2, 3)
LAST_PORT = 65535
PICTURE_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "picture_width": (16, 1280),
        "picture_height": (16, 960),
        "picture_rate": (0.2, 30.0),
    }
)
"""Least and most of numbers of pictures."""
_DRIFT = radians(100)
"""Largest error of a gyro in a file [rad/s]."""
_Port = Annotated[int, Meta(ge=1, le=LAST_PORT)]


def _range(name: str) -> Meta:
    low, high = PICTURE_RANGES[name]
    return Meta(ge=low, le=high)


@dataclass(frozen=True, slots=True, kw_only=True)
class Equipment:
    """The accessories of a robot; by default those that every Pioneer 3 has.

    Attributes:
        gripper: Two paddles on a lift, connected to the general inputs (type 2).
        compass: A TCM2.
        gyro_type: As in CONFIG: 0 none, 1 the host corrects the heading, 2 the controller does.
        table_ir: Table sensors, on the digital inputs ("old") or in the fourth byte of the
            IO report ("new"); `None` without.
        camera: Canon VC-C4 or Sony EVI-D30; `None` without.
        camera_port: The AUX port that the camera is connected to.
        picture_port: TCP port of the camera's pictures, which worlds with physics have; `None` for
            the usual one, or the next that is free.
        picture_rate: Pictures a second of simulated time [Hz].
        laser: Name of a laser range finder with a port of its own; `None` without.
        laser_port: TCP port of that; `None` for the usual one, or the next that is free.
        north: Where magnetic north lies in the world, counter-clockwise from its x axis [rad].
        compass_noise: Standard deviation of the compass [rad].
        gyro_bias: Added to every rate of the gyro [rad/s].
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
    picture_port: int | None = None
    picture_width: int = 320
    picture_height: int = 240
    picture_rate: float = 10.0
    laser: str | None = None
    laser_port: int | None = None
    north: float = pi / 2
    compass_noise: float = 0.0
    gyro_bias: float = 0.0
    gyro_noise: float = 0.0

    def __post_init__(self) -> None:
        """Refuse impossible values, by the name of the field."""
        _one_of("gyro_type", self.gyro_type, (0, 1, 2))
        _one_of("camera_port", self.camera_port, PORTS)
        _one_of("camera", self.camera, (None, "vcc4", "sony"))
        _one_of("table_ir", self.table_ir, (None, "old", "new"))
        if self.laser is not None:
            load_laser(self.laser)
        for field in ("laser_port", "picture_port"):
            port = getattr(self, field)
            if port is not None and not 0 <= port <= LAST_PORT:
                raise ConfigError(f"{field}: {port} is not a port, 1 to {LAST_PORT}")
        for field, (low, high) in PICTURE_RANGES.items():
            if not low <= getattr(self, field) <= high:
                raise ConfigError(f"{field}: {getattr(self, field)} is not {low:g} to {high:g}")
        for field in ("north", "compass_noise", "gyro_bias", "gyro_noise"):
            if not isfinite(getattr(self, field)):
                raise ConfigError(f"{field}: {getattr(self, field)} is not finite")
        for field in ("compass_noise", "gyro_noise"):
            if getattr(self, field) < 0:
                raise ConfigError(f"{field}: {getattr(self, field)} is negative")

    @classmethod
    def of(cls, model: RobotModel) -> "Equipment":
        """Return the accessories that this type of robot comes with: a PeopleBot senses tables."""
        return cls(table_ir="new" if model.table_irs else None)


@dataclass(frozen=True, slots=True, kw_only=True)
class EquipmentOptions:
    """Choices of :class:`Equipment`; `None` keeps the model's own.

    Fields mean the same as there; `none` stands for no camera, laser or table sensors. `bumpers`
    are the segments in front, and as many behind; they belong to the model.
    """

    gripper: bool | None = None
    compass: bool | None = None
    gyro_type: Annotated[int | None, FieldForm("gyro", Annotated[int, Meta(ge=0, le=2)])] = None
    bumpers: Annotated[int, Meta(ge=0, le=int(BUMPERS.high))] | None = None
    joystick: bool | None = None
    camera: Camera | Literal["none"] | None = None
    camera_port: Annotated[int, Meta(ge=1, le=3)] | None = None
    picture_port: _Port | None = None
    picture_width: Annotated[int, _range("picture_width")] | None = None
    picture_height: Annotated[int, _range("picture_height")] | None = None
    picture_rate: Annotated[float, _range("picture_rate")] | None = None
    laser: Annotated[str | None, FieldForm("laser", Literal.__getitem__((*LASERS, "none")))] = None
    laser_port: _Port | None = None
    table_ir: TableWiring | Literal["none"] | None = None
    north: Annotated[float | None, in_degrees("north_deg", -tau, tau)] = None
    compass_noise: Annotated[float | None, in_degrees("compass_noise_deg", 0, pi)] = None
    gyro_bias: Annotated[float | None, in_degrees("gyro_bias_deg_s", -_DRIFT, _DRIFT)] = None
    gyro_noise: Annotated[float | None, in_degrees("gyro_noise_deg_s", 0, _DRIFT)] = None

    def equipment_of(self, model: RobotModel) -> Equipment:
        """Return the equipment of a robot of this model."""
        bare = ((name, None if value == "none" else value) for name, value in self._chosen())
        chosen: Mapping[str, Any] = {name: value for name, value in bare if name != "bumpers"}
        return replace(Equipment.of(model), **chosen)

    def model_with(self, model: RobotModel) -> RobotModel:
        """Return `model` with the chosen bumpers, which are part of a robot's outline."""
        if self.bumpers is None:
            return model
        return replace(model, front_bumpers=self.bumpers, rear_bumpers=self.bumpers)

    def overridden_by(self, other: "EquipmentOptions") -> "EquipmentOptions":
        """Return these choices, replaced by those of `other` that are not `None`."""
        return replace(self, **dict(other._chosen()))

    def _chosen(self) -> list[tuple[str, Any]]:
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return [(name, value) for name, value in values if value is not None]


NO_OPTIONS = EquipmentOptions()


def _one_of(field: str, value: object, choices: tuple[object, ...]) -> None:
    if value not in choices:
        raise ConfigError(f"{field}: {value!r} is not one of {', '.join(map(str, choices))}")
