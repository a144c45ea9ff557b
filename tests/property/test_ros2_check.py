"""No message makes the check of a robot's node fail, however odd its content is."""

import struct
from functools import cache

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.ros.checks.listening import sample_of
from pioneer3.ros.ros2.types import MessageTypes
from tests.unit.ros.checks import robot

TREE = "tf2_msgs/TFMessage"
NUMBERS = st.lists(st.floats(width=32), max_size=6)


@cache
def types() -> MessageTypes:
    return robot.TYPES


@given(
    st.sampled_from(sorted({each.type_name for each in robot.TOPICS.values()})),
    st.lists(st.tuples(st.integers(4, 400), st.integers(0, 255)), max_size=20),
)
def test_a_message_with_changed_bytes_is_read_or_refused(
    name: str, changes: list[tuple[int, int]]
) -> None:
    message = types().make(name)
    if name == TREE:
        message.transforms = [types().make("geometry_msgs/TransformStamped")]
    else:
        next(each for each in robot.TOPICS.values() if each.type_name == name).fill(message)
    cdr = bytearray(types().encode(message))
    for place, value in changes:
        cdr[place % (len(cdr) - 4) + 4] = value
    try:
        read = types().decode(bytes(cdr), name)
    except ValueError:
        return
    assert sample_of(read, 0.0, 0, b"").at == 0.0


@given(NUMBERS, st.floats(width=32), st.floats(width=32), st.floats(width=32))
def test_a_scan_of_any_numbers_is_read(
    ranges: list[float], begin: float, end: float, step: float
) -> None:
    message = types().make("sensor_msgs/LaserScan")
    message.ranges = np.array(ranges, np.float32)
    message.angle_min, message.angle_max, message.angle_increment = begin, end, step
    assert sample_of(message, 0.0, 0, b"").frame == ""


@given(st.binary(max_size=64), st.tuples(*[st.integers(0, 40)] * 5))
def test_a_cloud_of_any_sizes_is_read(data: bytes, sizes: tuple[int, int, int, int, int]) -> None:
    message = types().make("sensor_msgs/PointCloud2")
    robot.cloud(message)
    message.data = np.frombuffer(data, np.uint8)
    message.height, message.width, message.point_step, message.row_step = sizes[:4]
    message.fields[0].offset = sizes[4]
    assert sample_of(message, 0.0, 0, b"").frame == "base_link"


def test_a_dense_cloud_of_numbers_is_right_and_one_without_is_not() -> None:
    message = types().make("sensor_msgs/PointCloud2")
    robot.cloud(message)
    assert sample_of(message, 0.0, 0, b"").faults == ()
    message.data = np.frombuffer(struct.pack("<6f", *[1.0] * 5, np.nan), np.uint8)
    (fault,) = sample_of(message, 0.0, 0, b"").faults
    assert fault.reason == "is_dense, but z is not finite everywhere"
