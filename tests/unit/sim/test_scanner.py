"""The laser in the robot's own stream, set up the old way and the new (arcos.md 2.3, 5.13)."""

from math import radians

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import SimLaserMode
from pioneer3.arcos.reports import SimLaser, SimLaserExtended
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.scanner import Scanner
from pioneer3.sim.world import World
from tests.support import wall_at

OLD = (
    commands.OldLaserStart(radians(-90)),
    commands.OldLaserEnd(radians(90)),
    commands.OldLaserStep(radians(1)),
)


def scanner(wall: float = 3.0, home: Pose2 | None = None) -> Scanner:
    body = Body(load_model("p3at-sh"), home or Pose2())
    return Scanner(World(wall_at(wall), [body]), body)


def received(command: commands.Command) -> commands.Command:
    """Return `command` as a robot reads it, which knows nothing of old lasers."""
    return commands.from_payload(commands.to_payload(command))


def set_up(laser: Scanner, mode: SimLaserMode) -> None:
    for command in (*OLD, commands.OldLaser(mode)):
        assert laser.obey(received(command))


def test_it_is_off_until_asked_for() -> None:
    assert scanner().reports() == []


@pytest.mark.parametrize(
    ("mode", "kind"),
    [(SimLaserMode.RANGES, SimLaser), (SimLaserMode.EXTENDED, SimLaserExtended)],
)
def test_the_old_setup_gives_whole_sweeps(
    mode: SimLaserMode, kind: type[SimLaser | SimLaserExtended]
) -> None:
    laser = scanner()
    set_up(laser, mode)
    packets = laser.reports()
    assert len(packets) == 6  # 181 readings, 32 a packet
    ranges: list[int] = []
    for packet in packets:
        assert isinstance(packet, kind)
        assert packet.total == 181
        assert packet.first == len(ranges)
        if isinstance(packet, SimLaser):
            ranges += packet.ranges_mm
        else:
            ranges += [reading.range_mm for reading in packet.readings]
    assert len(ranges) == 181
    mount = load_model("p3at-sh").laser
    assert ranges[90] == pytest.approx(1000 * (3.0 - (mount.x if mount else 0)), abs=1)
    assert ranges[0] > 30_000


def test_the_new_setup_does_the_same() -> None:
    laser = scanner()
    for command in (
        commands.SimLrfSetFovStart(angle=radians(-45), laser=0),
        commands.SimLrfSetFovEnd(angle=radians(45), laser=0),
        commands.SimLrfSetRes(step=radians(0.5), laser=0),
        commands.SimLrfEnable(SimLaserMode.EXTENDED, laser=0),
    ):
        assert laser.obey(command)
    (first, *_) = laser.reports()
    assert isinstance(first, SimLaserExtended)
    assert first.total == 181


def test_switched_off_it_is_silent() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    assert laser.obey(received(commands.OldLaser(SimLaserMode.OFF)))
    assert laser.reports() == []


def test_a_grippers_request_while_the_laser_runs_does_not_bend_it() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    before = laser.reports()
    assert not laser.obey(commands.GripperPacRequest(commands.Request.STREAM))
    assert laser.reports() == before


def test_the_end_of_a_session_forgets_the_setup() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    laser.off()
    assert laser.reports() == []


def test_other_commands_are_not_the_lasers() -> None:
    assert not scanner().obey(commands.Vel(0.1))
