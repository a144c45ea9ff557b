"""What people type wrong: one clear line, the right type, and nothing left behind."""

import asyncio
import threading
from pathlib import Path
from typing import Any

import pytest

from pioneer3 import connect, connect_async
from pioneer3.errors import (
    ConfigError,
    LinkError,
    PioneerError,
    PortNotFoundError,
    RecordingOverError,
    TurnedAwayError,
)
from tests.support import SimulatedRobot

WRONG: list[tuple[Any, type[PioneerError], str]] = [
    ("", ConfigError, "names no port; use one of"),
    ("COM", ConfigError, "names no port; use one of"),
    ("COM3", PortNotFoundError, "no such port"),
    ("http://robot", ConfigError, "names no port; use one of"),
    ("localhost:1", PortNotFoundError, "nobody listens there"),
    ("serial:", ConfigError, "names no port; use one of"),
    ("replay:", ConfigError, "names no port; use one of"),
    ("tcp:", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://:8101", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://localhost:0", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://localhost:70000", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://localhost:-1", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://localhost:http", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://localhost:8101/robot", ConfigError, "expected tcp://HOST:PORT"),
    ("tcp://[::1", ConfigError, "expected tcp://HOST:PORT"),
    (None, ConfigError, "a port is written as text"),
    (8101, ConfigError, "a port is written as text"),
    (b"/dev/ttyUSB0", ConfigError, "a port is written as text"),
    (Path("/dev/ttyUSB0"), ConfigError, "a port is written as text"),
    ("replay:/no/such/file", PortNotFoundError, "/no/such/file: no such recording"),
    ("replay:/tmp", ConfigError, "/tmp: not a readable recording"),
    ("/dev/ttyNONE", PortNotFoundError, "no such port; is the cable plugged in"),
    ("~/ttyNONE", PortNotFoundError, "no such port"),
]
REAL: list[tuple[str, type[PioneerError], str]] = [
    ("tcp://nowhere.invalid:8101", PortNotFoundError, "no host of the name 'nowhere.invalid'"),
    (f"tcp://{'a' * 70}.invalid", PortNotFoundError, "no host of the name"),
    ("tcp://a..b", PortNotFoundError, "no host of the name"),
]


def threads() -> set[threading.Thread]:
    """Return those that outlive a connection; the loop's own pool does."""
    return {t for t in threading.enumerate() if not t.name.startswith("asyncio_")}


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


@pytest.mark.parametrize(("url", "kind", "says"), WRONG)
@pytest.mark.realtime
async def test_a_wrong_url_is_explained_in_one_line(
    url: Any, kind: type[PioneerError], says: str
) -> None:
    tasks, files = len(asyncio.all_tasks()), open_files()
    with pytest.raises(kind, match=says) as caught:
        async with connect_async(url):
            pass
    assert "\n" not in str(caught.value)
    assert len(asyncio.all_tasks()) == tasks
    assert open_files() == files


@pytest.mark.parametrize(("url", "kind", "says"), REAL)
@pytest.mark.realtime
async def test_a_host_that_does_not_exist_is_named(
    url: str, kind: type[PioneerError], says: str
) -> None:
    with pytest.raises(kind, match=says):
        async with connect_async(url):
            pass


@pytest.mark.realtime
async def test_a_port_where_nobody_listens_says_how_to_start_a_simulator(
    unused_tcp_port: int,
) -> None:
    for host in ("127.0.0.1", "localhost"):
        with pytest.raises(PortNotFoundError, match=f"pioneer3 sim -p {unused_tcp_port}"):
            async with connect_async(f"tcp://{host}:{unused_tcp_port}"):
                pass


@pytest.mark.realtime
@pytest.mark.parametrize("url", ["", None, "tcp://nowhere.invalid", "/dev/ttyNONE", "replay:/no"])
def test_a_script_gets_the_same_error_and_no_thread_stays(url: Any) -> None:
    before, files = threads(), open_files()
    with pytest.raises((ConfigError, LinkError)):
        connect(url)
    assert threads() == before
    assert open_files() == files


@pytest.mark.realtime
async def test_a_server_that_is_no_robot_is_called_so() -> None:
    async def greet(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"220 mail.example ready\r\n")
        await reader.read(1000)
        writer.close()

    server = await asyncio.start_server(greet, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with server:
        with pytest.raises(TurnedAwayError, match="the other end closed the link"):
            async with connect_async(f"tcp://127.0.0.1:{port}"):
                pass


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("hello", ":1: expected `<seconds> C>S|S>C <bytes> <hex>`"),
        ("# fine\n0.1 S>C 1 zz", ":2: expected `<seconds>"),
        ("0.1 S>C 2 00", ":1: the way or the number of bytes is wrong"),
        ("0.1 X>Y 1 00", ":1: the way or the number of bytes is wrong"),
        ("\x00\xff", "not a readable recording|expected"),
    ],
)
async def test_a_malformed_recording_names_file_and_line(
    tmp_path: Path, text: str, says: str
) -> None:
    (tmp_path / "wire.txt").write_text(text, "latin-1")
    with pytest.raises(ConfigError, match=says):
        async with connect_async(f"replay:{tmp_path / 'wire.txt'}"):
            pass


@pytest.mark.parametrize("text", ["", "# nothing\n", "0.1 C>S 6 fafb03000000\n"])
async def test_a_recording_in_which_no_robot_speaks_is_over(tmp_path: Path, text: str) -> None:
    (tmp_path / "wire.txt").write_text(text)
    with pytest.raises(RecordingOverError, match="the recording is over"):
        async with connect_async(f"replay:{tmp_path / 'wire.txt'}"):
            pass


@pytest.mark.parametrize("option", ["max_speed", "max_turn_rate"])
@pytest.mark.parametrize("value", [0, 0.0, -1.0, float("nan"), float("inf"), "fast"])
async def test_a_limit_that_is_no_positive_number_is_refused(option: str, value: Any) -> None:
    async with SimulatedRobot() as robot:
        with pytest.raises(ConfigError, match=f"limits: {option} must be a positive number"):
            async with connect_async(robot.open, **{option: value}):
                pass
        await asyncio.sleep(0.1)
        assert not robot.powered
        assert not robot.firmware.device.is_open
