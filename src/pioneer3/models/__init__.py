"""Robot types: sizes, limits, conversion factors, sensor mounts.

===========  ================================================================================
module       contents
===========  ================================================================================
description  frames, links and shapes of a robot, from its model
lasers       laser range finders as data: field, range, timing, errors, interfaces
numbers      all numbers of a robot's body with their units and sources, to be read by people
physics      masses, motors and tires of a robot's body, for simulators in three dimensions
shape        heights, wheels and casters of a robot, which ARIA's flat files do not have
cameras      the makes of cameras that robots carry, as far as their pictures go
catalog      finds the model of a robot: shipped ones by name, others from a file
own          finds and reads the own file of a robot, by its name or serial number
aria         reads and writes ARIA's `.p` robot parameter files (facts.md 6.1)
parameters   keys and values of an ARIA parameter file, converted to SI
odometry     errors of a robot's odometry, and the numbers of its controller beside them
model        one robot type as frozen numbers, and the range of each number
===========  ================================================================================
"""

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
from pioneer3.models.odometry import EncoderNumbers, OdometryCorrection
from pioneer3.models.physics import BodyPhysics, physics_of, total_mass
from pioneer3.models.shape import BodyShape, shape_of

__all__ = [
    "BodyPhysics",
    "BodyShape",
    "Drive",
    "EncoderNumbers",
    "Fallback",
    "GivenModel",
    "IrMount",
    "LaserMount",
    "OdometryCorrection",
    "RobotModel",
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
