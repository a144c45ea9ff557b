"""The robot without `await`: what it has, from which threads and processes, against a simulator."""

import asyncio
import inspect
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest

from pioneer3 import BlockingRobot, DeviceError, Robot, connect
from pioneer3.arcos.reports import Config
from pioneer3.log.reader import open_log
from pioneer3.mjpeg import START
from pioneer3.robot.devices import (
    Camera,
    Devices,
    Gripper,
    Gyro,
    Laser,
    Lines,
    Safety,
    TcmCompass,
)
from pioneer3.runtime.facade import facade_of
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.state import Scan
from tests.cameras import fake_camera, films
from tests.e2e.test_ways_out import BYE, SLOW, running, said_goodbye

pytestmark = pytest.mark.realtime

DEVICES = [Camera, Devices, Gripper, Gyro, Laser, Lines, Safety, TcmCompass]


def public(thing: object) -> set[str]:
    """Return the names for scripts: a supervisor is for code in the loop."""
    return {name for name in dir(thing) if not name.startswith("_")} - {"supervisor"}


@pytest.mark.parametrize("kind", [Robot, *DEVICES], ids=lambda kind: kind.__name__)
def test_a_facade_has_every_name_with_its_signature_and_words(kind: type) -> None:
    facade = BlockingRobot if kind is Robot else facade_of(kind)
    assert public(kind) <= public(facade)
    for name in public(kind):
        theirs, ours = getattr(kind, name), getattr(facade, name)
        assert inspect.getdoc(ours) == inspect.getdoc(theirs)
        assert not inspect.iscoroutinefunction(ours)
        if inspect.isfunction(theirs):
            parameters = inspect.signature(theirs).parameters
            assert inspect.signature(ours).parameters == parameters
            assert "Async" not in str(inspect.signature(ours))


@pytest.fixture
async def simulated() -> AsyncIterator[RunningSimulation]:
    async with simulator(port=0) as running:
        yield running


async def script(simulated: RunningSimulation, program: Callable[[BlockingRobot], Any]) -> Any:
    """Run `program` in another thread, as a script beside this simulator."""

    def run() -> Any:
        with connect(simulated.url) as robot:
            return program(robot)

    return await asyncio.to_thread(run)


async def test_devices_are_used_without_await(simulated: RunningSimulation) -> None:
    def program(robot: BlockingRobot) -> None:
        devices = robot.devices
        scan = devices.laser.reading()
        assert isinstance(scan, Scan)
        several = zip(range(3), devices.laser.values(), strict=False)
        assert all(isinstance(each, Scan) for _, each in several)
        with devices.laser.wanted():
            while devices.laser.latest is scan:
                pass
            assert devices.laser.rate >= 0
        assert isinstance(devices.configuration(), Config)
        assert len(devices.lines.reading().digital_out) >= 8
        devices.lines.set_output(3, high=True)
        assert not devices.safety.texts
        assert devices.camera("sony").aim.pan == 0
        assert devices.camera.ptz("sony").aim.pan == 0
        with pytest.raises(DeviceError, match="--camera"):
            devices.camera.image()
        assert {"aim", "kind", "where"} <= set(dir(devices.camera("sony")))
        with pytest.raises(DeviceError):
            devices.safety.ask()
        with pytest.raises(AttributeError):
            devices.laser.nothing  # noqa: B018

    await script(simulated, program)


async def test_pictures_are_read_without_await(simulated: RunningSimulation) -> None:
    async with fake_camera(films((200, 30, 30))) as camera:

        def program() -> None:
            with connect(simulated.url, camera=camera.url) as robot:
                image = robot.devices.camera.image()
                assert image.pixels.shape == (24, 32, 3)
                several = zip(range(3), robot.devices.camera.pictures(), strict=False)
                assert [picture.jpeg[:2] for _, picture in several] == [START] * 3

        await asyncio.to_thread(program)


async def test_an_iteration_that_is_left_lets_go_of_the_device(
    simulated: RunningSimulation,
) -> None:
    def program(robot: BlockingRobot) -> None:
        laser = robot.devices.laser
        for _ in laser.values():
            break
        for _ in robot.snapshots(0.2):
            pass
        laser.set_up(step=0.0349)  # raises while somebody wants scans

    await script(simulated, program)


async def test_a_robot_can_be_closed_in_another_thread_than_it_was_opened_in() -> None:
    async with running() as site:
        program = """
            import signal, threading
            from pioneer3 import connect
            robot = connect(url)
            robot.drive(0.3)
            failed = []
            threading.excepthook = failed.append
            closing = threading.Thread(target=robot.close)
            closing.start()
            closing.join()
            assert not failed
            robot.close()
            second = connect(url)
            second.drive(0.3)
            signal.raise_signal(signal.SIGTERM)
            """
        assert await site.run(program) == (143, "")
        await said_goodbye(site)
        assert site.firmware.heard.count(BYE) == 2


ENDS = {
    "left as usual": "pass",
    "ValueError: no door": "raise ValueError('no door')",
    "told to leave": "signal.raise_signal(signal.SIGTERM)",
}


@pytest.mark.parametrize("why", ENDS)
async def test_a_log_tells_why_the_block_ended(why: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    async with running() as site:
        program = f"""
            import signal
            from pathlib import Path
            from pioneer3 import connect
            with connect(url, record=Path({str(path)!r})) as robot:
                {ENDS[why]}
            """
        await site.run(program)
        await said_goodbye(site)
    assert open_log(path).info().end == why


async def test_a_robot_can_be_opened_and_forgotten_in_a_thread() -> None:
    async with running() as site:
        program = """
            import threading
            from pioneer3 import connect
            kept = []
            opening = threading.Thread(target=lambda: kept.append(connect(url)))
            opening.start()
            opening.join()
            kept[0].drive(0.3)
            """
        assert await site.run(program) == (0, "")
        await said_goodbye(site)


FORKED = {
    "close": "robot.close()",
    "end": "pass",
    "block": "with robot: pass",
    "signal": "os.kill(os.getpid(), signal.SIGTERM)",
    "drive": """
    try:
        robot.drive(0.3)
    except RuntimeError as error:
        assert "forked" in str(error)""",
}


async def test_a_forked_child_leaves_the_session_to_its_parent() -> None:
    async with running() as site:
        forks = "".join(
            f"""
child = os.fork()
if child == 0:
    {FORKED[does]}
    sys.exit(0)
status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
assert status == (-signal.SIGTERM if {does!r} == "signal" else 0), ({does!r}, status)
assert len(list(robot.snapshots(0.5))) >= 2, {does!r}
print({does!r}, file=sys.stderr, flush=True)
sys.stdin.readline()
"""
            for does in FORKED
        )
        program = f"""
import os, signal, sys
from pioneer3 import connect
robot = connect(url)
list(robot.snapshots(0.3))
{forks}
robot.drive(0.3)
list(robot.snapshots(0.3))
"""
        async with site.started(program) as child:
            assert child.stderr is not None
            assert child.stdin is not None
            for does in FORKED:
                async with asyncio.timeout(20):
                    said = ""
                    while not said.endswith("\n"):
                        line = await child.stderr.readline()
                        assert line, said
                        said = SLOW.sub("", said + line.decode())
                assert said == f"{does}\n"
                assert BYE not in site.firmware.heard
                assert site.firmware.device.is_open
                child.stdin.write(b"go on\n")
            _, errors = await child.communicate()
            assert (child.returncode, SLOW.sub("", errors.decode())) == (0, "")
        await said_goodbye(site)
