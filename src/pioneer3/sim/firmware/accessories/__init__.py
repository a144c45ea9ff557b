"""What may be connected to a robot's controller, each a small object that knows no clock.

==============  ===========================================================================
module          what
==============  ===========================================================================
rack            all accessories of one robot, the only one that firmware talks to; which those
                are, `sim/equipment.py` says
base            what an accessory is, and what it feels of the robot
digital_io      digital and analog inputs and outputs
encoders        counts of what the wheels rolled
gyro            samples for the host's heading correction
compass         TCM2
gripper         paddles, break beams and lift; gripper_motion is how they move
table_ir        a PeopleBot's table sensors
joystick        the stick at the robot
aux_port        auxiliary serial ports
cameras         pan-tilt-zoom cameras for these ports
battery         the gauge that BATTERYINFO asks
courtesy        commands that are taken without effect
==============  ===========================================================================
"""

from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware.accessories.base import Carrier, Inputs
from pioneer3.sim.firmware.accessories.gripper_motion import Thing
from pioneer3.sim.firmware.accessories.joystick import Stick
from pioneer3.sim.firmware.accessories.rack import Accessories
from pioneer3.sim.firmware.accessories.table_ir import Table, TableSensor

__all__ = [
    "Accessories",
    "Carrier",
    "Equipment",
    "Inputs",
    "Stick",
    "Table",
    "TableSensor",
    "Thing",
]
