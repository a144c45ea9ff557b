"""Bags while they are written, by rosbags: a file of ROS 1, a folder with MCAP of ROS 2."""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, Final

from pioneer3.ros.bag.types import BagTypes, Ros1BagTypes, Ros2BagTypes
from pioneer3.ros.node.middleware import QUEUE
from pioneer3.ros.typestore import full_name

METADATA: Final = 8
"""Version of `metadata.yaml`: the newest one that Humble reads, too."""
FOREVER: Final = (9_223_372_036, 854_775_807)
"""No limit of a time in a quality of service: seconds, nanoseconds."""
Write = Callable[[int, bytes], None]
"""Adds a message of a time [ns since 1970], serialized."""


class OpenBag:
    """A bag that is open; it counts its messages so far, by topic."""

    def __init__(self, writer: Any, types: BagTypes) -> None:
        self._writer, self.types = writer, types
        self.counts: Counter[str] = Counter()
        self._known: dict[str, Write] = {}

    def connect(self, topic: str, type_name: str, node: str, *, latched: bool) -> Write:
        """Return the function that adds messages of a topic that this node publishes.

        In a bag of ROS 2 it is the same for all nodes.
        """
        if topic in self._known:
            return self._known[topic]
        text, known_by = self.types.described(type_name)
        add = partial(self._writer.add_connection, topic, full_name(type_name), msgdef=text)
        if isinstance(self.types, Ros1BagTypes):
            connection = add(md5sum=known_by, callerid=node, latching=int(latched))
            return _counted(partial(self._writer.write, connection), self.counts, topic)
        connection = add(rihs01=known_by, offered_qos_profiles=[_quality(latched=latched)])
        write = _counted(partial(self._writer.write, connection), self.counts, topic)
        return self._known.setdefault(topic, write)


def _counted(write: Write, counts: Counter[str], topic: str) -> Write:
    def add(time: int, data: bytes) -> None:
        write(time, data)
        counts[topic] += 1

    return add


@contextmanager
def ros1_bag(path: Path) -> Iterator[OpenBag]:
    """Write a new `.bag` file in the block; ConfigError without rosbags."""
    types = Ros1BagTypes()
    from lz4.frame import compress
    from rosbags.rosbag1 import Writer
    from rosbags.rosbag1.writer import WriteChunk

    class BoundedWriter(Writer):
        """Keeps how many messages of a topic are in each chunk, not the place of each."""

        def write_chunk(self, chunk: WriteChunk) -> None:
            super().write_chunk(chunk)
            for topic, places in chunk.connections.items():
                chunk.connections[topic] = range(len(places))  # type: ignore[assignment]

    writer = BoundedWriter(path)
    writer.set_compression(Writer.CompressionFormat.LZ4)
    # ROS 1's own tools read no other kind of frames than these
    writer.compressor = partial(
        compress, block_linked=False, store_size=False, content_checksum=True
    )
    with writer:
        yield OpenBag(writer, types)


@contextmanager
def ros2_bag(path: Path) -> Iterator[OpenBag]:
    """Write a new folder with MCAP and its metadata in the block; ConfigError without rosbags."""
    types = Ros2BagTypes()
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    writer = Writer(path, version=METADATA, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        yield OpenBag(writer, types)


def _quality(*, latched: bool) -> Any:
    """Return the quality of service that our publishers offer."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    forever = QosTime(*FOREVER)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else QUEUE,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=forever,
        lifespan=forever,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=forever,
        avoid_ros_namespace_conventions=False,
    )
