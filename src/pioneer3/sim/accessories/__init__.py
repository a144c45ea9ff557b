"""Accessories of a robot's controller; none of them reads a clock.

=============  =============================================================================
module         purpose
=============  =============================================================================
fitted         all accessories of one robot, the only one that firmware uses; which those
               are, `sim/equipment.py` says
base           the interface of an accessory, and the interface of the robot that carries it
digital_io     digital and analog inputs and outputs, and a PeopleBot's table sensors
gauges         battery gauge, wheel encoders, joystick
gyro           samples for the host's heading correction
compass        TCM2
gripper        paddles, break beams and lift
aux_port       auxiliary serial ports
canon, sony    pan-tilt-zoom cameras for these ports; pan_tilt_zoom has their axes
=============  =============================================================================
"""

from pioneer3.sim.accessories.base import CarryingRobot, Inputs
from pioneer3.sim.accessories.collection import Accessories
from pioneer3.sim.accessories.digital_io import Table, TableSensor
from pioneer3.sim.accessories.gauges import StickPosition
from pioneer3.sim.accessories.gripper import HeldObject
from pioneer3.sim.equipment import Equipment

__all__ = [
    "Accessories",
    "CarryingRobot",
    "Equipment",
    "HeldObject",
    "Inputs",
    "StickPosition",
    "Table",
    "TableSensor",
]
