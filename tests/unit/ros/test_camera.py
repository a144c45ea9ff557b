"""The camera in the robot's node, over a middleware without ROS. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import radians, tan
from typing import Any

import numpy as np
import pytest

from pioneer3 import connect_async
from pioneer3.errors import ConfigError
from pioneer3.mjpeg import END, START
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.node.publishing import SILENCE
from pioneer3.tasks import running
from tests.cameras import TenASecond, jpeg_of
from tests.support import SimulatedRobot
from tests.unit.ros.fakes import FakeMiddleware

IMAGE, INFO = "camera/image_raw", "camera/camera_info"
WIDTH, HEIGHT = 320, 240
JPEG = jpeg_of((200, 30, 30), (WIDTH, HEIGHT))


@asynccontextmanager
async def a_node(camera: TenASecond | None, **raw: object) -> AsyncIterator[FakeMiddleware]:
    """Run a node whose robot has this camera."""
    middleware = FakeMiddleware()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio, "to_thread", middleware.at_once)
        async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
            robot.devices.camera._source = camera
            ready = asyncio.Event()
            node = RobotNode(robot, read_parameters(raw), middleware)
            async with running(node.run(ready.set), *([camera.run()] if camera else [])):
                await ready.wait()
                yield middleware


async def heard(middleware: FakeMiddleware, *names: str) -> list[list[Any]]:
    """Subscribe to topics for a second; return their messages."""
    publishers = [middleware.publishers[name] for name in names]
    for publisher in publishers:
        publisher.subscribed = True
    await asyncio.sleep(1.25)
    for publisher in publishers:
        publisher.subscribed = False
    return [publisher.messages for publisher in publishers]


@pytest.mark.parametrize("profile", ["standard", "compatibility"])
async def test_pictures_are_published_with_the_geometry_of_their_field_of_view(
    profile: str,
) -> None:
    camera = TenASecond(jpeg=JPEG, view=radians(48))
    async with a_node(camera, profile=profile, frame_prefix="robot1/") as middleware:
        images, infos = await heard(middleware, IMAGE, INFO)
        assert 9 <= len(images) <= 13
        assert len(infos) == len(images)
        image, info = images[-1], infos[-1]
        assert (image.encoding, image.width, image.height) == ("rgb8", WIDTH, HEIGHT)
        assert image.step == 3 * WIDTH
        pixels = np.frombuffer(image.data, np.uint8).reshape(HEIGHT, WIDTH, 3)
        assert pixels.mean(axis=(0, 1)) == pytest.approx([200, 30, 30], abs=4)
        assert image.header.frame_id == info.header.frame_id == "robot1/camera_optical_frame"
        assert image.header.stamp == info.header.stamp
        assert info.K[0] == info.K[4] == pytest.approx(160 / tan(radians(24)))
        assert (info.K[2], info.K[5]) == (159.5, 119.5)
        assert info.P[:3] == info.K[:3]


async def test_a_camera_that_sends_nothing_is_left_with_the_last_subscriber() -> None:
    class Silent(TenASecond):
        async def run(self) -> None:
            await asyncio.sleep(1000.0)

    camera = Silent()
    async with a_node(camera) as middleware:
        middleware.publishers[IMAGE].subscribed = True
        await asyncio.sleep(1.0)
        assert camera.viewers == 1
        middleware.publishers[IMAGE].subscribed = False
        await asyncio.sleep(SILENCE + 0.1)
        assert camera.viewers == 0


async def test_without_subscribers_nobody_asks_the_camera() -> None:
    camera = TenASecond(jpeg=JPEG)
    async with a_node(camera) as middleware:
        await asyncio.sleep(1.0)
        assert camera.viewers == 0
        await heard(middleware, IMAGE)
        await asyncio.sleep(0.5)
        assert camera.viewers == 0
        assert middleware.publishers[INFO].messages == []


async def test_a_camera_that_tells_no_field_of_view_is_not_calibrated_unless_a_parameter_is() -> (
    None
):
    async with a_node(TenASecond(jpeg=JPEG)) as middleware:
        assert (await heard(middleware, INFO))[0][-1].K == [0.0] * 9
    async with a_node(TenASecond(jpeg=JPEG), camera_view_deg=90.0) as middleware:
        assert (await heard(middleware, INFO))[0][-1].K[0] == pytest.approx(160.0)
    with pytest.raises(ConfigError, match="camera_view_deg"):
        read_parameters({"camera_view_deg": 400})


async def test_broken_pictures_are_left_out_and_told() -> None:
    camera = TenASecond(jpeg=START + b"torn" + END)
    async with a_node(camera) as middleware:
        assert await heard(middleware, IMAGE) == [[]]
        assert sum("broken picture" in warning for warning in middleware.warnings) == 1


async def test_the_optical_frame_is_where_pictures_say_and_turned_as_rep_103_wants() -> None:
    async with a_node(TenASecond(jpeg=JPEG)) as middleware:
        (message,) = (await heard(middleware, "/tf_static"))[0]
        joints = {each.child_frame_id: each for each in message.transforms}
        optical = joints["camera_optical_frame"]
        assert optical.header.frame_id == "camera_link"
        turned = optical.transform.rotation
        x, y, z, w = turned.x, turned.y, turned.z, turned.w
        ahead = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
        right = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
        assert ahead == pytest.approx((1, 0, 0))
        assert right == pytest.approx((0, -1, 0))
        assert joints["camera_link"].header.frame_id == "top_plate"


async def test_without_a_camera_there_are_no_such_topics_or_frames() -> None:
    async with a_node(None) as middleware:
        assert not {IMAGE, INFO} & set(middleware.publishers)
        (message,) = (await heard(middleware, "/tf_static"))[0]
        assert not [each for each in message.transforms if "camera" in each.child_frame_id]
