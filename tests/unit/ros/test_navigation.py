"""The navigation of a node over a middleware without ROS: a simulated robot below it. Virtual time.

The test is a program that goes somewhere: it sees what move_base's clients see.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from math import atan2, cos, hypot, nan, pi, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject
from pioneer3.navigation.connect import connect_async
from pioneer3.ros.messages.diagnostics import DiagnosticLevel
from pioneer3.ros.messages.goals import GoalState
from pioneer3.ros.messages.navigation import navigation_status
from pioneer3.ros.node.middleware import Sender
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.runtime.robot import Robot
from pioneer3.sim.worldfile import Box
from pioneer3.state import Charging
from pioneer3.tasks import running
from tests.support import SimulatedRobot, until
from tests.unit.ros.fakes import SOMEBODY, FakeMiddleware, Moment

pytest.importorskip("numba")
pytest.importorskip("scipy")
from pioneer3.navigation.navigator import Navigator
from tests.unit.web.test_navigation import BEGIN, ROOMS

NOW = Moment(0.0)
"""In a goal: not stamped."""


class Clocked(FakeMiddleware):
    """A middleware whose time passes."""

    def __init__(self) -> None:
        super().__init__()
        self._clock = asyncio.get_running_loop().time

    def stamp(self, age: float) -> Moment:
        return Moment(1000.0 + self._clock() - age)


@dataclass
class Going:
    """A node with a map, its middleware, and the robot."""

    sim: SimulatedRobot
    robot: Robot
    navigator: Navigator
    middleware: Clocked
    free: asyncio.Event
    """Set while threads get on."""

    @property
    def here(self) -> Pose2:
        return self.sim.body.robot_in_world

    def listen(self, *names: str) -> None:
        for name in names:
            self.middleware.publishers[name].subscribed = True

    def heard(self, name: str) -> list[Any]:
        return self.middleware.publishers[name].messages

    def send(self, name: str, message: Any, sender: Sender = SOMEBODY) -> None:
        self.middleware.receivers[name](message, sender)

    def goal(self, id_: str, x: float, y: float, frame: str = "map", **more: Any) -> None:
        stamped = pose_stamped(x, y, frame, **more)
        self.send(
            "move_base/goal",
            SimpleNamespace(
                goal_id=SimpleNamespace(id=id_, stamp=NOW),
                goal=SimpleNamespace(target_pose=stamped),
            ),
        )

    def cancel(self, id_: str = "", stamp: Moment = NOW) -> None:
        self.send("move_base/cancel", SimpleNamespace(id=id_, stamp=stamp))

    @property
    def results(self) -> list[tuple[str, GoalState, str]]:
        """Goals that are over, the state of each and its text."""
        statuses = [each.status for each in self.heard("move_base/result")]
        return [(each.goal_id.id, GoalState(each.status), each.text) for each in statuses]

    async def ended(self, seconds: float = 60.0) -> tuple[str, GoalState, str]:
        """Wait for the next result."""
        count = len(self.results)
        await until(lambda: len(self.results) > count, seconds)
        return self.results[-1]


def pose_stamped(
    x: float,
    y: float,
    frame: str = "map",
    heading: float = 0.0,
    turned: tuple[float, float] | None = None,
) -> SimpleNamespace:
    z, w = turned or (sin(heading / 2), cos(heading / 2))
    return SimpleNamespace(
        header=SimpleNamespace(frame_id=frame, stamp=NOW),
        pose=SimpleNamespace(
            position=SimpleNamespace(x=x, y=y, z=0.0),
            orientation=SimpleNamespace(x=0.0, y=0.0, z=z, w=w),
        ),
    )


def start_at(x: float, y: float, heading: float = 0.0, frame: str = "map") -> SimpleNamespace:
    covariance = [0.0] * 36
    covariance[0] = covariance[7] = 0.25
    covariance[35] = 0.07
    plain = pose_stamped(x, y, frame, heading)
    inner = SimpleNamespace(pose=plain.pose, covariance=covariance)
    return SimpleNamespace(header=plain.header, pose=inner)


@asynccontextmanager
async def going(
    start: Pose2 | None = BEGIN, line_map: LineMap = ROOMS, **raw: object
) -> AsyncIterator[Going]:
    """Run a node with a map of two rooms, and a robot in one of them."""
    middleware, free = Clocked(), asyncio.Event()
    free.set()

    async def in_thread(function: Callable[..., Any], *arguments: Any) -> Any:
        await free.wait()
        return function(*arguments)

    sim = SimulatedRobot(line_map, home=BEGIN)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio, "to_thread", middleware.at_once)
        async with sim, connect_async(sim.open) as robot:
            rng = np.random.default_rng(1)
            navigator = await Navigator.on(
                robot, line_map, start=start, rng=rng, in_thread=in_thread
            )
            robot.navigator = navigator
            ready, named = asyncio.Event(), {"profile": "standard", "goal_speed": 0.6, **raw}
            node = RobotNode(robot, read_parameters(named), middleware)
            async with running(navigator.run(), node.run(ready.set)):
                await ready.wait()
                the = Going(sim, robot, navigator, middleware, free)
                the.listen("move_base/result")
                await asyncio.sleep(1.0)
                yield the


async def test_it_publishes_the_map_once_for_all() -> None:
    async with going() as the:
        await asyncio.sleep(3.0)
        (message,) = the.heard("map")
        assert the.middleware.publishers["map"].latched
        assert len(message.data) == message.info.width * message.info.height
        served = (await the.middleware.call("static_map")).map
        assert served.data == message.data
        assert len(the.heard("map_metadata")) == 1


async def test_map_odom_and_robot_are_one_chain_that_ends_where_the_robot_is() -> None:
    async with going() as the:
        the.listen("/tf")
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(6.0)
        moving = the.heard("/tf")[-1].transforms
        by_child = {each.child_frame_id: each for each in moving}
        odom, base = by_child["odom"], by_child["base_footprint"]
        assert (odom.header.frame_id, base.header.frame_id) == ("map", "odom")
        found = pose_of(odom.transform) @ pose_of(base.transform)
        assert hypot(found.x - the.here.x, found.y - the.here.y) < 0.08
        assert odom.header.stamp - base.header.stamp == pytest.approx(0.1)


def pose_of(transform: Any) -> Pose2:
    turned = 2 * atan2(transform.rotation.z, transform.rotation.w)
    return Pose2(transform.translation.x, transform.translation.y, turned)


async def test_a_goal_is_reached_and_told_of_on_the_way() -> None:
    async with going() as the:
        the.listen("move_base/feedback", "move_base/NavfnROS/plan")
        the.goal("a", 2.5, 0.0, heading=pi / 2)
        assert await the.ended() == ("a", GoalState.SUCCEEDED, "arrived")
        assert hypot(the.here.x - 2.5, the.here.y) < 0.05
        assert the.here.theta == pytest.approx(pi / 2, abs=0.06)
        states = [s.status for m in the.heard("move_base/status") for s in m.status_list]
        assert list(dict.fromkeys(states)) == [GoalState.ACTIVE, GoalState.SUCCEEDED]
        assert len(the.heard("move_base/feedback")) > 50
        ways = [each.poses for each in the.heard("move_base/NavfnROS/plan") if each.poses]
        begin, end = ways[0][0].pose.position, ways[0][-1].pose.position
        assert (begin.x, begin.y) == pytest.approx((BEGIN.x, BEGIN.y), abs=0.1)
        assert (end.x, end.y) == pytest.approx((2.5, 0.0), abs=0.01)
        await asyncio.sleep(0.5)
        assert the.heard("move_base/NavfnROS/plan")[-1].poses == []


async def test_robots_with_a_prefix_share_the_frame_of_the_map() -> None:
    async with going(frame_prefix="robot1/") as the:
        the.listen("/tf")
        the.goal("a", 0.5, 0.0, "base_link")
        _, state, text = await the.ended(1.0)
        assert state is GoalState.ABORTED
        assert "give it in map, robot1/odom or robot1/base_link" in text
        the.goal("b", 0.5, 0.0, "robot1/base_link")
        assert (await the.ended())[1] is GoalState.SUCCEEDED
        edges = {(t.header.frame_id, t.child_frame_id) for t in the.heard("/tf")[-1].transforms}
        assert {("map", "robot1/odom"), ("robot1/odom", "robot1/base_footprint")} <= edges


@pytest.mark.parametrize("profile", ["compatibility", "both"])
async def test_the_names_are_the_same_in_every_profile(profile: str) -> None:
    async with going(profile=profile) as the:
        the.goal("a", -1.5, -1.0)
        assert await the.ended() == ("a", GoalState.SUCCEEDED, "arrived")
        assert {"map", "amcl_pose", "move_base/status"} <= set(the.middleware.publishers)
        assert "static_map" in the.middleware.services


async def test_others_may_publish_the_transforms() -> None:
    async with going(tf_broadcast=False) as the:
        the.listen("/tf")
        await asyncio.sleep(1.0)
        children = {each.child_frame_id for each in the.heard("/tf")[-1].transforms}
        assert "odom" not in children
        assert "base_footprint" in children


@pytest.mark.parametrize(("frame", "x", "y"), [("base_link", 0.8, 0.0), ("odom", 0.8, 0.0)])
async def test_goals_of_other_frames_are_transformed(frame: str, x: float, y: float) -> None:
    async with going() as the:
        the.send("move_base_simple/goal", pose_stamped(x, y, f"/{frame}"))
        assert (await the.ended())[1:] == (GoalState.SUCCEEDED, "arrived")
        assert hypot(the.here.x - (BEGIN.x + 0.8), the.here.y - BEGIN.y) < 0.06


async def test_a_place_is_reached_by_its_name() -> None:
    async with going() as the:
        the.send("goal_name", SimpleNamespace(data=" kitchen "))
        assert (await the.ended())[1] is GoalState.SUCCEEDED
        assert hypot(the.here.x - 2.5, the.here.y) < 0.05
        the.send("goal_name", SimpleNamespace(data="canteen"))
        _, state, text = await the.ended(1.0)
        assert state is GoalState.ABORTED
        assert "has Kitchen" in text


async def test_a_new_goal_takes_the_place_of_the_one_before() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        the.goal("b", -2.5, 1.0)
        await the.ended(0.5)
        assert the.results == [("a", GoalState.PREEMPTED, "another goal came")]
        assert await the.ended() == ("b", GoalState.SUCCEEDED, "arrived")
        assert hypot(the.here.x + 2.5, the.here.y - 1.0) < 0.05


async def test_goals_that_come_at_once_leave_the_last_one() -> None:
    async with going() as the:
        for id_ in "abcde":
            the.goal(id_, -1.5, -1.0)
        the.goal("e", 0.0, 0.0)
        await asyncio.sleep(0.5)
        assert [(id_, state) for id_, state, _ in the.results] == [
            (id_, GoalState.PREEMPTED) for id_ in "abcd"
        ]
        assert await the.ended() == ("e", GoalState.SUCCEEDED, "arrived")
        assert hypot(the.here.x + 1.5, the.here.y + 1.0) < 0.05


async def test_a_cancel_stops_the_robot_and_a_stale_one_does_not() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        the.cancel("earlier")
        the.cancel("", Moment(500.0))
        await asyncio.sleep(0.5)
        assert the.results == []
        assert the.sim.speed > 0.1
        the.cancel("a")
        assert await the.ended(0.5) == ("a", GoalState.PREEMPTED, "cancelled")
        await asyncio.sleep(2.0)
        assert the.sim.speed == 0.0
        the.cancel("a")
        the.cancel()
        the.goal("b", -2.5, 1.0)
        assert await the.ended() == ("b", GoalState.SUCCEEDED, "arrived")


async def test_a_goal_that_was_cancelled_before_it_came_does_not_drive() -> None:
    async with going() as the:
        the.cancel("a")
        the.goal("a", 2.5, 0.0)
        assert (await the.ended(0.5))[:2] == ("a", GoalState.RECALLED)
        await asyncio.sleep(1.0)
        assert the.robot.arbiter.mode is None


@pytest.mark.parametrize(
    ("frame", "turned", "words"),
    [
        ("laser", (0.0, 1.0), "frame laser"),
        ("", (0.0, 1.0), "names no frame"),
        ("map", (0.0, 0.0), "no rotation"),
        ("map", (nan, 1.0), "no rotation"),
    ],
)
async def test_a_goal_that_is_wrong_ends_with_the_reason(
    frame: str, turned: tuple[float, float], words: str
) -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0, frame, turned=turned)
        id_, state, text = await the.ended(0.5)
        assert (id_, state) == ("a", GoalState.ABORTED)
        assert words in text
        assert words in the.middleware.warnings[-1]


async def test_a_goal_that_no_way_leads_to_ends_with_the_reason() -> None:
    async with going() as the:
        the.goal("a", 2.5, 2.9)
        _, state, text = await the.ended(1.0)
        assert state is GoalState.ABORTED
        assert "from something" in text


async def test_a_stop_ends_the_goal_and_says_so() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        the.robot.arbiter.stop(why="Ann stopped the robot")
        _, state, text = await the.ended(0.5)
        assert state is GoalState.ABORTED
        assert "Ann stopped the robot" in text
        await asyncio.sleep(2.0)
        assert the.sim.speed == 0.0


async def test_cmd_vel_comes_first_and_then_the_robot_goes_on() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        for _ in range(20):
            the.middleware.drive("cmd_vel", 0.0)
            await asyncio.sleep(0.1)
        assert the.sim.speed == 0.0
        assert the.results == []
        assert (await the.ended())[1] is GoalState.SUCCEEDED


async def test_a_lost_link_ends_the_goal() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        await the.sim.unplug()
        assert (await the.ended(6.0))[1] is GoalState.ABORTED


async def test_a_client_that_goes_leaves_its_goal() -> None:
    async with going() as the:
        the.goal("a", -1.0, -1.0)
        await asyncio.sleep(1.0)
        the.middleware.publishers["move_base/result"].subscribed = False
        await asyncio.sleep(8.0)
        assert hypot(the.here.x + 1.0, the.here.y + 1.0) < 0.05
        assert the.results == []


async def test_a_robot_that_is_not_sure_does_not_go_until_it_is_told() -> None:
    async with going(Pose2(2.5, 2.0, 1.0)) as the:
        the.listen("/tf", "/diagnostics")
        the.goal("a", 2.5, 0.0)
        _, state, text = await the.ended(5.0)
        assert state is GoalState.ABORTED
        assert "not sure where the robot is" in text
        assert the.heard("amcl_pose") == []
        assert parts(the)["Localization"].message.startswith("not sure: ")
        the.send("initialpose", start_at(BEGIN.x + 0.3, BEGIN.y, 0.1))
        await asyncio.sleep(2.0)
        last = the.heard("amcl_pose")[-1].pose.pose.position
        assert hypot(last.x - the.here.x, last.y - the.here.y) < 0.05
        assert parts(the)["Localization"].level == DiagnosticLevel.OK
        estimate = replace(the.navigator.estimate, remark="the laser looks elsewhere")
        askew, _ = navigation_status("office", estimate, None)
        assert (askew.level, askew.message) == (DiagnosticLevel.WARN, "the laser looks elsewhere")
        the.goal("b", -1.5, -1.0)
        assert (await the.ended())[1] is GoalState.SUCCEEDED


def parts(the: Going) -> dict[str, Any]:
    statuses = the.heard("/diagnostics")[-1].status
    return {each.name.removeprefix("RosAria: "): each for each in statuses}


@pytest.mark.parametrize(
    "wrong", [start_at(0.0, 0.0, frame="odom"), start_at(nan, 0.0), start_at(0.0, 0.0, nan)]
)
async def test_a_start_that_is_wrong_is_ignored(wrong: SimpleNamespace) -> None:
    async with going() as the:
        before = the.navigator.estimate.odom_in_map
        the.send("initialpose", wrong)
        await asyncio.sleep(1.0)
        assert the.navigator.estimate.sure
        assert the.navigator.estimate.odom_in_map == before
        assert the.middleware.warnings[-1].startswith("initialpose is ignored: ")


async def test_a_robot_that_may_be_anywhere_has_no_transform() -> None:
    async with going() as the:
        the.listen("/tf")
        the.free.clear()  # the search goes on and on
        assert (await the.middleware.call("global_localization")).success
        await asyncio.sleep(1.0)
        count = len(the.heard("amcl_pose"))
        await asyncio.sleep(3.0)
        children = {each.child_frame_id for each in the.heard("/tf")[-1].transforms}
        assert "odom" not in children
        assert len(the.heard("amcl_pose")) == count


async def test_odometry_that_is_set_leaves_the_robot_where_it_is_on_the_map() -> None:
    async with going() as the:
        the.goal("a", -1.0, 1.5)
        await the.ended()
        assert (await the.middleware.call("reset_odometry")).success
        await asyncio.sleep(2.0)
        assert the.navigator.estimate.sure
        found = the.navigator.estimate.robot_in_map
        assert found is not None
        assert hypot(found.x - the.here.x, found.y - the.here.y) < 0.05
        the.goal("b", 2.5, 0.0)
        assert (await the.ended())[1] is GoalState.SUCCEEDED


async def test_diagnostics_tell_of_the_goal() -> None:
    async with going() as the:
        the.listen("/diagnostics")
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(4.0)
        told = parts(the)["Navigation"]
        values = {pair.key: pair.value for pair in told.values}
        assert told.message == "on the way to (2.50, 0.00)"
        assert 1.0 < float(values["left"]) < 6.5
        await the.ended()
        await asyncio.sleep(1.5)
        assert parts(the)["Navigation"].message == "no goal"


async def test_a_latched_goal_from_before_the_node_does_not_drive() -> None:
    async with going() as the:
        old = Sender("/rostopic_1", object(), latched=True)
        the.send("goal_name", SimpleNamespace(data="Kitchen"), old)
        await asyncio.sleep(3.0)
        assert the.robot.arbiter.mode is None
        assert "goal of /rostopic_1 is ignored" in the.middleware.warnings[-1]
        the.send("goal_name", SimpleNamespace(data="Kitchen"), old)
        await asyncio.sleep(2.0)
        assert the.robot.arbiter.mode is not None


async def test_the_end_of_the_node_ends_the_goal() -> None:
    async with going() as the:
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(3.0)
        the.middleware.shut_down()
        await asyncio.sleep(2.0)
        assert the.results == [("a", GoalState.ABORTED, "the node ends")]
        assert the.sim.speed == 0.0


async def test_a_plan_is_made_and_nothing_drives() -> None:
    async with going() as the:
        here = pose_stamped(0.0, 0.0, frame="", turned=(0.0, 0.0))
        asked = {"start": here, "goal": pose_stamped(2.5, 0.0, heading=pi / 2), "tolerance": 0.0}
        plan = (await the.middleware.call("move_base/make_plan", **asked)).plan
        begin, end = plan.poses[0].pose, plan.poses[-1].pose
        assert plan.header.frame_id == "map"
        assert (begin.position.x, begin.position.y) == pytest.approx((BEGIN.x, BEGIN.y), abs=0.1)
        assert (end.position.x, end.position.y) == pytest.approx((2.5, 0.0), abs=0.01)
        assert end.orientation.z == pytest.approx(sin(pi / 4))
        asked["start"] = pose_stamped(2.5, 1.0)
        other = (await the.middleware.call("move_base/make_plan", **asked)).plan
        assert other.poses[0].pose.position.y == pytest.approx(1.0, abs=0.1)
        assert len(other.poses) < len(plan.poses) / 2
        assert the.robot.arbiter.mode is None


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (pose_stamped(2.5, 2.9), "from something"),
        (pose_stamped(2.5, 0.0, frame="laser"), "frame laser"),
        (pose_stamped(2.5, 0.0, turned=(0.0, 0.0)), "no rotation"),
    ],
)
async def test_without_a_way_the_plan_is_empty_and_the_log_says_why(
    goal: SimpleNamespace, words: str
) -> None:
    async with going() as the:
        asked = {"start": pose_stamped(0.0, 0.0, frame=""), "goal": goal, "tolerance": 0.0}
        assert (await the.middleware.call("move_base/make_plan", **asked)).plan.poses == []
        assert words in the.middleware.warnings[-1]


def close_the_door(the: Going) -> Any:
    return the.sim.world.add_obstacle(Box(pose=Pose2(0.0, 1.5), size=(0.2, 1.0)))


async def test_a_goal_behind_a_door_that_is_closed_is_reached_once_it_opens() -> None:
    async with going() as the:
        door = close_the_door(the)
        await asyncio.sleep(2.0)
        the.goal("a", 2.5, 0.0)
        await asyncio.sleep(8.0)
        assert the.results == []
        assert the.here.x < 0.0
        the.sim.world.remove_obstacle(door)
        assert await the.ended() == ("a", GoalState.SUCCEEDED, "arrived")


async def test_clearing_the_costmaps_forgets_a_door_that_is_closed() -> None:
    async with going() as the:
        door = close_the_door(the)
        await asyncio.sleep(2.0)
        asked = {"start": pose_stamped(0.0, 0.0, frame=""), "goal": pose_stamped(2.5, 0.0)}
        await the.middleware.call("move_base/make_plan", **asked)
        assert "is closed" in the.middleware.warnings.pop()
        the.sim.world.remove_obstacle(door)
        assert (await the.middleware.call("move_base/clear_costmaps")).success
        plan = (await the.middleware.call("move_base/make_plan", **asked)).plan
        assert plan.poses
        assert the.middleware.warnings == []


async def test_a_named_dock_is_reached_when_its_charger_has_answered() -> None:
    dock = MapObject(kind="Dock", name="Dock", pose=Pose2(-2.5, 1.0, pi / 2))
    async with going(line_map=replace(ROOMS, objects=(*ROOMS.objects, dock))) as the:
        the.send("goal_name", SimpleNamespace(data="dock"))
        await until(lambda: the.robot.arbiter.mode is not None, 5.0)
        await until(lambda: the.robot.arbiter.mode is None, 40.0)
        arrived = asyncio.get_running_loop().time()
        assert await the.ended() == (the.results[-1][0], GoalState.SUCCEEDED, "arrived")
        snapshot = the.robot.snapshot
        assert snapshot is not None
        waited = asyncio.get_running_loop().time() - arrived
        assert snapshot.battery.charging not in (Charging.NONE, Charging.UNKNOWN)
        assert waited < 5.0
