"""The camera on real ROS: pictures, their geometry and their frame."""

import signal
from math import radians, tan

import pytest

from tests.cameras import require_opengl
from tests.e2e.processes import running
from tests.ros1.master import ros, script

pytestmark = pytest.mark.realtime

IMAGE = "060021388200f6f0f447d0fcd9c64743"
"""Checksum of sensor_msgs/Image."""
INFO = "c9a58c1b0b154e0e6da7578cb991d214"
"""Checksum of sensor_msgs/CameraInfo."""


async def test_the_robots_node_has_the_pictures_of_its_camera(ros1: None) -> None:
    require_opengl()
    command = ("sim", "--physics", "--fit", "camera=vcc4,picture-width=160,picture-height=120")
    async with running(*command, "--port", "0") as simulator:
        while not (line := await simulator.line()).startswith("SIMULATOR: "):
            pass
        robot = line.split()[-1]
        while not (line := await simulator.line()).startswith("CAMERA: "):
            pass
        async with running("ros1", "--port", robot, "--camera", line.split()[-1]) as node:
            while not (await node.line()).startswith("node /"):
                pass
            heard = await script("survey.py", "3.0", "/camera/image_raw", "/camera/camera_info")
            image, info = heard["/camera/image_raw"], heard["/camera/camera_info"]
            assert (image["type"], image["md5sum"]) == ("sensor_msgs/Image", IMAGE)
            assert (info["type"], info["md5sum"]) == ("sensor_msgs/CameraInfo", INFO)
            assert image["frames"] == info["frames"] == ["camera_optical_frame"]
            assert image["ordered"]
            assert image["count"] > 10
            matrix = await ros("rostopic", "echo", "-n", "1", "/camera/camera_info/K")
            focal = float(matrix.strip("[]\n- ").partition(",")[0].strip("()"))
            assert focal == pytest.approx(80 / tan(radians(24)), rel=1e-3)
            tree = await script("look_up.py", "1.5", "base_link", "camera_optical_frame")
            assert tree["at"]["camera_optical_frame"][2] > 0.3
            await node.end(signal.SIGINT)
