"""Hostile logs are converted or refused by a sentence, and nothing half stays."""

from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from pioneer3.errors import ConfigError, PioneerError
from pioneer3.log.reader import open_log
from pioneer3.log.tables import MOST_TABLES, TableKind, write_tables
from pioneer3.navigation.recording import KINDS, MapUsed
from pioneer3.ros.bag.convert import BagKind, write_bag
from pioneer3.ros.bag.robots import MOST_ROBOTS
from pioneer3.ros.node.names import Profile
from pioneer3.runtime.recording import CommandGiven
from tests.combinations import examples
from tests.logs import drive, snapshot, write_log

MAP = "2D-Map\nLineMinPos: 0 0\nLineMaxPos: 2000 1000\nNumLines: 1\nLINES\n0 0 2000 0\n"
BAGS = ((BagKind.ROS2, Profile.ROS2), (BagKind.ROS1, Profile.BOTH))
NUMBERS = st.sampled_from([0, -1, 2**40, 2**70, 0.5, -1e308, 1e308, "inf", "-inf", "nan", None])
VALUES = st.recursive(
    NUMBERS | st.booleans() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=10,
)


@cache
def plain_log() -> bytes:
    """Return a log whose messages lie as they are, so that any of their bytes can be another."""
    office = MapUsed(name="office", file="", sha256="", text=MAP)
    messages = [(0.0, "map", office), *drive(1, lasers=["laser"]), (0.5, "wire/robot/in", b"abc")]
    with TemporaryDirectory() as folder:
        packed = write_log(Path(folder) / "a.mcap", messages).read_bytes()
    reader, out = make_reader(BytesIO(packed)), BytesIO()
    writer = Writer(out, compression=CompressionType.NONE, enable_crcs=False)
    writer.start("pioneer3")
    for texts in reader.iter_metadata():
        writer.add_metadata(texts.name, texts.metadata)
    channels: dict[int, int] = {}
    for _, channel, message in reader.iter_messages():
        if channel.id not in channels:
            channels[channel.id] = writer.register_channel(
                channel.topic, channel.message_encoding, 0, channel.metadata
            )
        writer.add_message(
            channels[channel.id], message.log_time, message.data, message.publish_time
        )
    writer.finish()  # type: ignore[no-untyped-call]
    return out.getvalue()


@cache
def plain_fields(topic: str) -> dict[str, object]:
    """Return the first message of a topic in that log."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        path.write_bytes(plain_log())
        message = next(open_log(path).messages(topic.__eq__))
        return msgspec.json.decode(message.data, type=dict[str, object])


def problems(data: bytes) -> list[str]:
    """Convert a log to all kinds; return the sentences of those that were refused."""
    told = []
    for kind in (None, *BAGS):
        with TemporaryDirectory() as name:
            path, made = Path(name) / "a.mcap", Path(name) / "made"
            path.write_bytes(data)
            try:
                if kind is None:
                    write_tables(open_log(path), made, TableKind.CSV)
                else:
                    write_bag(open_log(path), made, *kind)
            except PioneerError as error:
                told.append(str(error))
            there = {each.name for each in Path(name).iterdir()}
            assert there == {"a.mcap"} | ({"made"} if made.exists() else set())
    return told


@settings(max_examples=examples(40))
@given(
    places=st.lists(st.tuples(st.integers(0, 2**20), st.binary(max_size=9)), min_size=1, max_size=5)
)
def test_bytes_that_are_others_end_with_a_sentence_at_worst(
    places: list[tuple[int, bytes]],
) -> None:
    data = bytearray(plain_log())
    for place, others in places:
        at = place % len(data)
        data[at : at + len(others)] = others
    assert all(problem.isprintable() for problem in problems(bytes(data)))


def test_a_bag_of_too_many_robots_is_refused_before_the_work(tmp_path: Path) -> None:
    many = [(0.0, f"r{number}/snapshot", snapshot(0.0)) for number in range(MOST_ROBOTS + 1)]
    log = open_log(write_log(tmp_path / "a.mcap", many))
    with pytest.raises(ConfigError, match="more than 256 robots"):
        write_bag(log, tmp_path / "made", *BAGS[0])
    assert not (tmp_path / "made").exists()


def test_tables_of_too_many_topics_are_refused_before_the_work(tmp_path: Path) -> None:
    many = [
        (0.0, f"r{number}/command", CommandGiven("a", "b")) for number in range(MOST_TABLES + 1)
    ]
    log = open_log(write_log(tmp_path / "a.mcap", many))
    with pytest.raises(ConfigError, match="more than 900 topics"):
        write_tables(log, tmp_path / "made", TableKind.CSV)
    assert not (tmp_path / "made").exists()


@settings(max_examples=examples(40))
@given(
    topic=st.sampled_from(["snapshot", "command", "estimate", "way", "map", "../x", "a/snapshot"]),
    value=VALUES,
    number=st.none() | st.integers(0, 20),
)
def test_messages_of_any_content_end_with_a_sentence_at_worst(
    topic: str, value: object, number: int | None
) -> None:
    like = topic if topic in KINDS else "snapshot"
    fields = plain_fields(like)
    if number is not None:
        value = fields | {[*fields][number % len(fields)]: value}
    made = BytesIO()
    writer = Writer(made, compression=CompressionType.NONE)
    writer.start("pioneer3")
    for texts in make_reader(BytesIO(plain_log())).iter_metadata():
        writer.add_metadata(texts.name, texts.metadata)
    channel = writer.register_channel(topic, "json", 0)
    writer.add_message(channel, 0, msgspec.json.encode(value), 0)
    writer.finish()  # type: ignore[no-untyped-call]
    assert all(problem.isprintable() for problem in problems(made.getvalue()))
