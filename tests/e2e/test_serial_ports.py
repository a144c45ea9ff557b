"""A serial port that is pulled out and put back under the same name. Real time, real ptys."""

import asyncio
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.errors import LinkError, MotionError, PortBusyError, PortNotFoundError
from pioneer3.links import open_link
from pioneer3.links.serial import SPEEDS, open_serial, remember_speed, remembered_speed
from pioneer3.links.stream import StreamLink
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World
from tests.pseudo_terminal import open_pty
from tests.support import hold, until

pytestmark = pytest.mark.realtime
SOON = 20.0
STOP = bytes.fromhex("fafb031d001d")


class Board:
    """A robot on a serial port that may be pulled out."""

    def __init__(self, name: Path) -> None:
        self.name = name
        self.body = Body(load_model("p3at-sh"))
        self.world = World(None, [self.body])
        self.firmware = Firmware(self.world, self.body)
        self.heard: list[bytes] = []

    async def plug_in(self) -> None:
        self.pty = await open_pty(self.name)
        self.heard.append(b"")
        read = self.pty.link.read

        async def noted() -> bytes:
            data = await read()
            self.heard[-1] += data
            return data

        self.pty.link.read = noted  # type: ignore[method-assign]
        simulation = Simulation(self.world, [self.firmware], keep_session=True)
        self.tasks = [
            asyncio.ensure_future(simulation.ports[0].serve(self.pty.link)),
            asyncio.ensure_future(simulation.run()),
        ]

    async def unplug(self) -> None:
        await self.pty.close()
        for task in self.tasks:
            task.cancel()
        await asyncio.gather(*self.tasks, return_exceptions=True)


async def test_a_port_pulled_out_and_put_back_is_found_again(tmp_path: Path) -> None:
    board = Board(tmp_path / "robot")
    await board.plug_in()
    async with asyncio.timeout(SOON), connect_async(str(board.name)) as driver:
        assert driver.info.speed == SPEEDS[0]
        await hold(driver, 0.2)
        assert board.body.speeds[0] > 0.1
        holding = asyncio.ensure_future(hold(driver, 0.2, seconds=4))
        await board.unplug()
        await until(lambda: driver.snapshot is None)
        with pytest.raises(MotionError, match="the link was lost"):
            driver.drive(0.1)
        await board.plug_in()
        await holding
        async for snapshot in driver.snapshots():
            if snapshot.link.sessions == 2:
                break
        assert board.heard[-1].startswith(STOP)
        assert not board.body.drive.powered
        assert board.body.speeds[0] == 0
        await asyncio.sleep(0.7)
        assert await hold(driver, 0.2) == 0
        assert board.body.speeds[0] > 0.1
    await board.unplug()
    assert not board.name.is_symlink()


async def test_two_programs_cannot_share_a_port(tmp_path: Path) -> None:
    board = Board(tmp_path / "robot")
    await board.plug_in()
    async with connect_async(str(board.name)):
        with pytest.raises(PortBusyError, match="busy; another program has it open"):
            async with connect_async(str(board.name)):
                pass
    await board.unplug()


async def test_the_speed_that_worked_last_is_tried_first(tmp_path: Path) -> None:
    port = await open_pty(tmp_path / "robot")
    remember_speed(port.path, 38400)
    remember_speed("/dev/other", 115200)
    assert remembered_speed(port.path) == 38400
    link = await open_serial(port.path)
    assert link.speeds == (38400, 9600, 19200, 57600, 115200)
    await link.set_speed(115200)
    await link.close()
    link = await open_serial(port.path, 57600)
    assert link.speeds[0] == 57600
    await link.close()
    await port.close()


async def test_bytes_pass_both_ways_through_a_pty(tmp_path: Path) -> None:
    port = await open_pty()
    link = await open_link(f"serial:{port.path}")
    everything = bytes(range(256))
    async with asyncio.timeout(SOON):
        for near, far in ((link, port.link), (port.link, link)):
            await near.write(everything)
            got = b""
            while len(got) < len(everything):
                got += await far.read()
            assert got == everything
    await link.close()
    await link.close()
    with pytest.raises(LinkError):
        await link.write(b"x")
    await port.close()
    await port.close()


async def test_a_host_notices_that_the_port_is_gone(tmp_path: Path) -> None:
    port = await open_pty(tmp_path / "robot")
    link = await open_serial(port.path)
    await port.close()
    assert not (tmp_path / "robot").is_symlink()
    async with asyncio.timeout(SOON):
        assert await ends(link)
    with pytest.raises(LinkError):
        await link.set_speed(38400)
    await link.close()


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


async def ends(link: StreamLink) -> bool:
    try:
        return await link.read() == b""
    except LinkError:
        return True


async def test_a_name_that_is_taken_is_refused_and_nothing_left_open(tmp_path: Path) -> None:
    (tmp_path / "robot").write_text("")
    before = open_files()
    with pytest.raises(LinkError, match="cannot make this port: File exists"):
        await open_pty(tmp_path / "robot")
    assert open_files() == before


@pytest.mark.parametrize(
    ("path", "kind", "says"),
    [
        ("/dev/ttyNONE", PortNotFoundError, "no such port; is the cable plugged in"),
        ("/dev/null", LinkError, "not a serial port"),
        ("/etc/hostname", LinkError, "not a serial port"),
        ("/tmp", LinkError, "/tmp: "),
    ],
)
async def test_what_is_no_port_is_called_so(path: str, kind: type[LinkError], says: str) -> None:
    with pytest.raises(kind, match=says) as caught:
        async with connect_async(path):
            pass
    assert "\n" not in str(caught.value)
