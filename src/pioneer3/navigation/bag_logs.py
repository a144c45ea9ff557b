"""Reads rosbags, of ROS 1 and ROS 2: scans of a laser, and the odometry of what carries it."""

import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, TURN
from pioneer3.log.cut import CutMcapPath, is_cut
from pioneer3.names import printable
from pioneer3.nav.logged import Entry, LoggedOdometry, Pairing, Sources
from pioneer3.navigation.bag_frames import (
    BagFrames,
    FramePair,
    frame_name,
    is_odom,
    mounted,
    pose_of,
)
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.state import Scan
from pioneer3.text import one_line, wrong

SCAN = "sensor_msgs/msg/LaserScan"
"""Type of scans."""
ECHOES = "sensor_msgs/msg/MultiEchoLaserScan"
"""Type of scans with several echoes of each beam; the nearest counts."""
ODOMETRY = "nav_msgs/msg/Odometry"
"""Type of odometry."""
TRANSFORMS = "tf2_msgs/msg/TFMessage"
"""Type of transforms."""
OLD_TRANSFORMS = "tf/msg/tfMessage"
"""Type of transforms before tf2, with the same fields."""
USED = {kind: kind for kind in (SCAN, ECHOES, ODOMETRY, TRANSFORMS)} | {OLD_TRANSFORMS: TRANSFORMS}
"""Types that are read, and what they are read as."""
TF = "tf"
"""Name of the odometry that transforms tell."""
STATIC = "/tf_static"
"""Topic of transforms that never change."""
LOOKED_AT = 20_000
"""Messages that are looked at for the frames of a bag at most."""
FARTHEST = 200.0
"""Longest range that a laser may have [m]; a longer one is a mistake."""
LONGEST_SCAN = 1.0
"""Time from the first to the last reading of a scan at most [s]; a longer one is a mistake."""
FEWEST = 2
"""Readings of a scan at least."""
MOST_TURNED = 1.1 * TURN
"""Directions that a scan covers at most [rad]."""
AT_LIMIT = 1e-3
"""Difference from the longest range below which a reading means that nothing echoed [m]."""
BASES = ("base_link", "base_footprint")
"""BagFrames of a robot where odometry does not tell one."""
MOST_TOPICS = 8
"""Topics that an error names at most."""
NANO = 1e-9
"""Nanosecond [s]."""


class _Storage(Protocol):
    """A reader of rosbags."""

    connections: list[Any]

    def open(self) -> None: ...

    def close(self) -> None: ...

    def messages(self, connections: list[Any]) -> Iterator[tuple[Any, int, bytes]]:
        """Yield connection, time [ns] and message."""


@dataclass(frozen=True, slots=True)
class BagFormat:
    """A format of rosbags: its name, the suffix of files or `dir`, and the program that mends."""

    name: str
    storage: str
    mended_by: str


ROS_1 = BagFormat("a rosbag of ROS 1", ".bag", "rosbag reindex")
MCAP = BagFormat("an MCAP file", ".mcap", "mcap recover")
SQLITE = BagFormat("a rosbag of ROS 2 (SQLite)", ".db3", "ros2 bag reindex")
FOLDER = BagFormat("a rosbag of ROS 2", "dir", "ros2 bag reindex")


