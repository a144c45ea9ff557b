"""Accessories of a robot's controller; none of them reads a clock.

=============  =============================================================================
module         contents
=============  =============================================================================
base           the interface of an accessory, and the interface of the robot that carries it
digital_io     digital and analog inputs and outputs, and a PeopleBot's table sensors
gauges         battery gauge, wheel encoders, joystick
heading        TCM2 compass; gyro, whose samples the host corrects its heading with
gripper        paddles, break beams and lift
aux_port       auxiliary serial ports
collection     all accessories of one robot
sony           Sony EVI-D30 in VISCA
canon          Canon VC-C4: the commands that ARIA's `ArVCC4` sends, and its answers
pan_tilt_zoom  the three axes of a pan-tilt-zoom camera, which move at constant speed
=============  =============================================================================
"""

from pioneer3.sim.accessories.base import CarryingRobot, SipFields
from pioneer3.sim.accessories.collection import Accessories
from pioneer3.sim.accessories.digital_io import TableSensor
from pioneer3.sim.accessories.gauges import StickPosition
from pioneer3.sim.accessories.gripper import HeldObject
from pioneer3.sim.equipment import Equipment

__all__ = [
    "Accessories",
    "CarryingRobot",
    "Equipment",
    "HeldObject",
    "SipFields",
    "StickPosition",
    "TableSensor",
]
