"""Lasers on real ROS: in the robot's node, and in the place of hokuyo_node."""

import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import degrees

import pytest

from tests.e2e.processes import running
from tests.ros1.master import ros, script

pytestmark = pytest.mark.realtime

SCAN = "90c7ef2dc6895d81024acba2ac42f369"
"""Checksum of sensor_msgs/LaserScan."""


@asynccontextmanager
async def simulated(laser: str) -> AsyncIterator[tuple[str, str]]:
    """Simulate a robot with a laser; yield the addresses of both."""
    command = ("sim", "--ideal", "--fit", f"laser={laser}", "--port", "0")
    async with running(*command) as simulator:
        robot = (await simulator.line()).split()[-1]
        while not (line := await simulator.line()).startswith("LASER: "):
            pass
        yield robot, line.split(" at ")[1].split()[0]


async def angle(topic: str, end: str) -> float:
    """Return an end of the field of the next scan [deg]."""
    said = await ros("rostopic", "echo", "-n", "1", f"{topic}/{end}")
    return degrees(float(said.split()[0]))


async def test_the_robots_node_has_the_scans_of_its_laser(ros1: None) -> None:
    async with (
        simulated("tim551") as (robot, laser),
        running("ros1", "--port", robot, "--laser", laser, "--laser-pose", "0.2,0,10") as node,
    ):
        while not (await node.line()).startswith("node /"):
            pass
        heard = await script("survey.py", "3.0", "/scan", "/diagnostics")
        scans = heard["/scan"]
        assert (scans["type"], scans["md5sum"]) == ("sensor_msgs/LaserScan", SCAN)
        assert scans["frames"] == ["laser_frame"]
        assert scans["ordered"]
        assert scans["age"] < 0.5
        assert (scans["count"] - 1) / (scans["last"] - scans["first"]) == pytest.approx(15, rel=0.2)
        tree = await script("look_up.py", "1.5", "base_link", "laser_frame")
        assert tree["at"]["laser_frame"][0] == pytest.approx(0.2)
        await node.end(signal.SIGINT)


async def test_parameters_hold_for_a_laser_of_the_command_line(ros1: None) -> None:
    async with (
        simulated("utm-30lx") as (robot, laser),
        running(
            *("ros1", "--port", robot, "--laser", laser),
            *("_laser/angle_min:=-1.0", "_laser/angle_max:=0.5", "_laser/port:=/dev/nowhere"),
        ) as node,
    ):
        while not (await node.line()).startswith("node /"):
            pass
        assert await angle("/scan", "angle_min") == pytest.approx(degrees(-1.0), abs=0.3)
        assert await angle("/scan", "angle_max") == pytest.approx(degrees(0.5), abs=0.3)
        _, said = await node.end(signal.SIGINT)
        assert "parameter ~laser/port is ignored" in said


async def test_a_laser_alone_has_the_parameters_of_hokuyo_node(ros1: None) -> None:
    async with (
        simulated("utm-30lx") as (_, laser),
        running(
            *("ros1", "laser", f"_port:={laser}", "_min_ang:=-1.0", "_max_ang:=0.5"),
            *("_frameid:=front", "_skip:=3", "_error_limit:=4", "scan:=front/scan"),
        ) as node,
    ):
        while not (await node.line()).startswith("node /laser"):
            pass
        heard = await script("survey.py", "3.0", "/front/scan")
        scans = heard["/front/scan"]
        assert scans["md5sum"] == SCAN
        assert scans["frames"] == ["front"]
        assert (scans["count"] - 1) / (scans["last"] - scans["first"]) == pytest.approx(10, rel=0.2)
        assert await angle("/front/scan", "angle_min") == pytest.approx(degrees(-1.0), abs=0.3)
        assert await angle("/front/scan", "angle_max") == pytest.approx(degrees(0.5), abs=0.3)
        told = await ros("rostopic", "echo", "-n", "1", "/diagnostics/status[0]/values")
        assert "Computed Latency" in told
        assert "SOKUIKI Sensor UTM-30LX" in told
        code, said = await node.end(signal.SIGINT)
        assert code == 130
        assert "_error_limit" not in said
        assert "parameter ~error_limit of hokuyo_node or urg_node has no effect here" in said
        left = await ros("rosparam", "list")
        assert "/laser/port" not in left


async def test_a_parameter_that_makes_no_sense_ends_the_node_with_a_sentence(ros1: None) -> None:
    async with running("ros1", "laser", "_port:=/dev/nothing", "_cluster:=0") as node:
        code, said = await node.end()
        assert code == 2
        assert "~cluster must be a whole number from 1 to 99, not 0" in " ".join(said.split())
        assert "Traceback" not in said


async def test_programs_for_rosaria_find_a_simulators_laser_by_its_name(ros1: None) -> None:
    async with (
        running("sim", "--ideal", "--port", "0") as simulator,
        running(
            *("ros1", "--port", (await simulator.line()).split()[-1]),
            "_publish_aria_lasers:=true",
        ) as node,
    ):
        while not (await node.line()).startswith("node /"):
            pass
        scan, cloud = (f"/RosAria/sim_lms2xx_1_{kind}" for kind in ("laserscan", "pointcloud"))
        heard = await script("survey.py", "3.0", scan, cloud)
        assert (heard[scan]["type"], heard[scan]["frames"]) == (
            "sensor_msgs/LaserScan",
            ["laser_frame"],
        )
        assert (heard[cloud]["type"], heard[cloud]["frames"]) == (
            "sensor_msgs/PointCloud",
            ["odom"],
        )
        await node.end(signal.SIGINT)


async def test_an_inverted_laser_alone_is_mirrored_and_unknown_settings_are_told(
    ros1: None,
) -> None:
    async with (
        simulated("utm-30lx") as (_, laser),
        running(
            *("ros1", "laser", f"_port:={laser}", "_baud:=38400", "_inverted:=true"),
            *("_angle_min:=-1.0", "_angle_max:=0.5", "_connect_delay:=35"),
        ) as node,
    ):
        while not (await node.line()).startswith("node /laser"):
            pass
        assert await angle("/scan", "angle_min") == pytest.approx(degrees(-1.0), abs=0.3)
        assert await angle("/scan", "angle_max") == pytest.approx(degrees(0.5), abs=0.3)
        _, said = await node.end(signal.SIGINT)
        assert "parameter ~connect_delay of sicktoolbox_wrapper has no effect here" in said
        assert "unknown" not in said
