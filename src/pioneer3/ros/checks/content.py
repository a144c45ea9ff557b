"""Checks the fields of a message: numbers, quaternions, covariances, sizes. Pure.

NaN and infinity are allowed where the definition of a message or REP 117 gives them a meaning.
"""

from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import fields, is_dataclass
from math import hypot, isfinite, isinf, isnan, sqrt
from typing import Any, Final

import numpy as np

from pioneer3.ros.checks.facts import CheckFault, fail, warn

NAN, INF = "NaN", "infinite"
ALLOWED: Final[Mapping[str, Mapping[str, Set[str]]]] = {
    "sensor_msgs/msg/LaserScan": {"ranges": {NAN, INF}, "intensities": {NAN}},  # REP 117
    "sensor_msgs/msg/Range": {"range": {INF}},  # REP 117; NaN passes tests of costmaps
    "sensor_msgs/msg/BatteryState": dict.fromkeys(
        (
            "temperature",
            "current",
            "charge",
            "capacity",
            "design_capacity",
            "percentage",
            "cell_voltage",
            "cell_temperature",
        ),
        frozenset({NAN}),  # "if unmeasured NaN", as the definition says
    ),
}
"""Fields with numbers that are not finite, by type."""
UNIT: Final = 1e-3
"""A unit quaternion's length may differ from 1 by this much."""
NOT_MEASURED: Final = -1.0
"""First number of a covariance in sensor_msgs/Imu whose quantity is not measured."""
BEAMS: Final = 1
"""Beams that rounding of angles may add or take."""
MOST: Final = 0.5
"""A larger share of readings that are not as REP 117 wants them is a fault."""
SIZES: Final = {7: ("f4", 4), 8: ("f8", 8)}
"""Types and lengths of `PointField.FLOAT32` and `FLOAT64` [bytes]."""
ERROR: Final = 2
"""`DiagnosticStatus.ERROR`."""


def faults_in(message: Any) -> tuple[CheckFault, ...]:
    """Return the faults in the fields of a message."""
    name = message.__msgtype__
    special = SPECIAL.get(name)
    return (*_walk(message, "", name), *(special(message) if special else ()))


def _walk(value: Any, path: str, top: str) -> Iterator[CheckFault]:
    """Yield the faults of all numbers, quaternions and covariances in `value`."""
    if isinstance(value, float | np.floating):
        yield from _number(float(value), path, top)
    elif isinstance(value, np.ndarray):
        yield from _array(value, path, top)
    elif isinstance(value, list):
        for place, each in enumerate(value):
            label = getattr(each, "child_frame_id", place)
            yield from _walk(each, f"{path}[{label}]", top)
    elif is_dataclass(value):
        if getattr(value, "__msgtype__", "") == "geometry_msgs/msg/Quaternion":
            yield from _quaternion(value, path)
        covariance = getattr(value, "orientation_covariance", None)
        is_measured = covariance is None or covariance[0] != NOT_MEASURED
        for each in fields(value):
            if each.name == "orientation" and not is_measured:
                continue
            below = f"{path}.{each.name}" if path else each.name
            yield from _walk(getattr(value, each.name), below, top)


def _number(value: float, path: str, top: str) -> Iterator[CheckFault]:
    kind = NAN if isnan(value) else INF if isinf(value) else ""
    if kind and kind not in ALLOWED.get(top, {}).get(path, frozenset()):
        yield fail(f"{path} is {kind}")


def _array(value: Any, path: str, top: str) -> Iterator[CheckFault]:
    if value.dtype.kind != "f" or not value.size:
        return
    allowed = ALLOWED.get(top, {}).get(path, frozenset())
    for kind, there in ((NAN, np.isnan), (INF, np.isinf)):
        if kind not in allowed and there(value).any():
            yield fail(f"{path} has numbers that are {kind}")
    if path.endswith("covariance") and len(value) in {36, 9} and value[0] != NOT_MEASURED:
        diagonal = value[:: round(sqrt(len(value))) + 1]
        if (diagonal < 0).any():
            yield fail(f"{path} has a negative variance", example=f"{min(diagonal):g}")
        elif not diagonal.any() and path in {"pose.covariance", "twist.covariance"}:
            yield warn(f"{path} is all 0", advice="robot_localization takes that as certain")


def _quaternion(value: Any, path: str) -> Iterator[CheckFault]:
    length = hypot(value.x, value.y, value.z, value.w)
    if isfinite(length) and abs(length - 1) > UNIT:
        yield fail(f"{path} is no unit quaternion", example=f"its length is {length:.3g}")


