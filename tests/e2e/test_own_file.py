"""A robot that has a file of its own is driven by its numbers, and has its lasers and camera."""

import pytest

from pioneer3 import connect_async
from pioneer3.errors import ConfigError
from pioneer3.models.own import own_folder
from tests.support import SimulatedRobot

OWN = """
max_speed = 0.2
camera = "http://127.0.0.1:9/stream"

[[lasers]]
port = "/dev/no-such-laser"
kind = "urg-04lx"
x = 0.1
y = 0
theta_deg = 0
"""


def save(text: str) -> None:
    own_folder().mkdir(parents=True, exist_ok=True)
    (own_folder() / "MobileSim.toml").write_text(text)


@pytest.mark.realtime
async def test_its_limits_lasers_and_camera_count() -> None:
    save(OWN)
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        assert driver.info.limits.max_speed == pytest.approx(0.2)
        assert [laser.sensor_in_robot.x for laser in driver.lasers] == [0.1]
        assert "127.0.0.1:9" in driver.devices.camera.presence.reason
        assert driver.info.model.name == "p3at-sh"


@pytest.mark.realtime
async def test_what_is_given_counts_before_it() -> None:
    save(OWN)
    async with (
        SimulatedRobot() as robot,
        connect_async(robot.open, model="p3dx", lasers=["/dev/another"]) as driver,
    ):
        assert driver.info.model.name == "p3dx"
        assert [laser.sensor_in_robot.x for laser in driver.lasers] == [0.018]


async def test_a_wrong_file_is_told_and_nothing_drives() -> None:
    save("max_speed = 99")
    async with SimulatedRobot() as robot:
        with pytest.raises(ConfigError, match=r"MobileSim\.toml:1: max_speed: 99 is out of range"):
            async with connect_async(robot.open):
                pass


async def test_a_file_that_was_spoilt_meanwhile_stops_the_robot_until_it_is_mended() -> None:
    save("max_speed = 0.2")
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        save("max_speed = 99")
        await robot.unplug()
        robot.plugged = True
        async for status in driver.supervisor.status.values():
            if "max_speed" in status.message:
                break
        assert driver.snapshot is None or driver.supervisor.snapshot is None
        save("max_speed = 0.3")
        async for status in driver.supervisor.status.values():
            if status.connection == "connected":
                break
        assert driver.info.limits.max_speed == pytest.approx(0.3)
