"""All numbers of a robot's body with their units and sources, to be read by people."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, astuple, fields, is_dataclass
from math import degrees
from types import MappingProxyType
from typing import Final, NamedTuple

from pioneer3.models.model import RobotModel
from pioneer3.models.odometry import UNCORRECTED
from pioneer3.models.physics import physics_of, total_mass
from pioneer3.models.shape import shape_of

PARAMETERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "width": "m",
        "length_front": "m",
        "length_rear": "m",
        "radius": "m",
        "wheel_base": "m",
        "max_speed": "m/s",
        "max_turn_rate": "deg/s",
        "front_bumpers": "",
        "rear_bumpers": "",
    }
)
"""Units of the fields of a :class:`RobotModel` that describe its body and its speed."""
FILE: Final = "the robot's parameter file"
ARIA: Final = "ARIA's parameter file"
DERIVED: Final = "calculated from the numbers here"


class Number(NamedTuple):
    """One number, or a few that belong together, of a part such as `Shape`, with four digits."""

    part: str
    name: str
    value: str
    unit: str
    source: str


def numbers_of(model: RobotModel, *, shipped: bool) -> tuple[Number, ...]:
    """Return parameters, which are ARIA's if the model is `shipped`, shape and physics.

    Numbers of its odometry are there if they were measured.
    """
    parameters = _parameters(model, ARIA if shipped else FILE)
    return (*parameters, *_odometry(model), *_shape(model), *_physics(model))


def _parameters(model: RobotModel, source: str) -> Iterator[Number]:
    for name, unit in PARAMETERS.items():
        value = getattr(model, name)
        shown = _text(degrees(value) if unit == "deg/s" else value)
        yield Number("Parameters", name, shown, unit, source)


def _odometry(model: RobotModel) -> Iterator[Number]:
    if model.odometry != UNCORRECTED:
        for field in fields(model.odometry):
            value = f"{getattr(model.odometry, field.name):.5g}"
            yield Number("Odometry", field.name, value, "", FILE)
    if model.encoders is not None:
        for name, number in asdict(model.encoders).items():
            yield Number("Odometry", name, str(number), "", FILE)


def _shape(model: RobotModel) -> Iterator[Number]:
    shape = shape_of(model)
    for name, source in shape.sources.items():
        yield Number("Shape", name, _text(getattr(shape, name)), "m", source)
    yield Number("Shape", "effective_track", _text(shape.effective_track), "m", DERIVED)


def _physics(model: RobotModel) -> Iterator[Number]:
    physics, shape = physics_of(model), shape_of(model)
    part = "Physics"
    for field in fields(physics):
        if field.name == "sources" or (field.name.startswith("caster") and shape.caster is None):
            continue
        value, source = getattr(physics, field.name), physics.sources[field.name]
        yield Number(part, field.name, _text(value), field.metadata["unit"], source)
    yield Number(part, "base_inertia", _text(physics.base_inertia()), "kg m2", DERIVED)
    yield Number(part, "wheel_inertia", _text(physics.wheel_inertia(shape)), "kg m2", DERIVED)
    yield Number(part, "total_mass", _text(total_mass(model)), "kg", DERIVED)


def _text(value: object) -> str:
    """Return a number, or the numbers of a tuple or dataclass; tuples within have brackets."""
    if is_dataclass(value) and not isinstance(value, type):
        value = astuple(value)
    if isinstance(value, tuple):
        texts = [_text(each) for each in value]
        pairs = zip(texts, value, strict=True)
        return ", ".join(f"({text})" if isinstance(of, tuple) else text for text, of in pairs)
    return f"{value:.4g}"
