"""The lab's thirteen modes and ARIA's two, in the order in which ARIA lists them (facts.md 8.2)."""

from pioneer3.demo.modes.acts import acts
from pioneer3.demo.modes.bumps import bumps
from pioneer3.demo.modes.camera import camera
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.command import command
from pioneer3.demo.modes.config import config
from pioneer3.demo.modes.gripper import gripper
from pioneer3.demo.modes.laser import laser
from pioneer3.demo.modes.lines import io
from pioneer3.demo.modes.mode import Gauge, Mode
from pioneer3.demo.modes.position import position
from pioneer3.demo.modes.row import Cell, Row
from pioneer3.demo.modes.sonar import sonar
from pioneer3.demo.modes.status import status
from pioneer3.demo.modes.tcm2 import tcm2
from pioneer3.demo.modes.teleop import teleop, unguarded
from pioneer3.demo.modes.wander import wander

ALL = (
    teleop,
    unguarded,
    wander,
    laser,
    bumps,
    sonar,
    position,
    camera,
    command,
    config,
    status,
    io,
    tcm2,
    acts,
    gripper,
)

__all__ = ["ALL", "Cell", "Cockpit", "Gauge", "Mode", "Row"]
