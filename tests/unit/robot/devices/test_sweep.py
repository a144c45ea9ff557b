"""Packets of a laser become scans, whole or not at all (protocol.md 5.13)."""

from math import inf, pi

import pytest

from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import LaserReading, SimLaser, SimLaserExtended, from_payload
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.robot.devices.laser import SweepCollector
from pioneer3.state import Scan

MOUNT = Pose2(0.2, 0.0, 0.0)


def part(first: int, *ranges_mm: int, total: int = 5) -> SimLaser:
    return SimLaser(total=total, first=first, ranges_mm=ranges_mm)


def add(
    sweep: SweepCollector, packet: SimLaser | SimLaserExtended, stamp: float = 0.0
) -> Scan | None:
    return sweep.add(packet, stamp, lambda: Pose2(stamp, 0, 0))


def test_a_sweep_in_two_parts_has_the_pose_of_its_beginning() -> None:
    sweep = SweepCollector(MOUNT, -pi / 2, pi / 2)
    assert add(sweep, part(0, 1000, 2000, 3000), 1.0) is None
    scan = add(sweep, part(3, 0x7FFF, 500), 1.1)
    assert scan is not None
    assert (scan.stamp, scan.robot_in_odom, scan.sequence) == (1.0, Pose2(1, 0, 0), 1)
    assert scan.ranges == (1.0, 2.0, 3.0, inf, 0.5)
    # five readings over half a turn: a quarter of pi apart
    assert scan.angles == pytest.approx((-pi / 2, -pi / 4, 0, pi / 4, pi / 2))
    assert scan.sensor_in_odom == Pose2(1.2, 0, 0)
    assert scan.reflectances == ()


def test_extended_packets_tell_reflectances() -> None:
    sweep = SweepCollector(ORIGIN, 0, 1)
    readings = (LaserReading(1000, 7), LaserReading(2000, 255))
    scan = add(sweep, SimLaserExtended(total=2, first=0, readings=readings))
    assert scan is not None
    assert scan.reflectances == (7, 255)


@pytest.mark.parametrize(
    "packets",
    [
        [part(3, 1, 2)],  # the beginning was lost
        [part(0, 1, 2), part(3, 4, 5)],  # the middle
        [part(0, 1, 2), part(2, 3), part(2, 3), part(3, 4, 5)],  # one came twice
    ],
)
def test_a_sweep_with_a_gap_is_thrown_away_and_the_next_is_whole(packets: list[SimLaser]) -> None:
    sweep = SweepCollector(ORIGIN, 0, 1)
    assert [add(sweep, packet) for packet in packets] == [None] * len(packets)
    assert add(sweep, part(0, 1, 2, 3, 4, 5)) is not None


def test_a_sweep_that_ends_early_is_counted() -> None:
    sweep = SweepCollector(ORIGIN, 0, 1)
    add(sweep, part(0, 1, 2))
    assert add(sweep, part(0, 1, 2, 3, 4, 5)) is not None
    assert sweep.broken == 1


def test_an_empty_sweep_is_none() -> None:
    assert add(SweepCollector(ORIGIN, 0, 1), part(0, total=0)) is None


def test_a_packet_on_the_wire() -> None:
    # x, y, th; 2 readings in all, from the first; 2 here: 1000 mm and nothing
    payload = bytes.fromhex("60 0000 0000 0000 0200 0000 02 e803 ff7f")
    (received,) = PacketReader().feed(encode(payload), 0.0)
    packet = from_payload(received)
    assert isinstance(packet, SimLaser)
    scan = add(SweepCollector(ORIGIN, 0, 1), packet)
    assert scan is not None
    assert scan.ranges == (1.0, inf)
