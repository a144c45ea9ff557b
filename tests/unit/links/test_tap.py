"""What is recorded can be played back, byte for byte and at the same pace."""

import asyncio
import re
from collections import deque
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from pioneer3 import __version__
from pioneer3.errors import ConfigError, PortNotFoundError, RecordingOverError
from pioneer3.links import Link, open_link, opener
from pioneer3.links.memory import null_modem
from pioneer3.links.tap import (
    FROM_HOST,
    FROM_ROBOT,
    Chunk,
    Replay,
    TapLink,
    WireRecording,
    read_recording,
    recorded,
)
from tests.support import disk_of


async def test_a_recording_plays_back_what_the_robot_said_when_it_said_it(tmp_path: Path) -> None:
    clock = asyncio.get_running_loop().time
    path = tmp_path / "wire.txt"
    with path.open("w") as file:
        ours, theirs = null_modem(speeds=(9600,))
        tap = TapLink(ours, WireRecording(file, clock))
        assert (tap.url, tap.speeds) == (ours.url, (9600,))
        await tap.set_speed(38400)
        assert ours.speed == 38400
        theirs.speed = 38400
        await tap.write(b"hello")
        assert await theirs.read() == b"hello"
        for pause, data in ((1.0, b"\x01\x02"), (2.5, b"\xff")):
            await asyncio.sleep(pause)
            await theirs.write(data)
            assert await tap.read() == data
        await theirs.close()
        assert await tap.read() == b""
        await tap.close()
    assert list(read_recording(path)) == [
        Chunk(0.0, FROM_HOST, b"hello"),
        Chunk(1.0, FROM_ROBOT, b"\x01\x02"),
        Chunk(3.5, FROM_ROBOT, b"\xff"),
    ]
    replay, began = await open_link(f"replay:{path}"), clock()
    await replay.set_speed(9600)
    await replay.write(b"anything starts the clock")
    await replay.write(b"nobody listens")
    assert (await replay.read(), clock() - began) == (b"\x01\x02", 0.0)
    assert (await replay.read(), clock() - began) == (b"\xff", 2.5)
    with pytest.raises(RecordingOverError, match="the recording is over"):
        await replay.read()
    await replay.close()


async def test_a_recording_goes_on_over_links_and_does_not_begin_anew(tmp_path: Path) -> None:
    path = tmp_path / "wire.txt"
    path.write_text("1 S>C 1 01\n2 S>C 1 02\n4 S>C 1 03\n")
    clock = asyncio.get_running_loop().time
    open_ = opener(f"replay:{path}")
    first = await open_()
    await first.write(b"x")
    assert await first.read() == b"\1"
    await first.close()
    assert await first.read() == b""
    second, began = await open_(), clock()
    await second.write(b"x")
    assert (await second.read(), clock() - began) == (b"\2", 1.0)
    assert (await second.read(), clock() - began) == (b"\3", 3.0)
    for link in (second, await open_()):
        await link.write(b"x")
        with pytest.raises(RecordingOverError):
            await link.read()


async def test_in_an_older_file_each_connection_begins_at_zero(tmp_path: Path) -> None:
    path = tmp_path / "wire.txt"
    path.write_text("# tcp\n0 C>S 1 00\n1 S>C 1 01\n# tcp\n0 C>S 1 00\n0.5 S>C 1 02\n")
    clock = asyncio.get_running_loop().time
    link = await opener(f"replay:{path}")()
    await link.write(b"x")
    assert (await link.read(), clock()) == (b"\1", 0.0)
    assert (await link.read(), clock()) == (b"\2", 0.5)


async def test_a_recording_says_when_it_began_and_counts_from_there(tmp_path: Path) -> None:
    path, clock = tmp_path / "wire.txt", asyncio.get_running_loop().time
    ends = []

    async def open_() -> Link:
        ours, theirs = null_modem()
        ends.append(theirs)
        return ours

    before = datetime.now(UTC)
    with recorded(open_, path, clock) as recorder:
        for pause in (1.0, 2.0):
            await asyncio.sleep(pause)
            link = await recorder.open()
            await link.write(b"x")
            await link.close()
    heading, *lines = path.read_text().splitlines()
    found = re.fullmatch(rf"# pioneer3 {re.escape(__version__)}, (\S+Z)", heading)
    assert found is not None
    assert abs(datetime.fromisoformat(found[1]) - before) < timedelta(minutes=1)
    assert [chunk.time for chunk in read_recording(path)] == [1.0, 3.0]
    assert len(lines) == 4


async def test_closing_a_replay_ends_a_read_that_waits(tmp_path: Path) -> None:
    path = tmp_path / "wire.txt"
    path.write_text("0 S>C 1 00\n99 S>C 1 01\n")
    for started in (False, True):
        replay = await Replay(path).open()
        if started:
            await replay.write(b"x")
            assert await replay.read() == b"\0"
        reading = asyncio.ensure_future(replay.read())
        await asyncio.sleep(1)
        await replay.close()
        assert await reading == b""


async def test_a_full_disk_ends_the_recording_and_not_the_drive(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "wire.txt"
    links = deque(null_modem() for _ in range(2))

    async def open_() -> Link:
        return links[0][0]

    with disk_of(200), recorded(open_, path, asyncio.get_running_loop().time) as recorder:
        while links:
            link = await recorder.open()
            _, theirs = links.popleft()
            for _ in range(9):
                await link.write(b"stop")
                assert await theirs.read() == b"stop"
                await theirs.write(b"report")
                assert await link.read() == b"report"
            recorder.remark("it goes on")
            assert [record.message for record in caplog.records] == [
                f"{path}: the recording has ended, and nothing else: File too large"
            ]
            await link.close()
    assert path.stat().st_size == 200


def test_comments_and_empty_lines_are_skipped(tmp_path: Path) -> None:
    (tmp_path / "w").write_text("# a comment\n\n0.5 C>S 2 0aFF\n")
    assert list(read_recording(tmp_path / "w")) == [Chunk(0.5, FROM_HOST, b"\x0a\xff")]


@pytest.mark.parametrize(
    "line",
    ["x", "0 S>C 1", "0 S>C 1 00 00", "0 S>C x 00", "t S>C 1 00", "0 S<C 1 00", "0 S>C 2 00"],
)
def test_a_wrong_line_is_named(tmp_path: Path, line: str) -> None:
    (tmp_path / "w").write_text(f"# one\n{line}\n")
    with pytest.raises(ConfigError, match=":2: "):
        list(read_recording(tmp_path / "w"))


def test_a_missing_recording_is_named(tmp_path: Path) -> None:
    with pytest.raises(PortNotFoundError, match="no such recording"):
        list(read_recording(tmp_path / "none"))
