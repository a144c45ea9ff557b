"""The life cycle of the node, as a lifecycle manager of ROS 2 sees and changes it."""

import asyncio
import signal
from functools import partial

import pytest

from pioneer3.ros.ros2.backend import EndpointKind
from pioneer3.ros.ros2.lifecycle import LifecycleState
from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import Command, free_port, running, until
from tests.ros2.conftest import robot_on
from tests.ros2.networks import Peer, Ros2, network_of
from tests.ros2.test_node import drive

pytestmark = pytest.mark.realtime
ASLEEP = ("--ros-args", "-p", "autostart:=false")


async def change(peer: Peer, label: str, name: str = "/pioneer3") -> bool:
    """Ask for a transition; return whether it succeeded."""
    transition = peer.types.make("lifecycle_msgs/Transition")
    transition.label = label
    response = await peer.call(
        f"{name}/change_state", "lifecycle_msgs/ChangeState", transition=transition
    )
    return bool(response.success)


async def state(peer: Peer) -> LifecycleState:
    """Return the state of the node."""
    response = await peer.call("/pioneer3/get_state", "lifecycle_msgs/GetState")
    assert response.current_state.label == LifecycleState(response.current_state.id).label
    return LifecycleState(response.current_state.id)


async def line_with(node: Command, words: str) -> None:
    said = ""
    while words not in said:
        said = await node.line()
        assert said, await node.end()


async def test_a_node_starts_itself_and_is_active() -> None:
    async with (
        network_of(BackendName.ZENOH) as network,
        robot_on(network) as robot,
        network.peer() as peer,
    ):
        assert await state(peer) is LifecycleState.ACTIVE
        publisher = peer.publisher("/cmd_vel", "geometry_msgs/Twist")
        await until(lambda: publisher.matched)
        publisher.write(peer.twist(0.3))
        await until(lambda: not robot.tap.now.is_zero)
        assert await change(peer, "deactivate")
        assert robot.tap.now.is_zero
        await line_with(robot.node, "inactive")
        publisher.write(peer.twist(0.3))
        assert await state(peer) is LifecycleState.INACTIVE
        await asyncio.sleep(0.5)
        assert robot.tap.now.is_zero
        assert await change(peer, "activate")
        assert robot.tap.now.is_zero
        await drive(peer, 0.3, 0.5)
        assert any(twist.v > 0.2 for _, twist in robot.tap.velocities)
        assert await change(peer, "shutdown")
        assert robot.tap.now.is_zero
        assert await state(peer) is LifecycleState.FINALIZED
        assert not await change(peer, "configure")
        code, _ = await robot.node.end(signal.SIGINT)
        assert code == 130


async def test_a_manager_starts_a_node_and_ends_it() -> None:
    async with (
        network_of(BackendName.ZENOH) as network,
        running("sim", "--ideal", "--nomap", "--port", "0") as simulator,
        network.peer() as peer,
    ):
        port = (await simulator.line()).split()[-1]
        events = peer.hear("/pioneer3/transition_event", "lifecycle_msgs/TransitionEvent")
        async with running("ros2", "--port", port, *network.options, *ASLEEP) as node:
            await line_with(node, "unconfigured")
            await until(
                partial(
                    peer.knows, "/pioneer3/transition_event", EndpointKind.PUBLISHER, "/pioneer3"
                )
            )
            assert await state(peer) is LifecycleState.UNCONFIGURED
            assert peer.endpoint("/odom") is None
            assert not await change(peer, "activate")
            for _ in range(2):
                assert await change(peer, "configure")
                assert await state(peer) is LifecycleState.INACTIVE
                assert peer.endpoint("/odom") is None
                assert await change(peer, "activate")
                await until(partial(peer.knows, "/odom", EndpointKind.PUBLISHER, "/pioneer3"))
                assert await change(peer, "deactivate")
                assert await change(peer, "cleanup")
                await until(lambda: peer.endpoint("/odom") is None)
            assert await state(peer) is LifecycleState.UNCONFIGURED
            assert [event.goal_state.label for _, event in events[:4]] == [
                "configuring",
                "inactive",
                "activating",
                "active",
            ]
            stamps = [event.timestamp for _, event in events]
            assert stamps == sorted(stamps)
            assert stamps[0] > 0


async def test_a_robot_that_is_not_there_yet_leaves_the_node_unconfigured() -> None:
    async with network_of(BackendName.ZENOH) as network, network.peer() as peer:
        port = free_port()
        robot = f"tcp://127.0.0.1:{port}"
        async with running("ros2", "--port", robot, *network.options, *ASLEEP) as node:
            await line_with(node, "unconfigured")
            await until(
                partial(
                    peer.knows, "/pioneer3/transition_event", EndpointKind.PUBLISHER, "/pioneer3"
                )
            )
            assert not await change(peer, "configure")
            await line_with(node, "not configured")
            assert await state(peer) is LifecycleState.UNCONFIGURED
            async with running("sim", "--nomap", "--port", str(port)) as simulator:
                await simulator.line()
                assert await change(peer, "configure")
                assert await change(peer, "shutdown")


async def test_a_node_that_cannot_be_activated_stays_inactive() -> None:
    wrong = ("-p", "qos_overrides./odom.publisher.reliability:=besteffort")
    async with (
        network_of(BackendName.ZENOH) as network,
        running("sim", "--nomap", "--port", "0") as simulator,
        network.peer() as peer,
    ):
        port = (await simulator.line()).split()[-1]
        async with running("ros2", "--port", port, *network.options, *ASLEEP, *wrong) as node:
            await line_with(node, "unconfigured")
            await until(
                partial(
                    peer.knows, "/pioneer3/transition_event", EndpointKind.PUBLISHER, "/pioneer3"
                )
            )
            assert await change(peer, "configure")
            assert not await change(peer, "activate")
            await line_with(node, "not activated")
            assert await state(peer) is LifecycleState.INACTIVE
            assert await change(peer, "cleanup")


async def test_a_node_that_nobody_could_start_says_so(ros2: Ros2) -> None:
    if ros2.network.backend is not BackendName.DDS:
        pytest.skip("has services")
    async with running("ros2", *ros2.options, *ASLEEP) as node:
        code, said = await node.end()
        assert code == 2
        assert "--backend" in said
