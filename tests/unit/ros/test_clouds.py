import struct
from math import hypot, inf, nan

import pytest

from pioneer3.ros.messages import sensors
from pioneer3.ros.messages.update import MessageOptions
from pioneer3.state import Bumpers, Sonar
from tests.unit.ros.support import P3AT, Blank, seen, update


def test_every_transducer_has_a_point_also_without_an_echo() -> None:
    ranges = (2.0, inf, nan, *(1.0,) * 13)
    message = Blank()
    sensors.sonar_cloud(message, update(seen(sonar=Sonar(ranges=ranges))))
    assert message.header.frame_id == "sonar"
    far = [
        hypot(point.x - mount.x, point.y - mount.y)
        for point, mount in zip(message.points, P3AT.sonars, strict=True)
    ]
    assert far == pytest.approx([2.0, 5.0, 5.0, *(1.0,) * 13])
    assert message.points[0].y == pytest.approx(P3AT.sonars[0].y + 2.0)  # it looks to the left
    assert {point.z for point in message.points} == {0.0}


def test_a_cloud_of_the_second_kind_holds_the_same_points() -> None:
    one, two = Blank(), Blank()
    from_it = update(seen(sonar=Sonar(ranges=(1.0,) * 16)))
    sensors.sonar_cloud(one, from_it)
    sensors.sonar_cloud2(two, from_it)
    assert (two.height, two.width, two.point_step, two.row_step) == (1, 16, 12, 192)
    assert (two.is_dense, two.is_bigendian) == (False, False)
    assert [(f.name, f.offset, f.datatype, f.count) for f in two.fields] == [
        ("x", 0, 7, 1),
        ("y", 4, 7, 1),
        ("z", 8, 7, 1),
    ]
    unpacked = list(struct.iter_unpack("<3f", two.data))
    assert unpacked == [pytest.approx((p.x, p.y, 0.0)) for p in one.points]


def test_echoes_are_what_has_been_heard_since_the_last_reading() -> None:
    message = Blank()
    sonar = Sonar(ranges=(inf, 1.0, nan, 2.0, *(inf,) * 12), fresh=(0, 1, 4))
    sensors.echoes(message, update(seen(sonar=sonar)))
    (point,) = struct.iter_unpack("<3f", message.data)
    mount = P3AT.sonars[1]
    assert hypot(point[0] - mount.x, point[1] - mount.y) == pytest.approx(1.0)
    assert point[2] == pytest.approx(0.23)
    assert (message.width, message.is_dense) == (1, True)
    assert message.header.frame_id == "base_link"


def test_the_height_of_echoes_can_be_given() -> None:
    message = Blank()
    sonar = Sonar(ranges=(1.0,) * 16, fresh=(0,))
    sensors.echoes(message, update(seen(sonar=sonar), MessageOptions(sonar_height=0.5)))
    assert [z for *_, z in struct.iter_unpack("<3f", message.data)] == [0.5]


def test_a_pressed_segment_is_a_point_on_the_outline() -> None:
    message = Blank()
    front, rear = (False, False, True, False, False), (True, False, False, False, False)
    sensors.touches(message, update(seen(bumpers=Bumpers(front=front, rear=rear))))
    ahead, right = struct.iter_unpack("<3f", message.data)
    assert ahead == pytest.approx((P3AT.length_front, 0.0, 0.09))
    assert right[1] == pytest.approx(-P3AT.width / 2)  # the first one behind is on the right
    assert right[0] < 0


def test_without_contact_the_cloud_is_empty() -> None:
    message = Blank()
    sensors.touches(message, update(seen(bumpers=Bumpers(front=(False,) * 5))))
    assert (message.width, message.data) == (0, b"")
