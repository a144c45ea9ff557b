"""Starts the ROS 2 node: backend, parameters, robot, in this order, and ends it in the other."""

import asyncio
import gc
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Final

from pioneer3.errors import ConfigError, LinkError
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.start import StartOptions, checked_parameters, connected_robot
from pioneer3.ros.ros2.arguments import RosArguments, parse
from pioneer3.ros.ros2.backend import Backend, NodeName
from pioneer3.ros.ros2.managed import ManagedRobot
from pioneer3.ros.ros2.middleware import Ros2Middleware
from pioneer3.ros.ros2.names import node_name
from pioneer3.ros.ros2.network import Network, open_backend
from pioneer3.ros.ros2.remapping import Remapping
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import hand_over

NODE: Final = "pioneer3"
OF_TF: Final = ("tf", "tf_static")


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeOptions:
    """The options of a node of ROS 2; a name in the arguments after `--ros-args` comes first."""

    name: str = NODE
    namespace: str = "/"
    network: Network = field(default_factory=Network)
    arguments: tuple[str, ...] = ()


@asynccontextmanager
async def on_ros2(
    options: NodeOptions, tell: Callable[[str], None]
) -> AsyncIterator[tuple[Backend, NodeName, MessageTypes, RosArguments]]:
    """Be a node during the block; `tell` is given lines for a person.

    Raises:
        ConfigError: an argument is wrong, or a library is missing.
        LinkError: the network is lost for good; the block is cancelled.
    """
    node = node_name(options.name, options.namespace)
    arguments = parse(options.arguments, node)
    node = node_name(arguments.name or node.name, arguments.namespace or node.namespace)
    types = await asyncio.to_thread(MessageTypes, options.network.distro_here())
    backend = await asyncio.to_thread(open_backend, options.network, node, types)
    try:
        if reason := await asyncio.to_thread(options.network.obstacle):
            tell(f"note: {reason}")
        tell(f"node {node.full} of ROS 2 {types.distro.name} by {backend.title}")
        if backend.lacks:
            tell(f"note: {backend.lacks}")
        async with _until_failure(backend):
            yield backend, node, types, arguments
    finally:
        await asyncio.to_thread(backend.close)


@asynccontextmanager
async def _until_failure(backend: Backend) -> AsyncIterator[None]:
    """Cancel the block when the backend fails; LinkError tells of that."""
    task, loop = asyncio.current_task(), asyncio.get_running_loop()
    assert task is not None
    reasons: list[str] = []
    is_over = False

    def end(reason: str) -> None:
        if not is_over:
            reasons.append(reason)
            task.cancel()

    def failed(reason: str) -> None:
        hand_over(loop, end, reason)

    backend.on_failure(failed)
    try:
        yield
    except asyncio.CancelledError:
        if not reasons or task.uncancel():
            raise
        raise LinkError(reasons[0]) from None
    finally:
        is_over = True


async def serve(node: NodeOptions, options: StartOptions, tell: Callable[[str], None]) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with on_ros2(node, tell) as (backend, name, types, arguments):
        middleware = Ros2Middleware(backend, name, types, arguments, lambda s: tell(f"WARN {s}"))
        parameters = checked_parameters(
            arguments.raw, options.laser_ports, middleware.warn, Profile.ROS2
        )
        if parameters.enable_stamped_cmd_vel is None:
            parameters = replace(parameters, enable_stamped_cmd_vel=types.distro.stamped_commands)
        if parameters.frame_prefix:  # names of frames differ: one tree for all robots
            middleware.add_rules(*(Remapping(topic, f"/{topic}") for topic in OF_TF))
        if not (parameters.autostart or backend.serves):
            raise ConfigError(
                "autostart is false, but nobody could start the node: it has no services by"
                f" {backend.title}; take another --backend, or let it start itself"
            )
        if parameters.use_sim_time:
            await asyncio.to_thread(middleware.use_sim_time)

        async def run(robot: Robot, ready: Callable[[], None]) -> None:
            def tell_ready() -> None:
                tell("ready; Ctrl-C ends it and stops the robot")
                ready()

            await RobotNode(robot, parameters, middleware).run(tell_ready)

        managed = ManagedRobot(lambda: connected_robot(options, parameters, tell), run, tell)
        lifecycle = await asyncio.to_thread(middleware.lifecycle, managed.callbacks)
        middleware.keep()
        gc.freeze()  # else all that was imported is searched for garbage again and again
        await managed.serve(lifecycle, autostart=parameters.autostart)
    return 0
