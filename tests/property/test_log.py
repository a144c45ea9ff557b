"""Logs come back exactly, are read up to where they were cut, and damaged ones are refused."""

import resource
import struct
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from functools import cache
from math import inf, nan, sin
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import msgspec
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import Writer

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, Twist2
from pioneer3.links.tap import recorded_links
from pioneer3.log.chunks import DAMAGED, split, summary_groups
from pioneer3.log.command_line import started
from pioneer3.log.differences import best_step, differences, joined_planes, planes, sums
from pioneer3.log.excerpt import write_excerpt
from pioneer3.log.folder import create
from pioneer3.log.index import LogIndex
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import open_log
from pioneer3.log.rows import fields_of, pack_rows, unpack_rows
from pioneer3.log.scans import unpack_scan
from pioneer3.log.topics import EXACT, ROUGH, LogTopic, Pieces, decode, pack_pieces, unpack_pieces
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from pioneer3.state import Battery, Charging, Motors, Odometry, Scan, Snapshot, Sonar
from pioneer3.units import MM

NUMBERS = st.floats() | st.sampled_from([inf, -inf, nan, -0.0, 1e-300, 0.1 + 0.2])
POSES = st.builds(Pose2, NUMBERS, NUMBERS, NUMBERS)
TWISTS = st.builds(Twist2, NUMBERS, NUMBERS)
MILLIMETRES = st.integers(0, 40_000).map(lambda mm: mm * MM)
LENGTHS = st.integers(-40_000, 40_000).map(lambda mm: mm * MM) | NUMBERS
SNAPSHOTS = st.builds(
    Snapshot,
    stamp=NUMBERS | LENGTHS,
    sequence=st.integers(0, 2**62),
    odometry=st.builds(
        Odometry,
        robot_in_odom=POSES,
        twist=TWISTS,
        left_speed=NUMBERS,
        right_speed=NUMBERS,
        robot_in_encoder=POSES,
    ),
    battery=st.builds(
        Battery,
        voltage=NUMBERS,
        charge=st.none() | NUMBERS,
        charging=st.sampled_from(Charging),
        low=st.booleans(),
    ),
    motors=st.builds(Motors),
    sonar=st.builds(Sonar, ranges=st.lists(LENGTHS, min_size=3, max_size=4).map(tuple)),
    faults=st.lists(st.text(), max_size=3).map(tuple),
)
SCANS = st.builds(
    Scan,
    stamp=NUMBERS,
    sequence=st.integers(0, 2**62),
    robot_in_odom=POSES,
    sensor_in_robot=POSES,
    angles=st.lists(NUMBERS, max_size=20).map(tuple),
    ranges=st.lists(NUMBERS | MILLIMETRES | st.sampled_from([inf, -inf, nan]), max_size=20).map(
        tuple
    )
    | st.lists(MILLIMETRES | st.sampled_from([inf, -inf, nan]), max_size=20).map(tuple),
    reflectances=st.lists(st.integers(0, 2**20), max_size=5).map(tuple),
    laser=st.text(),
    echoes=st.lists(st.lists(NUMBERS, max_size=3).map(tuple), max_size=4).map(tuple),
    last_in_odom=st.none() | POSES,
)
DECISIONS = st.builds(
    DecisionMade,
    mode=st.text(),
    decision=st.builds(
        Decision,
        twist=TWISTS,
        until=NUMBERS,
        contributions=st.lists(
            st.builds(Contribution, st.text(), st.text(), NUMBERS, NUMBERS, st.text()), max_size=3
        ).map(tuple),
        limits=st.dictionaries(st.text(), NUMBERS, max_size=3),
    ),
    told=st.lists(st.text(), max_size=3).map(tuple),
)
COMMANDS = st.builds(CommandGiven, st.text(), st.text(), TWISTS, NUMBERS, st.text())


