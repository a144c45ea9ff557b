"""The laser in the robot's own stream, set up the old way and the new (protocol.md 2.3, 5.13)."""

from math import radians

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import SimLaserMode
from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import SimLaser, SimLaserExtended, from_payload
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware.laser import InBandLaser
from pioneer3.sim.world import World
from tests.support import wall_at

OLD = (
    commands.OldLaserStart(radians(-90)),
    commands.OldLaserEnd(radians(90)),
    commands.OldLaserStep(radians(1)),
)


def scanner(wall: float = 3.0, home: Pose2 | None = None) -> InBandLaser:
    body = Body(load_model("p3at-sh"), home or Pose2())
    return InBandLaser(World(wall_at(wall), [body]), body)


def packets(laser: InBandLaser) -> list[SimLaser | SimLaserExtended]:
    """Return one sweep as a host reads it."""
    sweep = [from_payload(payload) for payload in PacketReader().feed(laser.frames())]
    return [part for part in sweep if isinstance(part, SimLaser | SimLaserExtended)]


def ranges_of(laser: InBandLaser) -> list[int]:
    """Return the readings of one sweep [mm], whichever packets bring them."""
    ranges: list[int] = []
    for packet in packets(laser):
        assert packet.first == len(ranges)
        if isinstance(packet, SimLaser):
            ranges += packet.ranges_mm
        else:
            ranges += [reading.range_mm for reading in packet.readings]
    return ranges


def received(command: commands.Command) -> commands.Command:
    """Return `command` as a robot reads it, which knows nothing of old lasers."""
    return commands.from_payload(commands.to_payload(command))


def set_up(laser: InBandLaser, mode: SimLaserMode) -> None:
    for command in (*OLD, commands.OldLaser(mode)):
        assert laser.obey(received(command))


def test_it_is_off_until_asked_for() -> None:
    assert scanner().frames() == b""


@pytest.mark.parametrize(
    ("mode", "kind"),
    [(SimLaserMode.RANGES, SimLaser), (SimLaserMode.EXTENDED, SimLaserExtended)],
)
def test_the_old_setup_gives_whole_sweeps(
    mode: SimLaserMode, kind: type[SimLaser | SimLaserExtended]
) -> None:
    laser = scanner()
    set_up(laser, mode)
    sweep = packets(laser)
    assert [type(packet) for packet in sweep] == [kind] * 6  # 181 readings, 32 a packet
    assert {packet.total for packet in sweep} == {181}
    ranges = ranges_of(laser)
    assert len(ranges) == 181
    mount = load_model("p3at-sh").laser
    assert ranges[90] == pytest.approx(1000 * (3.0 - (mount.x if mount else 0)), abs=1)


def test_where_nothing_is_it_reads_what_hosts_take_for_nothing() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    ranges = ranges_of(laser)
    assert ranges[0] == ranges[180] == 0x7FFF
    assert max(ranges[80:100]) < 4000


def test_the_new_setup_does_the_same() -> None:
    laser = scanner()
    for command in (
        commands.SimLrfSetFovStart(angle=radians(-45), laser=0),
        commands.SimLrfSetFovEnd(angle=radians(45), laser=0),
        commands.SimLrfSetRes(step=radians(0.5), laser=0),
        commands.SimLrfEnable(SimLaserMode.EXTENDED, laser=0),
    ):
        assert laser.obey(command)
    assert len(ranges_of(laser)) == 181


def test_settings_take_effect_while_it_runs() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    assert len(ranges_of(laser)) == 181
    assert laser.obey(commands.SimLrfSetRes(step=radians(0.5)))
    assert len(ranges_of(laser)) == 361
    assert laser.obey(commands.SimLrfEnable(SimLaserMode.RANGES))
    assert {type(packet) for packet in packets(laser)} == {SimLaser}
    assert len(ranges_of(laser)) == 361


@pytest.mark.parametrize("laser_number", [1, 7])
def test_what_is_for_a_laser_that_it_does_not_have_changes_nothing(laser_number: int) -> None:
    laser = scanner()
    for command in (
        commands.SimLrfEnable(SimLaserMode.EXTENDED, laser=laser_number),
        commands.SimLrfSetFovEnd(angle=0.0, laser=laser_number),
    ):
        assert laser.obey(command)
        assert laser.frames() == b""
    set_up(laser, SimLaserMode.EXTENDED)
    before = laser.frames()
    assert laser.obey(commands.SimLrfSetFovEnd(angle=0.0, laser=laser_number))
    assert laser.obey(commands.SimLrfSetFovStart(angle=0.0, laser=laser_number))
    assert laser.obey(commands.SimLrfSetRes(step=0.1, laser=laser_number))
    assert laser.obey(commands.SimLrfEnable(SimLaserMode.OFF, laser=laser_number))
    assert laser.frames() == before


def test_the_robot_s_pose_is_in_the_packets_that_have_room_for_it() -> None:
    body = Body(load_model("p3at-sh"))
    laser = InBandLaser(World(None, [body]), body)
    body.reset_odometry(Pose2(-1.25, 40.0, radians(-90)))
    set_up(laser, SimLaserMode.RANGES)
    for packet in packets(laser):
        assert isinstance(packet, SimLaser)
        pose = packet.x_mm, packet.y_mm, packet.heading_deg
        assert pose == (-1250, 40_000 - 65_536, -90)


@pytest.mark.parametrize("port", range(3, 8))
def test_an_analog_port_that_no_laser_mode_has_is_not_its(port: int) -> None:
    laser = scanner()
    assert not laser.obey(commands.AdSel(port))
    set_up(laser, SimLaserMode.EXTENDED)
    assert not laser.obey(commands.AdSel(port))
    assert laser.frames()


def test_switched_off_it_is_silent() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    assert laser.obey(received(commands.OldLaser(SimLaserMode.OFF)))
    assert laser.frames() == b""


def test_a_grippers_request_while_the_laser_runs_does_not_bend_it() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    before = laser.frames()
    assert not laser.obey(commands.GripperPacRequest(commands.RequestMode.STREAM))
    assert laser.frames() == before


def test_the_end_of_a_session_forgets_the_setup() -> None:
    laser = scanner()
    set_up(laser, SimLaserMode.EXTENDED)
    laser.off()
    assert laser.frames() == b""


def test_other_commands_are_not_the_lasers() -> None:
    assert not scanner().obey(commands.Vel(0.1))
