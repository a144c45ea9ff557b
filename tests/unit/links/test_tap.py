"""What is recorded can be played back, byte for byte and at the same pace."""

import asyncio
import io
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.links import open_link
from pioneer3.links.memory import null_modem
from pioneer3.links.tap import FROM_HOST, FROM_ROBOT, Chunk, ReplayLink, TapLink, read_recording


async def test_a_recording_plays_back_what_the_robot_said_when_it_said_it(tmp_path: Path) -> None:
    clock = asyncio.get_running_loop().time
    path = tmp_path / "wire.txt"
    with path.open("w") as file:
        ours, theirs = null_modem(speeds=(9600,))
        tap = TapLink(ours, file, clock)
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
    assert await replay.read() == b""
    await replay.close()


async def test_closing_a_replay_ends_a_read_that_waits(tmp_path: Path) -> None:
    path = tmp_path / "wire.txt"
    path.write_text("0 S>C 1 00\n99 S>C 1 01\n")
    for started in (False, True):
        replay = ReplayLink(path)
        if started:
            await replay.write(b"x")
            assert await replay.read() == b"\0"
        reading = asyncio.ensure_future(replay.read())
        await asyncio.sleep(1)
        await replay.close()
        assert await reading == b""


class FullDisk(io.StringIO):
    """Takes the heading, and nothing more."""

    name = "wire.txt"

    def write(self, text: str) -> int:
        if text.startswith("#"):
            return len(text)
        raise OSError(28, "No space left on device")


async def test_a_full_disk_ends_the_recording_and_not_the_drive(
    caplog: pytest.LogCaptureFixture,
) -> None:
    ours, theirs = null_modem()
    tap = TapLink(ours, FullDisk(), asyncio.get_running_loop().time)
    for _ in range(3):
        await tap.write(b"stop")
        assert await theirs.read() == b"stop"
        await theirs.write(b"report")
        assert await tap.read() == b"report"
    await tap.close()
    assert [record.message for record in caplog.records] == [
        "wire.txt: recording ended: No space left on device"
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