def exact(value: Any) -> Any:
    """Return a value that is equal only to one of the same bits: NaN to itself, -0.0 not to 0.0."""
    if is_dataclass(value):
        return [type(value).__name__, *(exact(getattr(value, each.name)) for each in fields(value))]
    if isinstance(value, dict):
        return {key: exact(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [exact(each) for each in value]
    return repr(value) if isinstance(value, float) else value


@given(SNAPSHOTS | DECISIONS | COMMANDS)
def test_a_message_comes_back_bit_for_bit(message: Any) -> None:
    topic = LogTopic("any", type(message))
    assert exact(decode(topic.encode(message), topic.kind)) == exact(message)


@given(
    st.lists(SNAPSHOTS, min_size=1, max_size=2) | st.lists(SCANS, min_size=1, max_size=2),
    st.lists(NUMBERS | LENGTHS, max_size=4),
    st.integers(-(2**40), 2**40),
)
def test_snapshots_and_scans_come_back_from_their_columns(
    some: list[Any], stamps: list[float], step: int
) -> None:
    told = [*some, *(replace(some[-1], stamp=stamp) for stamp in stamps)]
    topic = LogTopic("any", type(told[0]), steady="angles" * isinstance(told[0], Scan))
    times = [7 + number * step for number in range(len(told))]
    fields = fields_of(told)
    fields.pop(topic.steady, None)
    shape, data = pack_rows(times, fields)
    assert b"angles" not in shape
    found = list(unpack_rows(times[0], data, shape))
    assert [time for time, _ in found] == times
    for (_, row), message in zip(found, told, strict=True):
        part = topic.steady_part(message)
        assert exact(decode(row, topic.kind, topic.steady, part)) == exact(message)


def test_lists_of_lists_of_any_lengths_are_columns(tmp_path: Path) -> None:
    path, topic = tmp_path / "a.mcap", LogTopic("scan/laser", Scan, steady="angles")
    scans = [replace(SCAN, echoes=each) for each in (((1.0,), ()), ((2.0, 3.0), (4.0,)))]
    file = McapFile(create(path))
    file.add(topic, [(number, scan) for number, scan in enumerate(scans)])
    file.finish()
    assert [scan for _, scan in open_log(path).of(topic)] == scans


@given(st.data())
def test_damaged_columns_are_read_or_refused(data: st.DataObject) -> None:
    fields = fields_of([SCAN, replace(SCAN, stamp=2.5, sequence=4)])
    shape, packed = pack_rows([0, 1], fields)
    damaged = bytearray(packed)
    for _ in range(data.draw(st.integers(1, 3))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    with suppress(*DAMAGED):
        assert len([*unpack_rows(0, bytes(damaged), shape)]) < 2**16


@given(
    st.lists(st.tuples(st.integers(0, 2**40), st.binary(max_size=20)), min_size=1).map(sorted),
    st.sampled_from([1, 300]),
)
def test_pieces_come_back_with_the_time_of_each(some: list[tuple[int, bytes]], times: int) -> None:
    pieces = [(time, data * times) for time, data in some]  # many bytes are told by differences
    first = pieces[0][0]
    found = list(unpack_pieces(first, pack_pieces(pieces, ROUGH, best_step)))
    assert [data for _, data in found] == [data for _, data in pieces]
    assert all(0 <= was - at < ROUGH for (at, _), (was, _) in zip(found, pieces, strict=True))
    assert list(unpack_pieces(first, pack_pieces(pieces, EXACT, best_step))) == pieces


@given(st.binary(max_size=100), st.integers(1, 5))
def test_bytes_come_back_from_their_differences_and_planes(data: bytes, step: int) -> None:
    assert sums(differences(data, step), step) == data
    assert joined_planes(planes(data, step), step) == data


def test_readings_that_are_alike_are_told_by_differences_and_take_less_room() -> None:
    noise = Random(1)
    readings = [round(2000 + 500 * sin(n / 30) + noise.gauss(0, 5)) for n in range(2000)]
    data = b"".join(reading.to_bytes(2, "little") for reading in readings)
    told = pack_pieces([(0, data)], EXACT, best_step)
    assert msgspec.msgpack.decode(told, type=Pieces).step == 2
    plain = msgspec.msgpack.encode(([0], [len(data)], data))
    assert len(zstandard.compress(told)) < 0.7 * len(zstandard.compress(plain))


SCAN = Scan(
    stamp=1.5,
    sequence=3,
    robot_in_odom=Pose2(1.0, 2.0, 0.5),
    sensor_in_robot=Pose2(),
    angles=(-0.1, 0.0, 0.1),
    ranges=(1.234, inf, 3.21),
)


def test_messages_of_older_logs_are_read() -> None:
    pieces = msgspec.msgpack.encode(([0, 1500], [2, 1], b"abc"))
    assert list(unpack_pieces(7, pieces)) == [(7, b"ab"), (1_500_007, b"c")]
    readings = b"".join(bytes([number, 0]) * 2 for number in range(100, 105))
    told = Pieces([0], [len(readings)], differences(readings, 2), 2)
    assert list(unpack_pieces(7, msgspec.msgpack.encode(told))) == [(7, readings)]
    scan = {name: values[0] for name, values in fields_of([SCAN]).items() if name != "angles"}
    assert unpack_scan(msgspec.msgpack.encode(scan), SCAN.angles) == SCAN
    ranges = scan["ranges"]
    assert isinstance(ranges, bytes)
    scan |= {"ranges": differences(ranges, 2), "step": 2}
    assert unpack_scan(msgspec.msgpack.encode(scan), SCAN.angles) == SCAN


WIRE = LogTopic("wire/robot/in", bytes)
CHUNKS = 12


@cache
def a_log() -> tuple[bytes, tuple[int, ...]]:
    """Return a log of a few chunks of three messages, and where each chunk was flushed."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        file, flushed = McapFile(create(path)), []
        file.add_metadata("program", {"command": "drive"})
        for number in range(CHUNKS):
            file.add(WIRE, [(number * 10**6, bytes([number, part]) * 20) for part in range(3)])
            file.add(LogTopic("command", CommandGiven), [(number, CommandGiven("a", "b"))] * 3)
            file.flush()
            flushed.append(file.size)
        file.add_metadata("end", {"why": "done"})
        file.finish()
        return path.read_bytes(), tuple(flushed)


def read(data: bytes) -> list[bytes]:
    """Return the bytes in a log, after asking it for all that can be asked."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        path.write_bytes(data)
        log = open_log(path)
        log.info()
        recorded_links(path)
        [*log.of(LogTopic("command", CommandGiven))]
        return [each.data for each in log.messages(WIRE.name.__eq__)]


WHOLE = [bytes([number, part]) * 20 for number in range(CHUNKS) for part in range(3)]


@given(st.data())
def test_a_file_that_is_cut_at_any_byte_has_all_that_was_flushed_before(
    data: st.DataObject,
) -> None:
    log, flushed = a_log()
    size = data.draw(st.integers(8, len(log)))
    kept = read(log[:size])
    assert kept == WHOLE[: len(kept)]
    # of the last chunk its message index may be missing, its messages not
    assert len(kept) >= 3 * sum(end <= size for end in flushed)


def test_a_small_file_is_read_up_to_each_byte_that_it_may_be_cut_at(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    file = McapFile(create(path))
    flushed = []
    for number in range(2):
        file.add(WIRE, [(number, bytes([number]))])
        file.flush()
        flushed.append(file.size)
    file.finish()
    whole = path.read_bytes()
    for size in range(8, len(whole) + 1):
        path.write_bytes(whole[:size])
        kept = [each.data for each in open_log(path).messages()]
        assert kept == [bytes([number]) for number in range(len(kept))]
        assert len(kept) >= sum(end <= size for end in flushed)
        assert open_log(path).info().size == size


def test_a_whole_file_is_whole() -> None:
    assert read(a_log()[0]) == WHOLE


@given(st.data())
def test_a_hostile_file_is_read_or_refused(data: st.DataObject) -> None:
    log = bytearray(a_log()[0])
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(8, len(log) - 1))
        part = data.draw(st.binary(min_size=1, max_size=9) | st.just(b"\xff" * 8))
        log[at : at + len(part)] = part
    with suppress(ConfigError):
        read(bytes(log))


@given(st.binary(max_size=200))
def test_what_is_no_log_is_refused(data: bytes) -> None:
    with pytest.raises(ConfigError, match="is no log"):
        read(b"\x89MCAP1\r\n" + data)


@pytest.mark.parametrize("claimed", [10, 2**40])
def test_a_chunk_that_would_unpack_to_a_gigabyte_is_not_unpacked(claimed: int) -> None:
    packer = zstandard.ZstdCompressor(level=1).compressobj(size=-1)
    packed = b"".join([packer.compress(bytes(2**20)) for _ in range(1024)]) + packer.flush()
    content = struct.pack("<QQQII4sQ", 0, 0, claimed, 0, 4, b"zstd", len(packed)) + packed
    bomb = b"\x89MCAP0\r\n" + struct.pack("<BQ", 6, len(content)) + content
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with suppress(ConfigError):
        assert read(bomb) == []
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # KiB


def rows_of(value: str, count: int) -> bytes:
    """Return so many rows of a value as a message."""
    return msgspec.msgpack.encode([[1] * (count - 1), [[0, value]]])


@pytest.mark.parametrize(
    ("told", "data"),
    [
        ({"columns": '{"a":0}'}, rows_of("x" * 900_000, 20_000)),
        ({"pieces": ""}, msgspec.msgpack.encode(([0] * 300_000, [0] * 300_000, b""))),
    ],
)
def test_a_message_that_would_become_a_gigabyte_is_refused_also_in_an_excerpt(
    told: dict[str, str], data: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("snapshot", "msgpack", 0, told)
        writer.add_message(channel, 7, data, 7)
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(ConfigError, match="is damaged: messages of more than 67108864 bytes"):
        [*open_log(path).messages()]
    index = LogIndex(path)
    with pytest.raises(ConfigError, match="is damaged: messages of more than 67108864 bytes"):
        write_excerpt(index, tmp_path / "part.mcap", 7, 7)


def test_messages_without_chunks_are_found_as_all_others(tmp_path: Path) -> None:
    path, times = tmp_path / "a.mcap", range(5, 5000, 5)
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        channels = [writer.register_channel(name, "json", 0) for name in ("first", "second")]
        for number, time in enumerate(times):
            writer.add_message(channels[number % 2], time, b"x" * 3000, time)
        writer.finish()  # type: ignore[no-untyped-call]
    assert [each.time for each in open_log(path).messages()] == [*times]
    index = LogIndex(path)
    assert index.topics == {"first", "second"}
    for at in (4, 5, 2503, 9000):
        for number, topic in enumerate(("first", "second")):
            before = [time for time in times[number::2] if time <= at]
            newest = index.newest(topic, at)
            assert (newest and newest.time) == (before[-1] if before else None)


def test_an_index_that_names_a_chunk_again_and_again_is_not_believed(tmp_path: Path) -> None:
    log = tmp_path / "a.mcap"
    log.write_bytes(a_log()[0])
    with log.open("rb") as file:
        groups = summary_groups(file, log.stat().st_size, {8})
        index = [content for _, group in groups for _, content in split(group)]
    assert len(index) == CHUNKS
    spoilt = a_log()[0]
    for content in index[1:]:
        spoilt = spoilt.replace(content, index[0].ljust(len(content))[: len(content)])
    assert read(spoilt) == WHOLE


SECRETS = st.text("abcXYZ019", min_size=9)


@given(SECRETS)
def test_no_secret_of_a_command_line_is_written(secret: str) -> None:
    for arguments in (
        ["--camera", f"http://user:{secret}@cam/video"],
        ["--camera", f"http://cam/video?size=1&access_token={secret}"],
        [f"--camera=rtsp://{secret}@cam"],
        ["--password", secret],
        [f"--api-key={secret}"],
        ["_password:=x", "--token", secret],
        ["--camera", f"rtsp://user:a/{secret}@cam/video"],
        ["--camera", f"rtsp://user:a@{secret}@cam/video"],
        ["--camera", f"rtsp://user:a b {secret}@cam/video"],
        ["--camera", f"http://cam/image.cgi?loginuse=u&loginpas={secret}"],
        ["--camera", f"rtsp://cam/user=u_password={secret}_stream=0.sdp"],
        [f"_password:={secret}"],
        [f"--camera=http://cam/?pw={secret}"],
    ):
        title, command = started(["/usr/bin/pioneer3", "drive", *arguments])
        assert secret not in command
        assert "***" in command
        assert title == "drive"
