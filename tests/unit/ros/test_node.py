"""A node over a middleware without ROS: a simulated robot below it. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.arcos.reports import Sip
from pioneer3.models import shape_of
from pioneer3.robot.devices.laser import Laser
from pioneer3.robot.devices.presence import Presence
from pioneer3.ros.node.middleware import Response
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.tasks import running
from tests.support import SimulatedRobot
from tests.unit.ros.fakes import SOMEBODY, FakeMiddleware


@dataclass
class Running:
    """A node, its middleware, and the robot."""

    sim: SimulatedRobot
    robot: Robot
    middleware: FakeMiddleware

    async def subscribe(self, name: str, seconds: float = 1.0) -> list[object]:
        """Subscribe to a topic for a while; return its messages."""
        publisher = self.middleware.publishers[name]
        publisher.subscribed = True
        await asyncio.sleep(seconds)
        publisher.subscribed = False
        return publisher.messages

    async def call(self, name: str, **request: bool) -> Response:
        """Call a service."""
        response: Response = await self.middleware.call(name, **request)
        return response


@asynccontextmanager
async def a_node(**raw: object) -> AsyncIterator[Running]:
    """Run a node with these parameters."""
    middleware = FakeMiddleware()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio, "to_thread", middleware.at_once)
        async with a_node_over(middleware, raw) as the:
            yield the


@asynccontextmanager
async def a_node_over(
    middleware: FakeMiddleware, raw: Mapping[str, object]
) -> AsyncIterator[Running]:
    """Run a node over this middleware."""
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        ready = asyncio.Event()
        node = RobotNode(robot, read_parameters(raw), middleware)
        async with running(node.run(ready.set)):
            await ready.wait()
            yield Running(sim, robot, middleware)


async def test_it_publishes_what_somebody_subscribes_to() -> None:
    async with a_node(profile="standard") as the:
        assert 9 <= len(await the.subscribe("odom")) <= 11
        assert len(await the.subscribe("/diagnostics", 3.0)) in {2, 3, 4}
        assert the.middleware.publishers["sonar/points"].messages == []


async def test_of_several_reports_that_come_at_once_the_newest_is_published() -> None:
    async with a_node(profile="standard") as the:
        publisher = the.middleware.publishers["odom"]
        publisher.subscribed = True
        await asyncio.sleep(0.35)
        before, reports = len(publisher.messages), the.robot.supervisor.reports
        for _ in range(3):
            reports.publish(Sip(), 0.0)
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert len(publisher.messages) == before + 1


async def test_wheels_have_turned_while_nobody_subscribed() -> None:
    async with a_node(profile="standard", cmd_vel_timeout=10.0) as the:
        the.middleware.drive("cmd_vel", 0.3)
        await asyncio.sleep(5.0)
        told = len(the.middleware.publishers["emergency_stop"].messages)
        assert told < 5, "a latched topic tells news only"
        wheels: Any = (await the.subscribe("joint_states", 0.5))[-1]
        way = the.robot.snapshot.odometry.robot_in_odom.x if the.robot.snapshot else 0.0
        radius = shape_of(the.robot.info.model).wheel_radius
        assert way > 1.0
        assert wheels.position[0] * radius == pytest.approx(way, abs=0.05)
        assert 9 <= len(await the.subscribe("emergency_stop")) - told <= 11


async def test_lasers_are_on_rosarias_topics_where_they_are_asked_for() -> None:
    async with a_node(publish_aria_lasers=True) as the:
        lasers = {"~sim_lms2xx_1_laserscan", "~sim_lms2xx_1_pointcloud"}
        assert lasers <= set(the.middleware.publishers)
        assert "scan" not in the.middleware.publishers
        scan: Any = (await the.subscribe("~sim_lms2xx_1_laserscan", 3.0))[0]
        cloud: Any = (await the.subscribe("~sim_lms2xx_1_pointcloud", 3.0))[0]
        assert (scan.header.frame_id, cloud.header.frame_id) == ("laser_frame", "odom")
        assert scan.angle_min < 0 < scan.angle_max
    async with a_node() as the:
        assert not {name for name in the.middleware.publishers if "laser" in name}


async def test_a_robot_without_a_laser_tells_how_to_give_it_one() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Laser, "presence", Presence(False, "The robot has no laser."))
        async with a_node(publish_aria_lasers=True) as the:
            assert not {name for name in the.middleware.publishers if "laserscan" in name}
            assert any("no laser" in said and "--laser" in said for said in the.middleware.warnings)


async def test_in_the_place_of_p2os_its_topic_switches_the_motors() -> None:
    async with a_node(profile="p2os", max_xspeed=0.2) as the:
        publishers, switch = the.middleware.publishers, the.middleware.receivers["cmd_motor_state"]
        assert {"pose", "motor_state", "sonar", "battery_state", "aio", "dio"} <= set(publishers)
        for state in (1, 0, 1):
            switch(SimpleNamespace(state=state), SOMEBODY)
            told: Any = (await the.subscribe("motor_state"))[-1]
            assert told.state == state
        the.middleware.drive("cmd_vel", 0.1)
        await asyncio.sleep(0.4)
        assert the.sim.body.speeds[0] > 0
        switch(SimpleNamespace(state=0), SOMEBODY)
        await asyncio.sleep(1.0)
        assert the.sim.body.speeds[0] == 0
        the.middleware.drive("cmd_vel", 0.1)
        await asyncio.sleep(0.4)
        assert the.sim.body.speeds[0] == 0
    async with a_node() as the:
        assert "cmd_motor_state" not in the.middleware.receivers


async def test_scans_are_asked_for_while_somebody_subscribes() -> None:
    async with a_node(profile="standard") as the:
        await asyncio.sleep(1.0)
        assert the.robot.laser.latest is None
        scans = await the.subscribe("scan", 3.0)
        assert len(scans) > 10
        await asyncio.sleep(2.0)
        before = the.robot.laser.latest
        await asyncio.sleep(2.0)
        assert the.robot.laser.latest is before


async def test_commands_drive_and_the_end_of_the_node_stops() -> None:
    async with a_node(cmd_vel_timeout=0) as the:
        the.middleware.drive("~cmd_vel", 0.3)
        await asyncio.sleep(2.0)
        assert the.sim.body.speeds[0] == pytest.approx(0.3, abs=0.01)
        the.middleware.shut_down()
        await asyncio.sleep(2.0)
        assert the.sim.body.speeds[0] == 0.0
        assert the.middleware.forgotten


async def test_services_act_and_respond() -> None:
    async with a_node(profile="both") as the:
        assert (await the.call("~enable_motors")).success
        assert (await the.call("e_stop_trigger")).success
        assert the.robot.supervisor.pilot.emergency
        refused = await the.call("enable_motors")
        assert not refused.success
        assert any("enable_motors is refused" in warning for warning in the.middleware.warnings)
        assert "the emergency stop is latched" in (await the.call("self_test")).message
        assert (await the.call("e_stop_reset")).success
        assert (await the.call("sonar/enable", data=False)).success
        assert (await the.call("reset_odometry")).success


async def test_motors_that_were_switched_off_are_told_with_the_service_that_helps() -> None:
    async with a_node(profile="standard") as the:
        assert "next command" in (await the.call("e_stop_reset")).message
        await the.call("disable_motors")
        the.middleware.drive("cmd_vel", 0.3)
        await asyncio.sleep(0.3)
        assert the.sim.body.speeds[0] == 0.0
        assert "do not switch them on" in str(the.robot.why_not_moving())
        for service in ("self_test", "e_stop_reset"):
            response = await the.call(service)
            assert response.success
            assert "enable_motors" in response.message
        await the.call("enable_motors")
        await asyncio.sleep(1.0)
        assert (await the.call("self_test")).message == "all is well"


async def test_rosarias_profile_has_its_two_services_only() -> None:
    async with a_node() as the:
        assert set(the.middleware.services) == {"~enable_motors", "~disable_motors"}


async def test_driving_parameters_change_the_limits() -> None:
    async with a_node(trans_accel=0.5) as the:
        driving = the.middleware.driving
        assert driving is not None
        assert driving.wanted["max_linear_acceleration"] == 0.5
        driving.set({**driving.wanted, "max_linear_acceleration": 0.2})
        await asyncio.sleep(0.1)
        assert the.robot.info.limits.acceleration == 0.2


async def test_a_lost_robot_is_logged_and_said_on_latched_topics() -> None:
    async with a_node() as the:
        await the.sim.unplug()
        await asyncio.sleep(5.0)
        assert the.middleware.warnings[0].startswith("LOST THE ROBOT")
        assert the.middleware.publishers["~motors_state"].messages[-1] is False
        the.sim.plugged = True
        await asyncio.sleep(10.0)
        assert the.middleware.warnings[-1].startswith("connected again")


async def test_the_robot_is_described_unless_the_parameters_say_no() -> None:
    async with a_node() as the:
        assert "<robot" in (the.middleware.description or "")
    async with a_node(publish_description=False) as the:
        assert the.middleware.description is None
