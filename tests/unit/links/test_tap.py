"""What is recorded can be played back, byte for byte and at the same pace."""

import asyncio
import re
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError, PortNotFoundError, RecordingOverError
from pioneer3.links import open_link, opener
from pioneer3.links.memory import null_modem
from pioneer3.links.tap import (
    FROM_HOST,
    FROM_ROBOT,
    Chunk,
    Replay,
    TapLink,
    WireRecording,
    read_recording,
)
from pioneer3.log.folder import create
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import open_log
from pioneer3.log.topics import END, EVENT, GOES_ON, PROGRAM, LogTopic
from pioneer3.log.writer import named_log
from tests.support import disk_of


async def test_a_recording_plays_back_what_the_robot_said_when_it_said_it(tmp_path: Path) -> None:
    clock = asyncio.get_running_loop().time
    path = tmp_path / "wire.mcap"
    log = named_log(path, clock)
    ours, theirs = null_modem(speeds=(9600,))
    ours.url = "tcp://user:word@host?token=1"
    tap = TapLink(ours, WireRecording(log))
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
    log.close("done")
    assert list(read_recording(path)) == [
        Chunk(0.0, FROM_HOST, b"hello"),
        Chunk(1.0, FROM_ROBOT, b"\x01\x02"),
        Chunk(3.5, FROM_ROBOT, b"\xff"),
    ]
    events = [event for _, event in open_log(path).of(EVENT)]
    assert [event.text for event in events if event.kind == "link"] == [
        "robot: open: tcp://***@host?token=***",
        "robot: 38400 baud",
        "robot: closed",
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


async def test_of_a_recording_with_several_links_one_is_named(tmp_path: Path) -> None:
    path = tmp_path / "wire.mcap"
    log = named_log(path, asyncio.get_running_loop().time)
    for name in ("bob/robot", "bob/laser"):
        WireRecording(log, name).note(FROM_ROBOT, name.encode())
    log.close("done")
    for name in ("bob/robot", "bob/laser"):
        link = await open_link(f"replay:{path}#{name}")
        await link.write(b"x")
        assert await link.read() == name.encode()
    there = f"no bytes of the link 'robot'; there are: replay:{path}#bob/laser, replay:{path}#bob/r"
    with pytest.raises(ConfigError, match=re.escape(there)):
        opener(f"replay:{path}")


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


async def test_a_recording_in_several_files_is_one_whichever_is_named(tmp_path: Path) -> None:
    sent = [bytes([number]) * 400 for number in range(9)]
    told = {"command": "pioneer3 run", "began_ns": str(10**18)}
    files = []
    for number in range(3):
        files.append(tmp_path / f"{number}.mcap")
        file = McapFile(create(files[-1]))
        file.add_metadata(PROGRAM, told)
        begin = 10**18 + number * 10**10
        part = sent[number * 3 :][:3]
        file.add(LogTopic("wire/robot/in", bytes), [(begin + n, d) for n, d in enumerate(part)])
        file.add_metadata(END, {"why": GOES_ON if number < 2 else "done"})
        file.finish()
    for path in files:
        assert [chunk.data for chunk in read_recording(path)] == sent
        link = await opener(f"replay:{path}")()
        await link.write(b"x")
        assert [await link.read() for _ in sent] == sent
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
    path = tmp_path / "wire.mcap"
    with disk_of(200):
        log = named_log(path, asyncio.get_running_loop().time)
        ours, theirs = null_modem()
        link = TapLink(ours, WireRecording(log))
        for _ in range(9):
            await link.write(b"stop")
            assert await theirs.read() == b"stop"
            await theirs.write(b"report")
            assert await link.read() == b"report"
        log.close("done")
        await link.write(b"stop")
        assert await theirs.read() == b"stop"
    assert [record.message for record in caplog.records] == [
        f"{path}: the recording has ended, and nothing else: File too large"
    ]


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
