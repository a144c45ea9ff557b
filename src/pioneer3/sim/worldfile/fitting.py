"""What is fitted to one robot of a world, on top of what its model comes with."""

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

from pioneer3.models import RobotModel
from pioneer3.models.bounds import BUMPERS
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.worldfile.table import Source, Table
from pioneer3.units import DEGREE

NONE = "none"
Camera = Literal["none", "vcc4", "sony"]
TableIr = Literal["none", "old", "new"]
CAMERAS: tuple[Camera, ...] = ("none", "vcc4", "sony")
TABLE_IRS: tuple[TableIr, ...] = ("none", "old", "new")

KEYS = (
    "gripper",
    "compass",
    "gyro",
    "bumpers",
    "joystick",
    "camera",
    "camera_port",
    "table_ir",
    "north_deg",
    "compass_noise_deg",
    "gyro_bias_deg_s",
    "gyro_noise_deg_s",
)
"""Of the table `equipment` of a robot, and the words of `--fit`."""
_ALONE = {
    "gripper": "true",
    "bumpers": "5",
    "compass": "true",
    "joystick": "true",
    "gyro": "1",
    "table_ir": "new",
}
"""What a word of `--fit` without a value means."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fitting:
    """Choices of :class:`pioneer3.sim.equipment.Equipment`; `None` is as the model comes.

    Attributes:
        gripper: Whether there is one.
        bumpers: Segments in front, and as many behind; part of the model that :meth:`to` returns.
        compass: Whether there is a TCM2.
        gyro_type: 0 none, 1 the host corrects the heading, 2 the controller does.
        joystick: Whether there is one at the robot.
        camera: Canon VC-C4 or Sony EVI-D30.
        camera_port: The AUX port it is connected to.
        table_ir: How the table sensors are wired.
        north: Where magnetic north lies, counter-clockwise from the x axis [rad].
        compass_noise: Standard deviation [rad].
        gyro_bias: What the gyro adds to every rate [rad/s].
        gyro_noise: Standard deviation [rad/s].
    """

    gripper: bool | None = None
    bumpers: int | None = None
    compass: bool | None = None
    gyro_type: int | None = None
    joystick: bool | None = None
    camera: Camera | None = None
    camera_port: int | None = None
    table_ir: TableIr | None = None
    north: float | None = None
    compass_noise: float | None = None
    gyro_bias: float | None = None
    gyro_noise: float | None = None

    def on(self, model: RobotModel) -> Equipment:
        """Return the equipment of a robot of this model."""
        chosen: dict[str, Any] = {
            key: None if value == NONE else value for key, value in self._said().items()
        }
        chosen.pop("bumpers", None)
        return replace(Equipment.of(model), **chosen)

    def to(self, model: RobotModel) -> RobotModel:
        """Return `model` with the bumpers that are chosen: they belong to a robot's outline."""
        if self.bumpers is None:
            return model
        return replace(model, front_bumpers=self.bumpers, rear_bumpers=self.bumpers)

    def but(self, other: "Fitting") -> "Fitting":
        """Return this, but as `other` says wherever it says anything."""
        return replace(self, **other._said())

    def _said(self) -> "dict[str, Any]":
        said = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in said.items() if value is not None}


AS_DELIVERED = Fitting()


def read_fitting(table: Table) -> Fitting:
    """Read the table `equipment` of a robot.

    Raises:
        ConfigError: It is wrong; names the key.
    """
    table.only(KEYS)
    return Fitting(
        gripper=_flag(table, "gripper"),
        bumpers=table.whole("bumpers", 0, int(BUMPERS.high)),
        compass=_flag(table, "compass"),
        gyro_type=table.whole("gyro", 0, 2),
        joystick=_flag(table, "joystick"),
        camera=table.choice("camera", CAMERAS),
        camera_port=table.whole("camera_port", 1, 3),
        table_ir=table.choice("table_ir", TABLE_IRS),
        north=_angle(table, "north_deg", -360, 360),
        compass_noise=_angle(table, "compass_noise_deg", 0, 180),
        gyro_bias=_angle(table, "gyro_bias_deg_s", -100, 100),
        gyro_noise=_angle(table, "gyro_noise_deg_s", 0, 100),
    )


def parse_fitting(text: str) -> Fitting:
    """Read what `--fit` says, such as `gripper,gyro=2,camera=vcc4,table-ir=new`.

    Raises:
        ConfigError: A word is unknown, or its value is wrong.
    """
    source = Source("--fit", "")
    said: dict[str, object] = {}
    for word in filter(None, (word.strip() for word in text.split(","))):
        key, equals, value = (part.strip() for part in word.partition("="))
        key = key.replace("-", "_")
        if key in KEYS and not equals and key not in _ALONE:
            raise source.wrong(key, f"needs a value, such as {_example(key)}")
        said[key] = _value(value if equals else _ALONE.get(key, "true"))
    return read_fitting(Table(source, "", said))


def _value(text: str) -> object:
    """Return `text` as TOML would: true or false, a number, else a text."""
    if text in {"true", "false"}:
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _example(key: str) -> str:
    return "camera=vcc4" if key == "camera" else f"{key.replace('_', '-')}=1"


def _flag(table: Table, key: str) -> bool | None:
    return table.flag(key, default=False) if key in table.data else None


def _angle(table: Table, key: str, low: float, high: float) -> float | None:
    return table.number(key, low, high) * DEGREE if key in table.data else None
