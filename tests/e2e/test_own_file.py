"""A robot that has a file of its own is driven by its numbers, and has its lasers and camera."""

import pytest

from pioneer3 import connect_async
from pioneer3.cli.options import LinkOptions
from pioneer3.cli.robot import _init
from pioneer3.errors import ConfigError
from pioneer3.models.own import own_folder
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.sim.server.start import simulator
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
LASER = """
[[lasers]]
port = "{port}"
kind = "urg-04lx"
x = 0.1
y = 0
theta_deg = 0"""


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


WRONG_PARTS = {
    'camera = "rtsp://h/"': r":1: camera: rtsp://h/: no URL of a camera; expected the URL",
    LASER.format(port="nowhere"): r":3: lasers\[0\].port: 'nowhere' names no port",
    LASER.format(
        port="/dev/ttyUSB0"
    ): r":3: lasers\[0\].port: /dev/ttyUSB0: that is the robot's own",
    LASER.format(port="/dev/a") * 2: r":9: lasers\[1\].port: /dev/a: given twice",
}


@pytest.mark.parametrize(
    ("text", "complaint"), WRONG_PARTS.items(), ids=["camera", "port", "own", "twice"]
)
async def test_a_wrong_laser_or_camera_in_it_is_told_by_its_line(
    text: str, complaint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(text)
    async with SimulatedRobot() as robot:
        monkeypatch.setattr("pioneer3.runtime.connect.opener", lambda url, baud: robot.open)
        with pytest.raises(ConfigError, match=rf"MobileSim\.toml{complaint}"):
            async with connect_async("/dev/ttyUSB0"):
                pass


async def test_a_laser_of_a_program_at_the_robots_port_is_refused() -> None:
    with pytest.raises(ConfigError, match="/dev/ttyUSB0: that is the robot's own port"):
        async with connect_async("serial:/dev/ttyUSB0", lasers=["urg-04lx@/dev/ttyUSB0"]):
            pass


async def test_a_recording_is_read_without_the_lasers_of_today(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    save(OWN)
    async with SimulatedRobot() as robot:
        monkeypatch.setattr("pioneer3.runtime.connect.opener", lambda url, baud: robot.open)
        async with connect_async("replay:lab.wire") as driver:
            assert driver.info.own is not None
            assert not [each for each in driver.lasers if isinstance(each, LaserDriver)]
            assert not driver.devices.camera.presence.there


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


@pytest.mark.realtime
async def test_a_file_made_anew_is_like_the_type_that_the_robot_says() -> None:
    save('name = "rosies"')
    async with simulator(port=0, robot="p3dx") as here:
        assert await _init(None, LinkOptions(port=here.url), force=True) == 0
    assert 'like = "p3dx"\n' in (own_folder() / "MobileSim.toml").read_text()
