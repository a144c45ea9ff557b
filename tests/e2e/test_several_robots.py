"""Several robots that one program connects to: what happens to one is nothing to the others."""

import asyncio
import socket
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.links.tap import recorded_links
from pioneer3.log.reader import open_log
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.web import hosting
from pioneer3.web.hosting import ConnectTarget, hosted, log_names
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.support import until

pytestmark = pytest.mark.realtime


def closed_port() -> int:
    """Return a TCP port where nobody listens."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def simulated(port: int = 0) -> AbstractAsyncContextManager[RunningSimulation]:
    return simulator(map_name="empty", robot="p3dx-sh", port=port)


async def test_one_that_is_lost_is_named_and_the_others_go_on() -> None:
    told: list[str] = []
    page = Page()
    async with AsyncExitStack() as stack:
        left = await stack.enter_async_context(simulated())
        async with AsyncExitStack() as right_stack:
            right = await right_stack.enter_async_context(simulated())
            targets = [
                ConnectTarget(url=sim.url, scene=RobotScene(), name=name)
                for sim, name in ((left, "left"), (right, "right"))
            ]
            await stack.enter_async_context(hosted(page, targets, told.append))
            assert [line.split(",")[0] for line in sorted(told)] == [
                "Connected to a SIMULATOR: left",
                "Connected to a SIMULATOR: right",
            ]
        await until(lambda: any(line.startswith("right: lost: ") for line in told))
        robot = page.robots[1].robot
        for _ in range(10):
            robot.drive(0.2)
            await asyncio.sleep(0.05)
        assert robot.snapshot is not None
        assert left.body.speeds[0] > 0.1
        assert [station.name for station in page.robots.values()] == ["left", "right"]


async def test_one_that_is_not_there_is_looked_for_until_it_comes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(hosting, "RETRY_PERIOD", 0.2)
    told: list[str] = []
    page, port = Page(), closed_port()
    async with simulated() as here:
        targets = [
            ConnectTarget(url=f"tcp://127.0.0.1:{port}", scene=RobotScene(), name="late"),
            ConnectTarget(url=here.url, scene=RobotScene(), name="here"),
        ]
        path = tmp_path / "both.mcap"
        async with hosted(page, targets, told.append, path):
            assert list(page.robots) == [2]
            assert f"tcp://127.0.0.1:{port}: nobody listens there" in told[-1]
            async with simulated(port):
                await until(lambda: len(page.robots) == 2)
                assert list(page.robots) == [1, 2]
                assert page.robots[1].robot.info.url == f"tcp://127.0.0.1:{port}"
        assert recorded_links(path) == ["here/robot", "late/robot"]
        assert next(open_log(path).snapshots("late/snapshot")).battery.voltage > 0


async def test_where_none_is_there_it_says_why() -> None:
    targets = [
        ConnectTarget(url=f"tcp://127.0.0.1:{closed_port()}", scene=RobotScene()) for _ in range(2)
    ]
    with pytest.raises(PortNotFoundError):
        async with hosted(Page(), targets, lambda line: None):
            raise AssertionError
    assert asyncio.all_tasks() == {asyncio.current_task()}


async def test_a_file_that_exists_is_never_written_over(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    kept.write_text("mine")
    async with simulated() as here, simulated() as there:
        targets = [
            ConnectTarget(url=here.url, scene=RobotScene()),
            ConnectTarget(url=there.url, scene=RobotScene()),
        ]
        with pytest.raises(ConfigError, match="kept: cannot record there"):
            async with hosted(Page(), targets, lambda line: None, kept):
                raise AssertionError
    assert kept.read_text() == "mine"


def test_in_a_log_robots_have_their_names_or_addresses() -> None:
    urls = ["tcp://10.0.0.1:8101", "serial:/dev/ttyUSB0", "tcp://b:8101", "tcp://c:8101"]
    names = ["", "", "bob", "bob"]
    targets = [
        ConnectTarget(url=u, scene=RobotScene(), name=n) for u, n in zip(urls, names, strict=True)
    ]
    assert log_names(targets) == ["10.0.0.1-8101", "dev-ttyUSB0", "bob", "bob 2"]
