"""Robot types: sizes, limits, conversion factors, sensor mounts."""

from pioneer3.models.catalog import (
    Fallback,
    GivenModel,
    find_model,
    generic_model,
    load_model,
    loaded_model,
    model_names,
)
from pioneer3.models.model import Drive, IrMount, LaserMount, RobotModel, SonarMount
from pioneer3.models.physics import BodyPhysics, physics_of, total_mass
from pioneer3.models.shape import Shape, shape_of

__all__ = [
    "BodyPhysics",
    "Drive",
    "Fallback",
    "GivenModel",
    "IrMount",
    "LaserMount",
    "RobotModel",
    "Shape",
    "SonarMount",
    "find_model",
    "generic_model",
    "load_model",
    "loaded_model",
    "model_names",
    "physics_of",
    "shape_of",
    "total_mass",
]
