"""Any time of a log is found by its index, as it is by reading all of it."""

from pathlib import Path
from random import Random

import pytest
from mcap.writer import Writer

from pioneer3.errors import ConfigError
from pioneer3.log import chunks
from pioneer3.log.excerpt import write_excerpt
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import LogMessage, open_log
from tests.unit.web.replay.logs import BEGAN, SECOND, drive
from tests.unit.web.replay.test_recorded import HALL


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a log of a drive."""
    return drive(tmp_path_factory.mktemp("logs") / "drive.mcap")


def cut(path: Path, to: Path, size: int) -> Path:
    """Write the first bytes of a file to another."""
    to.write_bytes(path.read_bytes()[:size])
    return to


def all_of(path: Path) -> list[LogMessage]:
    return list(open_log(path).messages())


def assert_finds_all(path: Path) -> None:
    """Compare with a reader of the whole file, at a hundred times."""
    index, known, random = LogIndex(path), all_of(path), Random(1)
    assert (index.began, index.ended) == (known[0].time, known[-1].time)
    assert index.topics == {each.topic for each in known}
    for _ in range(100):
        at = random.randint(index.began - SECOND, index.ended + SECOND)
        for topic in index.topics:
            before = [each for each in known if each.topic == topic and each.time <= at]
            assert index.newest(topic, at) == (before[-1] if before else None)
        begin = at - random.randint(0, 3 * SECOND)
        between = [each for each in known if begin < each.time <= at]
        assert index.between(begin, at, index.topics) == between


def test_a_time_is_found_as_by_reading_all(path: Path) -> None:
    assert_finds_all(path)


def test_so_it_is_in_an_excerpt_whose_chunks_overlap(path: Path, tmp_path: Path) -> None:
    part = tmp_path / "part.mcap"
    write_excerpt(LogIndex(path), part, BEGAN + 3 * SECOND, BEGAN + 15 * SECOND)
    assert_finds_all(part)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_so_it_is_without_the_end(path: Path, tmp_path: Path, share: float) -> None:
    assert_finds_all(cut(path, tmp_path / "cut.mcap", round(share * path.stat().st_size)))


def test_a_message_may_have_to_be_of_some_kind(path: Path) -> None:
    index = LogIndex(path)
    found = index.newest("decision", index.ended, lambda data: b"wander" in data)
    assert found is not None
    assert found.time == BEGAN + 7 * SECOND
    assert index.newest("decision", index.ended, lambda data: b"dance" in data) is None


def test_all_is_read_chunk_by_chunk(path: Path) -> None:
    shares, count = [], 0
    for share, found in LogIndex(path).chunks({"snapshot"}):
        shares.append(share)
        count += len(found)
    assert shares == sorted(shares)
    assert (shares[-1], count) == (1.0, 200)


def test_a_log_without_messages_is_refused(path: Path, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"empty\.mcap: no messages were logged"):
        LogIndex(cut(path, tmp_path / "empty.mcap", 300))


def test_a_damaged_log_is_an_error_and_no_crash(path: Path, tmp_path: Path) -> None:
    whole, random, bad = path.read_bytes(), Random(2), tmp_path / "bad.mcap"
    errors = []
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(random.choice((1, 1, 8))):
            at = random.choice((random.randrange(len(data)), len(data) - random.randrange(1, 3000)))
            data[at] = random.randrange(256)
        bad.write_bytes(data)
        try:
            read_all(bad)
        except ConfigError as error:
            errors.append(str(error))
    assert errors
    assert all(error.startswith(str(bad)) for error in errors)


def read_all(path: Path) -> None:
    """Read a log as a replay does."""
    index = LogIndex(path)
    for topic in index.topics:
        index.newest(topic, index.ended)
    for _ in index.chunks(index.topics):
        pass


def test_an_excerpt_begins_with_what_was_told_once(tmp_path: Path) -> None:
    whole = LogIndex(drive(tmp_path / "whole.mcap", line_map=HALL))
    begin = BEGAN + 11 * SECOND + SECOND // 2
    write_excerpt(whole, tmp_path / "part.mcap", begin, BEGAN + 15 * SECOND)
    part = LogIndex(tmp_path / "part.mcap")
    for topic in ("map", "estimate", "way"):
        before, now = whole.newest(topic, begin), part.newest(topic, begin)
        assert before is not None
        assert now is not None
        assert (now.data, now.time) == (before.data, begin)
    assert part.newest("decision", begin) is None


def test_more_chunks_than_fit_in_memory_are_refused(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chunks, "MOST_CHUNKS", 3)
    with pytest.raises(ConfigError, match="more than 3 chunks"):
        LogIndex(cut(path, tmp_path / "cut.mcap", path.stat().st_size - 1))


def test_a_chunk_that_lies_about_its_length_is_not_unpacked(tmp_path: Path) -> None:
    import zstandard

    packed = zstandard.ZstdCompressor().compress(bytes(10_000_000))
    for told in (0, 100, 10_000_001):
        head = chunks.CHUNK_HEAD.pack(0, 0, told, 0, 4) + b"zstd"
        with pytest.raises(ValueError, match="another length than it says"):
            list(chunks.unpacked(head + len(packed).to_bytes(8, "little") + packed))


def test_an_excerpt_of_a_topic_whose_schema_is_missing_has_its_messages(tmp_path: Path) -> None:
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("notes", "json", schema_id=5)
        writer.add_message(channel, BEGAN, b"{}", BEGAN)
        writer.finish()  # type: ignore[no-untyped-call]
    assert write_excerpt(LogIndex(tmp_path / "a.mcap"), tmp_path / "b.mcap", 0, 2 * BEGAN) == 1
    assert [each.data for each in all_of(tmp_path / "b.mcap")] == [b"{}"]