class Bag:
    """A rosbag as a log, while it is open; `share` of its entries, 0 to 1, is read.

    `given` is where the laser is, if somebody says so; else it is as the transforms tell.

    Raises:
        ConfigError: It is damaged, has no scans, or rosbags is missing.
    """

    def __init__(self, path: Path, bag_format: BagFormat, given: Mounting | None = None) -> None:
        self.name, self._mended_by = bag_format.name, bag_format.mended_by
        cut = bag_format is MCAP and is_cut(path)
        self.notes = ["the end of the file is missing: read up to there"] if cut else []
        self.share = 0.0
        self._path, self._given = path, given
        self._faults = _faults(path)
        self._storage: _Storage = _storage(path, bag_format, cut=cut)
        self._read_as = _types(ros_1=bag_format is ROS_1)
        self._frames = BagFrames()
        self._carriers: dict[str, str] = {}
        self._damaged = 0

    def __enter__(self) -> Self:
        with self._damage_told():
            self._storage.open()
            try:
                self._look()
            except BaseException:
                self._storage.close()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        self._storage.close()

    @property
    def sources(self) -> Sources:
        """The topics of scans and odometry, those to be taken first before the others.

        A level laser comes before others, then one on a topic `scan`, then that with most scans.
        The transform below a frame of odometry comes before messages, and another one after them;
        messages beside the laser in their namespace come first, then likewise a topic `odom`.
        """
        lasers = self._topics(SCAN, ECHOES)
        lasers.sort(key=lambda topic: not self._is_level(topic))
        odometry, beside = self._topics(ODOMETRY), lasers[0].rpartition("/")[0]
        odometry.sort(key=lambda topic: topic.rpartition("/")[0] != beside)
        edge = self._edge(lasers[0])
        if edge is not None:
            odometry.insert(0 if is_odom(edge.parent) else len(odometry), TF)
        return Sources(tuple(lasers), tuple(odometry))

    def entries(self, laser: str, odometry: str) -> Iterator[Entry]:
        """Yield the readings of a laser and of odometry, in the order of time."""
        edge = self._edge(laser) if odometry == TF else None
        if odometry == TF and edge is None:
            raise wrong(self._path, f": no transform moves what carries {laser}")
        mounting = self._mounting(laser, edge.child if edge else self._carriers.get(odometry))
        wanted = [
            each
            for each in self._storage.connections
            if each.topic in (laser, odometry)
            or (edge and USED.get(each.msgtype) == TRANSFORMS and each.topic != STATIC)
        ]
        self._damaged = 0
        total, pairing = max(1, sum(each.msgcount for each in wanted)), Pairing()
        with self._damage_told():
            for number, (connection, time, message) in enumerate(self._read(wanted), 1):
                self.share = number / total
                if connection.topic != laser:
                    for moved in _moved(message, time, edge):
                        yield from pairing.move(moved)
                elif (scan := _scan(message, time, number, mounting)) is not None:
                    yield from pairing.scan(scan)
                else:
                    self._damaged += 1
            yield from pairing.rest()
        if self._damaged:
            self.notes.append(f"messages that are damaged and left out: {self._damaged}")

    def _topics(self, *kinds: str) -> list[str]:
        """Return the topics of these types, the most likely one first."""
        counts: dict[str, int] = {}
        for each in self._storage.connections:
            if each.msgtype in kinds and each.msgcount:
                counts[each.topic] = counts.get(each.topic, 0) + each.msgcount
        usual = "odom" if ODOMETRY in kinds else "scan"
        return sorted(counts, key=lambda t: (t.rpartition("/")[2] != usual, -counts[t], t))

    def _look(self) -> None:
        """Read the frames, and which of them each laser is in."""
        connections, lasers = self._storage.connections, self._topics(SCAN, ECHOES)
        if not lasers:
            found = "; ".join([*self.notes, _listed(connections)])
            raise wrong(self._path, f" is {self.name} without LaserScan; {found}")
        used = [each for each in connections if each.msgtype in USED]
        for _, _, message in self._read([each for each in used if each.topic == STATIC]):
            self._note_frames(message)
        others = [each for each in used if each.topic != STATIC]
        for count, (connection, _, message) in enumerate(self._read(others, self._carriers)):
            kind = USED[connection.msgtype]
            if kind == TRANSFORMS:
                self._note_frames(message)
            else:
                field = message.child_frame_id if kind == ODOMETRY else message.header.frame_id
                self._carriers[connection.topic] = frame_name(field)
            if count > LOOKED_AT and self._carriers.keys() >= set(lasers):
                break

    def _note_frames(self, message: Any) -> None:
        for each in message.transforms:
            self._frames.take(_pair(each), each.transform)

    def _edge(self, laser: str) -> FramePair | None:
        return self._frames.odometry(self._carriers.get(laser, ""))

    def _bases(self, laser: str, base: str | None = None) -> tuple[str, ...]:
        """Return the frames that may be the robot: those of odometry, and the usual ones."""
        edge = self._edge(laser)
        return tuple(each for each in (base, edge.child if edge else None, *BASES) if each)

    def _is_level(self, laser: str) -> bool:
        frame = self._carriers.get(laser, "")
        return all(self._frames.is_level(frame, base) for base in self._bases(laser))

    def _mounting(self, laser: str, base: str | None) -> Mounting:
        """Return where a laser is on the robot; note what is not known of it, or not good."""
        frame = self._carriers.get(laser, "")
        if not self._is_level(laser):
            self.notes.append(f"{laser} does not measure a level plane: the map may be wrong")
        if self._given is not None:
            return self._given
        for each in self._bases(laser, base):
            mounting = self._frames.mounting(frame, each)
            if mounting is not None:
                return mounting
        self.notes.append(
            f"no transform tells where {printable(frame or laser)} is on the robot: taken to be in "
            "its middle; else give --laser-pose x,y,heading"
        )
        return Mounting()

    def _read(
        self, connections: list[Any], known: Mapping[str, object] | None = None
    ) -> Iterator[tuple[Any, float, Any]]:
        """Yield connection, time [s] and message, but no damaged ones, nor of `known` topics."""
        messages = self._storage.messages(connections) if connections else iter(())
        for connection, nanoseconds, raw in messages:
            if known is not None and connection.topic in known:
                continue
            try:
                message = self._read_as(raw, USED[connection.msgtype])
            except self._faults:
                self._damaged += 1
                continue
            yield connection, nanoseconds * NANO, message

    @contextmanager
    def _damage_told(self) -> Iterator[None]:
        try:
            yield
        except ConfigError:
            raise
        except self._faults as error:
            reason = one_line(error).rstrip(".") or type(error).__name__
            problem = (
                f" is {self.name} that cannot be read: {reason}; `{self._mended_by}` may mend it"
            )
            raise wrong(self._path, problem) from None