def _range(message: Any) -> Iterator[CheckFault]:
    near, far, value = message.min_range, message.max_range, message.range
    if near > far:
        yield fail("min_range is larger than max_range", example=f"{near:g} m, {far:g} m")
    elif isfinite(value) and not near - UNIT <= value <= far + UNIT:
        yield warn(
            "range is outside of min_range to max_range",
            example=f"{value:g} m",
            advice="the definition of the message says that others discard it",
        )
    if not message.field_of_view > 0:
        yield warn("field_of_view is 0", advice="costmaps mark nothing then")


def _scan(message: Any) -> Iterator[CheckFault]:
    values, step = np.asarray(message.ranges), message.angle_increment
    if not len(values):
        yield fail("ranges is empty")
        return
    span, gaps = message.angle_max - message.angle_min, len(values) - 1
    if gaps and isfinite(span * step) and abs(span - gaps * step) > BEAMS * abs(step):
        beams = f"{span / step + 1:.0f}" if step else "no"
        yield fail(
            "angles and ranges do not agree",
            example=f"{beams} beams by the angles, {len(values)} ranges",
        )
    if len(message.intensities) not in {0, len(values)}:
        yield fail("intensities and ranges differ in number")
    if np.isnan(values).mean() > MOST:
        yield warn("most ranges are NaN", advice="REP 117: NaN is a failure, inf is no echo")
    with np.errstate(invalid="ignore"):
        odd = np.isfinite(values) & (
            (values < message.range_min - UNIT) | (values > message.range_max + UNIT)
        )
    if odd.mean() > MOST:
        yield warn(
            "most ranges are outside of range_min to range_max",
            example=f"{values[odd][0]:g} m",
            advice="REP 117: inf is no echo, -inf is too near",
        )


def _battery(message: Any) -> Iterator[CheckFault]:
    share = message.percentage
    if isfinite(share) and not 0 <= share <= 1:
        yield fail("percentage is not from 0 to 1", example=f"{share:g}")


def _joints(message: Any) -> Iterator[CheckFault]:
    for name in ("position", "velocity", "effort"):
        if len(getattr(message, name)) not in {0, len(message.name)}:
            yield fail(f"name and {name} differ in number")
    if not message.name:
        yield warn("there are no joints")
    elif len(set(message.name)) < len(message.name):
        yield fail("two joints have one name")


def _cloud(message: Any) -> Iterator[CheckFault]:
    rows, size = message.height * message.row_step, len(message.data)
    if rows != size or message.row_step < message.width * message.point_step:
        yield fail("its sizes do not agree", example=f"{rows} bytes by its sizes, {size} bytes")
        return
    if not message.is_dense:
        return
    points = np.frombuffer(bytes(message.data), np.uint8).reshape(message.height, message.row_step)
    used = np.ascontiguousarray(points[:, : message.width * message.point_step])
    for field in message.fields if used.size else ():
        if field.datatype not in SIZES:
            continue
        letter, length = SIZES[field.datatype]
        if field.offset + length > message.point_step:
            yield fail(f"{field.name} is beyond the end of a point")
            continue
        numbers = used.view(
            np.dtype(
                {
                    "names": ["it"],
                    "formats": [f"{'>' if message.is_bigendian else '<'}{letter}"],
                    "offsets": [field.offset],
                    "itemsize": message.point_step,
                }
            )
        )
        if not np.isfinite(numbers["it"]).all():
            yield fail(f"is_dense, but {field.name} is not finite everywhere")


def _image(message: Any) -> Iterator[CheckFault]:
    if message.height * message.step != len(message.data):
        yield fail("height, step and data do not agree")


def _transforms(message: Any) -> Iterator[CheckFault]:
    for each in message.transforms:
        parent, child = each.header.frame_id, each.child_frame_id
        if not parent or not child:
            yield fail("a transform has a frame without a name")
        elif parent == child:
            yield fail(f"{child} is its own parent")
        for name in (parent, child):
            if name.startswith("/"):
                yield fail(f"the frame {name} begins with a slash", advice="tf2 has none")


def _diagnostics(message: Any) -> Iterator[CheckFault]:
    for each in message.status:
        if each.level >= ERROR:
            yield warn(f"it says of {each.name}: {each.message}")


SPECIAL: Final[Mapping[str, Callable[[Any], Iterator[CheckFault]]]] = {
    "diagnostic_msgs/msg/DiagnosticArray": _diagnostics,
    "sensor_msgs/msg/BatteryState": _battery,
    "sensor_msgs/msg/Image": _image,
    "sensor_msgs/msg/JointState": _joints,
    "sensor_msgs/msg/LaserScan": _scan,
    "sensor_msgs/msg/PointCloud2": _cloud,
    "sensor_msgs/msg/Range": _range,
    "tf2_msgs/msg/TFMessage": _transforms,
}
"""Checks beyond the numbers, by type."""
