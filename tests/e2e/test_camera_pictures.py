"""The pictures of a simulated camera, as viewers get them over HTTP."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import DeviceError
from pioneer3.geometry import Pose2
from pioneer3.mjpeg import Parser
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.server import picture_process
from pioneer3.sim.server.camera import MOST_VIEWERS, SimulatedCamera
from pioneer3.sim.server.picture_process import PictureProcess, RenderFailure
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import Box, Person, RobotSpec, WorldFile
from tests.cameras import Pixels, body_of, decoded, http_get, require_opengl

pytestmark = pytest.mark.realtime

CAMERA = EquipmentOptions(camera="vcc4")


@asynccontextmanager
async def seeing(
    *things: Box | Person, equipment: EquipmentOptions = CAMERA
) -> AsyncIterator[tuple[RunningSimulation, SimulatedCamera]]:
    """Run a simulator with a robot that looks along the x axis."""
    require_opengl()
    world = WorldFile(
        name="view",
        seed=1,
        physics="mujoco",
        robots=(RobotSpec(model="p3dx-sh", start=Pose2(0, 0, 0), equipment=equipment),),
        boxes=tuple(thing for thing in things if isinstance(thing, Box)),
        people=tuple(thing for thing in things if isinstance(thing, Person)),
    )
    async with simulator(map_name=world, port=0) as running:
        camera = running.robots[0].camera
        assert camera is not None, running.notes
        yield running, camera


def box(x: float, y: float) -> Box:
    return Box(pose=Pose2(x, y, 0.0), size=(0.4, 0.4), movable=True)


async def snapshot(camera: SimulatedCamera) -> Pixels:
    status, body = await body_of(f"{camera.url}snapshot.jpg")
    assert status.endswith("200 OK")
    return decoded(body)


def boxes_in(pixels: Pixels) -> Pixels:
    """Return where the picture is orange, as the columns and rows of its pixels, shape (2, P)."""
    red, green, blue = np.moveaxis(pixels.astype(int), -1, 0)
    rows, columns = np.nonzero((red > green + 40) & (green > blue + 40))
    return np.stack([columns, rows])


async def test_a_box_is_seen_where_it_is_and_a_pan_moves_it() -> None:
    async with seeing(box(2.0, 0.0)) as (running, camera):
        pixels = await snapshot(camera)
        assert pixels.shape == (240, 320, 3)
        columns, _ = boxes_in(pixels)
        assert len(columns) > 500
        assert abs(columns.mean() - 160) < 5
        ptz = running.robots[0].firmware.accessories.camera
        assert ptz is not None
        ptz._axes.look(0.2, 0.0, running.world.time)
        await asyncio.sleep(0.5)
        turned, _ = boxes_in(await snapshot(camera))
        focal = 160 / np.tan(24 * pi / 180)
        assert turned.mean() - columns.mean() == pytest.approx(focal * np.tan(0.2), abs=6)


async def test_the_zoom_enlarges_what_is_seen() -> None:
    async with seeing(box(5.0, 0.0)) as (running, camera):
        wide, _ = boxes_in(await snapshot(camera))
        ptz = running.robots[0].firmware.accessories.camera
        assert ptz is not None
        ptz._axes.zoom.go(0.25, running.world.time)
        await asyncio.sleep(1.0)
        near, _ = boxes_in(await snapshot(camera))
        grown = np.tan(24 * pi / 180) / np.tan(camera.model.view(0.25) / 2)
        assert np.ptp(near) / np.ptp(wide) == pytest.approx(grown, rel=0.1)


async def test_a_person_is_green_and_what_comes_later_is_seen_too() -> None:
    async with seeing(Person(path=((2.5, 0.0),))) as (running, camera):
        before = await snapshot(camera)
        red, green, blue = before[120, 160].astype(int)
        assert green > red + 40
        assert green > blue + 20
        assert boxes_in(before).size == 0
        running.add_box(box(1.2, 0.1))
        assert boxes_in(await snapshot(camera)).shape[1] > 500


async def test_the_size_is_as_asked_and_nothing_is_rendered_unseen() -> None:
    equipment = EquipmentOptions(camera="sony", picture_width=160, picture_height=120)
    async with seeing(equipment=equipment) as (_, camera):
        await asyncio.sleep(0.3)
        assert camera.taken == 0
        assert (await snapshot(camera)).shape == (120, 160, 3)
        taken = camera.taken
        await asyncio.sleep(0.3)
        assert camera.taken == taken


async def test_a_stream_goes_on_and_slow_and_rude_viewers_do_no_harm() -> None:
    async with seeing() as (_, camera):
        host = camera.url.removeprefix("http://").rstrip("/")
        name, _, port = host.partition(":")
        _, mute = await asyncio.open_connection(name, int(port))
        _, rude = await asyncio.open_connection(name, int(port))
        rude.write(b"\x00\xff" * 10_000 + b"\r\n\r\n")
        async with http_get(camera.url) as slow, http_get(camera.url) as quick:
            parser = Parser()
            while parser.pictures < 5:
                parser.receive(await quick.read(1 << 16))
            assert parser.broken == 0
            assert (await slow.read(12)).startswith(b"HTTP/1.0 200")
        for writer in (mute, rude):
            writer.close()
        assert (await body_of(f"{camera.url}nothing"))[0].endswith("404 Not Found")


async def test_one_viewer_too_many_is_told_so() -> None:
    async with seeing() as (_, camera):
        readers = [http_get(camera.url) for _ in range(MOST_VIEWERS)]
        for reader in readers:
            assert (await (await reader.__aenter__()).readline()).endswith(b"200 OK\r\n")
        assert (await body_of(camera.url))[0].endswith("503 Service Unavailable")
        for reader in readers:
            await reader.__aexit__(None, None, None)


async def test_a_renderer_that_dies_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pioneer3.sim.server.camera_ports.RESTART", 0.1)
    async with seeing() as (running, camera):
        await snapshot(camera)
        cameras = running._simulation.cameras
        assert cameras is not None
        process = cameras._process._process
        assert process is not None
        process.kill()
        assert (await snapshot(camera)).shape == (240, 320, 3)


async def test_without_opengl_all_but_pictures_works(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.setattr(picture_process, "BACKENDS", ("no-such-opengl",))
    world = WorldFile(name="dark", physics="mujoco", robots=(RobotSpec(equipment=CAMERA),))
    async with simulator(map_name=world, port=0) as running:
        note = next(note for note in running.notes if "picture" in note)
        assert picture_process.PACKAGES in note
        assert running.robots[0].camera is None
        before = running.world.time
        await asyncio.sleep(0.3)
        assert running.world.time > before


@pytest.mark.parametrize(
    ("reason", "advice"),
    [
        ("Failed to import OpenGL backend: No module named 'OpenGL'", "`physics` is missing"),
        ("'NoneType' object has no attribute 'glGetError'", picture_process.PACKAGES),
    ],
)
async def test_what_is_missing_is_told_in_one_line(
    reason: str, advice: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(process: PictureProcess, backend: str) -> RenderFailure:
        return RenderFailure(f"{reason}\nand more", told=True)

    monkeypatch.setattr(PictureProcess, "_try", fail)
    with pytest.raises(DeviceError) as caught:
        await PictureProcess().start()
    assert advice in str(caught.value)
    assert "\n" not in str(caught.value)


async def test_modules_in_the_working_folder_are_not_executed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    require_opengl()
    (tmp_path / "copy.py").write_text("open('executed', 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    process = PictureProcess()
    try:
        await process.start()
    finally:
        await process.close()
    assert process.backend
    assert not (tmp_path / "executed").exists()


async def test_a_process_that_does_not_start_gives_its_last_line_and_no_advice_on_opengl(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(picture_process, "MODULE", "pioneer3.no_such_module")
    with pytest.raises(DeviceError, match="No module named") as caught:
        await PictureProcess().start()
    assert "apt-get" not in str(caught.value)


async def test_a_robot_that_was_hidden_when_the_world_was_sent_is_seen_later() -> None:
    async with seeing() as (running, camera):
        other = await running.add_robot(RobotSpec(model="p3dx-sh", start=Pose2(1.5, 0.0, 0.0)))
        other.body.ghost = True
        await asyncio.sleep(0.3)
        assert red_in(await snapshot(camera)) < 500
        other.body.ghost = False
        await asyncio.sleep(0.3)
        assert red_in(await snapshot(camera)) > 500


async def test_each_robot_sees_for_itself_until_it_goes() -> None:
    async with seeing() as (running, first):
        added = await running.add_robot(
            RobotSpec(model="p3dx-sh", start=Pose2(1.5, 0.0, 0.0), equipment=CAMERA, port=0)
        )
        second = added.camera
        assert second is not None
        assert second.url != first.url
        assert red_in(await snapshot(first)) > 500 > red_in(await snapshot(second))
        await running.remove_robot(added)
        with pytest.raises(ConnectionError):
            await body_of(second.url)
        assert red_in(await snapshot(first)) < 500


def red_in(pixels: Pixels) -> int:
    """Return how much of a picture is red, as robots are."""
    red, green, blue = np.moveaxis(pixels.astype(int), -1, 0)
    return int(((red > green + 60) & (red > blue + 60)).sum())


async def test_a_wrong_setting_of_opengl_does_not_keep_physics_from_starting() -> None:
    pytest.importorskip("mujoco")
    program = (
        "from pioneer3.sim.physics.dynamics import MujocoDynamics\n"
        "MujocoDynamics()\n"
        "import os; print(os.environ['MUJOCO_GL'])\n"
    )
    import os
    import sys

    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-c",
        program,
        stdout=asyncio.subprocess.PIPE,
        env=os.environ | {"MUJOCO_GL": "nonsense"},
    )
    said, _ = await process.communicate()
    assert (process.returncode, said.decode().strip()) == (0, "nonsense")