def _faults(path: Path) -> tuple[type[Exception], ...]:
    """Return all that the library raises about damaged files."""
    try:
        import rosbags.rosbag1
        import rosbags.rosbag2
        import rosbags.serde
        from apsw import Error
    except ImportError:
        raise wrong(path, f" is a rosbag: {how_to_get('nav')}") from None
    return (
        *(rosbags.rosbag1.ReaderError, rosbags.rosbag2.ReaderError, rosbags.serde.SerdeError),
        *(ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, MemoryError),
        *(OSError, RuntimeError, TypeError, ValueError, struct.error, Error),
    )


def _storage(path: Path, bag_format: BagFormat, *, cut: bool) -> Any:
    """Return the reader of a format, whatever the name of the file is."""
    import rosbags.rosbag1
    import rosbags.rosbag2

    if bag_format is ROS_1:
        return rosbags.rosbag1.Reader(path)
    place: Any = CutMcapPath(path) if cut else path
    storage: Any = rosbags.rosbag2.Reader.STORAGE_PLUGINS[bag_format.storage](place)
    if cut:
        storage.messages = storage.messages_scan  # the other one refuses a wrong order
    return storage


def _types(*, ros_1: bool) -> Callable[[bytes, str], Any]:
    """Return the function that reads messages of the types that are used.

    They have been the same in all distributions, so what a bag says of them is not needed.
    """
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if ros_1 else Stores.ROS2_JAZZY)
    if ros_1:
        field = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(field, TRANSFORMS))
        return store.deserialize_ros1
    return store.deserialize_cdr


def _listed(connections: Iterable[Any]) -> str:
    """Return the topics of a bag, for an error."""
    topics = sorted({f"{each.topic} ({each.msgtype.replace('/msg', '')})" for each in connections})
    more = f" and {len(topics) - MOST_TOPICS} more" if len(topics) > MOST_TOPICS else ""
    shown = printable(", ".join(topics[:MOST_TOPICS]))
    return f"its topics are {shown}{more}" if topics else "it has no topics"


def _moved(message: Any, time: float, edge: FramePair | None) -> Iterator[LoggedOdometry]:
    """Yield the odometry in a message: of its own type, or the transforms of an edge."""
    if edge is None:
        at = message.pose.pose
        told = [(message.header, at.position, at.orientation)]
    else:
        moves = (each for each in message.transforms if _pair(each) == edge)
        told = [(m.header, m.transform.translation, m.transform.rotation) for m in moves]
    for header, place, rotation in told:
        pose = pose_of(place, rotation)
        if pose is not None:
            yield LoggedOdometry(_stamp(header, time), pose)


def _pair(transform: Any) -> FramePair:
    return FramePair(frame_name(transform.header.frame_id), frame_name(transform.child_frame_id))


def _scan(message: Any, time: float, number: int, mounting: Mounting) -> Scan | None:
    """Return a scan without its odometry, or `None` if its directions mean nothing."""
    count, begin, step = len(message.ranges), message.angle_min, message.angle_increment
    if count < FEWEST or not isfinite(begin + step):
        return None
    step = step or (message.angle_max - begin) / (count - 1)
    if not 0 < abs(step) * (count - 1) < MOST_TURNED:
        return None
    far = message.range_max if 0 < message.range_max < FARTHEST else FARTHEST
    ranges = _ranges(message.ranges, message.range_min, far)
    stamp, beam_time = _stamp(message.header, time), float(message.time_increment)
    if not 0 < beam_time * (count - 1) < LONGEST_SCAN:
        beam_time = 0.0
    if step < 0:
        # readings go counter-clockwise; what was measured last is then the first of them
        begin, step = begin + step * (count - 1), -step
        stamp, beam_time = stamp + beam_time * (count - 1), -beam_time
        ranges.reverse()
    scan = Scan(
        stamp=stamp,
        sequence=number,
        robot_in_odom=ORIGIN,
        sensor_in_robot=ORIGIN,
        angles=tuple(begin + step * each for each in range(count)),
        ranges=tuple(ranges),
        beam_time=beam_time,
        near=max(0.0, message.range_min) if isfinite(message.range_min) else 0.0,
        far=far,
    )
    return mounted(scan, mounting)


def _ranges(readings: Sequence[Any], near: float, far: float) -> list[float]:
    """Return ranges as in REP 117; of several echoes the nearest counts."""
    if hasattr(readings[0], "echoes"):
        readings = [each.echoes[0] if len(each.echoes) else inf for each in readings]
    with np.errstate(invalid="ignore"):  # damaged bytes may be NaN of the signalling kind
        metres = np.asarray(readings, dtype=np.float64)
    metres[metres >= far - AT_LIMIT] = inf
    metres[(metres <= 0) | (metres < near)] = -inf
    ranges: list[float] = metres.tolist()
    return ranges


def _stamp(header: Any, time: float) -> float:
    """Return the time in a header [s]; where it has none, that of the message in the bag."""
    stamp = header.stamp.sec + header.stamp.nanosec * NANO
    return stamp if stamp > 0 else time
