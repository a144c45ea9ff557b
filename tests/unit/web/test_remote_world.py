"""What a simulator in another program tells of its world, over cables in memory."""

import pytest

from pioneer3 import connect_async
from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import load_map, load_world
from pioneer3.tasks import running
from pioneer3.web.scene import RemoteWorld
from tests.support import SimulatedRobot, until, wall_at

HOME = Pose2(1.0, 1.5, 0.5)


@pytest.mark.realtime
async def test_map_and_true_pose_are_known_again_after_the_link_was_lost() -> None:
    told: list[str] = []
    async with (
        SimulatedRobot(load_map("office"), home=HOME) as sim,
        connect_async(sim.open) as robot,
    ):
        elsewhere = RemoteWorld(robot, None, told.append)
        async with running(elsewhere.follow()):
            await until(lambda: elsewhere.map and elsewhere.pose)
            first = elsewhere.map
            assert first is not None
            assert first.name == "office"
            assert elsewhere.pose is not None
            assert (elsewhere.pose.x, elsewhere.pose.y) == pytest.approx((1.0, 1.5), abs=0.002)
            assert elsewhere.pose.theta == pytest.approx(0.5, abs=0.01)
            await sim.unplug()
            await until(lambda: elsewhere.pose is None)
            sim.world.change_map(load_world("lab").line_map())
            sim.body.robot_in_world = Pose2(3.0, 2.0, 0.0)
            sim.plugged = True
            await until(lambda: elsewhere.pose and elsewhere.map is not first)
            assert elsewhere.map is not None
            assert elsewhere.map.name == "lab"
            assert elsewhere.pose.x == pytest.approx(3.0, abs=0.002)
    assert told == []


@pytest.mark.realtime
async def test_a_map_that_is_not_here_is_pointed_out_and_a_given_one_stays() -> None:
    told: list[str] = []
    given = load_map("office")
    async with SimulatedRobot(wall_at(2.0)) as sim, connect_async(sim.open) as robot:
        ours, theirs = (
            RemoteWorld(robot, given, told.append),
            RemoteWorld(robot, None, told.append),
        )
        async with running(ours.follow(), theirs.follow()):
            await until(lambda: told and ours.pose)
    assert told == [
        "The simulator's map is not shown: there is no map 'wall' here; give it with --map"
    ]
    assert ours.map is given
    assert theirs.map is None
