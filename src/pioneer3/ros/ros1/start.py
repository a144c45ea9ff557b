"""Starts the ROS 1 node: ROS, parameters, robot, in this order, and ends it in the other."""

import asyncio
import gc
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager, suppress
from functools import partial
from typing import Final

from pioneer3.errors import NoRobotError
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.robot.supervisor import is_simulator
from pioneer3.ros.addresses import Addresses, addresses, wait_for_master
from pioneer3.ros.node.laser_node import FRAME, LaserNode
from pioneer3.ros.node.laser_parameters import read_laser_parameters, unused_laser_parameters
from pioneer3.ros.node.names import NODE, lab_node
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import TF_PREFIX
from pioneer3.ros.node.parameters import MODEL, SIMULATED
from pioneer3.ros.node.start import StartOptions, checked_parameters, connected_robot
from pioneer3.ros.ros1.arguments import Ros1Arguments, parse
from pioneer3.ros.ros1.environment import MASTER, checked_master, environment_warnings
from pioneer3.ros.ros1.middleware import Ros1Middleware
from pioneer3.ros.tcpros.answers import MasterRefusalError
from pioneer3.ros.tcpros.master import LOST, Api
from pioneer3.ros.tcpros.node import Ros1Node, ros1_node
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.tasks import running

LAB_NAME: Final = "_lab_name:="
LASER_NODE: Final = "laser"
log = logging.getLogger("rosout")


@asynccontextmanager
async def on_ros(
    name: str, arguments: Sequence[str], tell: Callable[[str], None]
) -> AsyncIterator[tuple[Ros1Node, Ros1Types, Ros1Arguments]]:
    """Be a node during the block; `tell` is given lines for a person.

    `name` is that of the node, unless ROS's own `arguments` have another.

    Raises:
        ConfigError: an argument is none of ROS's, or ROS_MASTER_URI is no address.
        NoRobotError: this computer does not have the address that it is to listen on.
    """
    given = parse(arguments, name)
    at = checked_addresses(given)
    for sentence in await asyncio.to_thread(environment_warnings, given.environment):
        tell(f"WARN {sentence}")
    types = await asyncio.to_thread(Ros1Types)
    await wait_for_master(at.master, tell)
    warn = partial(log.warning, "%s")
    async with ros1_node(given.node, at, warn, graph=False, replaces=True) as node:
        yield node, types, given


def checked_addresses(arguments: Ros1Arguments) -> Addresses:
    """Return the addresses by arguments and variables; ConfigError if one is wrong."""
    checked_master(arguments.environment.get(MASTER, ""))
    return addresses(None, arguments.environment)


@asynccontextmanager
async def _middleware(
    name: str, arguments: Sequence[str], tell: Callable[[str], None]
) -> AsyncIterator[tuple[Ros1Middleware, Callable[[], None]]]:
    """Yield the middleware of a node, and the function to call when all is advertised.

    The arguments are those of :func:`on_ros`.
    """
    ready = asyncio.Event()
    async with on_ros(name, arguments, tell) as (node, types, given):
        middleware = Ros1Middleware(node, types, given)

        async def announce() -> None:
            await ready.wait()
            await node.settle()
            tell(f"node {node.name} on {node.master.uri}")
            await middleware.tell_unused_rules()

        try:
            with _needing(node.master):
                await middleware.begin()
            async with running(announce()):
                yield middleware, ready.set
        finally:
            middleware.end()
            await _forget(node, given)


async def serve(options: StartOptions, tell: Callable[[str], None]) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    name = node_name(options.arguments)
    async with _middleware(name, options.arguments, tell) as (middleware, ready):
        node = middleware.node
        with _needing(node.master):
            raw = await _private(node)
            with suppress(MasterRefusalError):  # there is none
                above = await node.master.call("searchParam", TF_PREFIX)
                raw = {TF_PREFIX: await node.get(above)} | raw
        parameters = checked_parameters(raw, options.laser_ports, middleware.warn)
        gc.freeze()  # else all that was imported is searched for garbage again and again
        async with connected_robot(options, parameters, tell) as robot:
            said = {MODEL: robot.info.model.name, SIMULATED: is_simulator(robot.info)}
            with _needing(node.master):
                for key, value in said.items():
                    await node.master.call("setParam", f"{node.name}/{key}", value)
            robot_node = RobotNode(robot, parameters, middleware)
            node.on_registered = partial(asyncio.to_thread, robot_node.describe_robot)
            await robot_node.run(ready)
    return 0


@contextmanager
def _needing(master: Api) -> Iterator[None]:
    """Raise NoRobotError if the master is lost in the block."""
    try:
        yield
    except LOST as error:
        raise NoRobotError(f"the ROS master at {master.uri} is lost: {error}") from error


async def _private(node: Ros1Node) -> dict[str, object]:
    """Return the parameters below the node's name."""
    found = await node.get(node.name, {})
    return found if isinstance(found, dict) else {}


def node_name(arguments: Sequence[str]) -> str:
    """Return RosAria's name, or the lab's one of `_lab_name:=`; ConfigError if that is none."""
    given = [each.removeprefix(LAB_NAME) for each in arguments if each.startswith(LAB_NAME)]
    return lab_node(given[-1]) if given else NODE


async def _forget(node: Ros1Node, given: Ros1Arguments) -> None:
    """Delete the parameters that were for this run only: they would hold for the next one."""
    with suppress(*LOST):
        for name in (*given.parameters, MODEL, SIMULATED):
            with suppress(MasterRefusalError):  # there is none
                await _delete(node, given.full(f"~{name}"))


async def _delete(node: Ros1Node, name: str) -> None:
    """Delete a parameter, and the folders of parameters that are empty without it."""
    await node.master.call("deleteParam", name)
    folder = name.rpartition("/")[0]
    if folder and await node.get(folder) == {}:
        await _delete(node, folder)


async def serve_laser(
    arguments: Sequence[str],
    find: Callable[[Sequence[str]], Awaitable[Sequence[LaserSpec]]],
    tell: Callable[[str], None],
) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    `find` looks for the laser, given its port if the parameters have one. Raises PioneerError if
    something could not be started; the message says what to do.
    """
    async with _middleware(LASER_NODE, arguments, tell) as (middleware, ready):
        with _needing(middleware.node.master):
            raw = await _private(middleware.node)
        parameters = read_laser_parameters(raw)
        for sentence in unused_laser_parameters(raw):
            middleware.warn(sentence)
        spec = parameters.applied_to(await find(parameters.ports))[0]
        tell(f"laser at {spec.url}")
        driver = LaserDriver(spec.config(), mounting=lambda: spec.mounting_on(None))
        await LaserNode(driver, parameters.frame_id.lstrip("/") or FRAME, middleware).run(ready)
    return 0
