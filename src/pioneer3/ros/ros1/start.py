"""Starts the ROS 1 node: ROS, parameters, robot, in this order, and ends it in the other."""

import asyncio
import gc
import logging
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from logging.handlers import QueueHandler, QueueListener
from queue import Full, Queue
from threading import Thread
from typing import Final
from urllib.parse import urlsplit

from pioneer3.errors import ConfigError
from pioneer3.names import printable
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.robot.supervisor import RobotInfo, is_simulator
from pioneer3.ros.addresses import LOCAL, LOOPBACK, wait_for_master
from pioneer3.ros.node.laser_node import FRAME, LaserNode
from pioneer3.ros.node.laser_parameters import read_laser_parameters, unused_laser_parameters
from pioneer3.ros.node.names import NODE, lab_node
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import TF_PREFIX
from pioneer3.ros.node.parameters import MODEL, SIMULATED
from pioneer3.ros.node.start import StartOptions, checked_parameters, connected_robot
from pioneer3.ros.ros1.environment import checked_master, environment_warnings
from pioneer3.ros.ros1.master import MasterWatch
from pioneer3.ros.ros1.middleware import RospyMiddleware, find_move_base, find_rospy

LAB_NAME: Final = "_lab_name:="
LONGEST_QUEUE: Final = 100
"""Records that wait while the master is silent; further ones are on the terminal only."""


@asynccontextmanager
async def on_ros(
    name: str, arguments: Sequence[str], tell: Callable[[str], None]
) -> AsyncIterator[MasterWatch]:
    """Be a ROS node during the block; `tell` is given lines for a person.

    `name` is that of the node, unless ROS's own `arguments` have another. Raises ConfigError if an
    argument is none of ROS's, ROS is not installed, or ROS_MASTER_URI is no address.
    """
    odd = [argument for argument in arguments if ":=" not in argument]
    if odd:
        raise ConfigError(
            f"{odd[0]!r} is none of ROS's arguments, such as _port:=/dev/ttyS0, and no command:"
            " pioneer3 ros1 --help lists those"
        )
    find_rospy()
    import rosgraph
    import rospy

    master = checked_master(rosgraph.get_master_uri())
    for sentence in await asyncio.to_thread(environment_warnings):
        tell(f"WARN {sentence}")
    await wait_for_master(master, tell)
    await begin_node(name, arguments, master)
    watch = MasterWatch(rospy.get_name(), rospy.logwarn)
    try:
        yield watch
    finally:
        watch.stop()
        await asyncio.to_thread(_forget, arguments)
        rospy.signal_shutdown("the program ends")


def announce(middleware: RospyMiddleware, tell: Callable[[str], None]) -> None:
    """Tell the names of the node and its master, and warn of remappings that change nothing."""
    import rosgraph
    import rospy

    tell(f"node {rospy.get_name()} on {rosgraph.get_master_uri()}")
    Thread(target=middleware.tell_unused_rules, name="unused remappings", daemon=True).start()


async def serve(options: StartOptions, tell: Callable[[str], None]) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with on_ros(node_name(options.arguments), options.arguments, tell) as watch:
        import rospy

        raw = rospy.get_param("~", {})
        if above := rospy.search_param(TF_PREFIX):
            raw = {TF_PREFIX: rospy.get_param(above)} | raw
        parameters = checked_parameters(raw, options.laser_ports, rospy.logwarn)
        watch.start()
        if options.line_map or parameters.map:
            find_move_base()
        gc.freeze()  # else all that was imported is searched for garbage again and again
        async with connected_robot(options, parameters, tell) as robot:
            await asyncio.to_thread(_introduce, robot.info)
            middleware = RospyMiddleware()
            node = RobotNode(robot, parameters, middleware)
            watch.on_registered = node.describe_robot
            await node.run(lambda: announce(middleware, tell))
    return 0


def node_name(arguments: Sequence[str]) -> str:
    """Return RosAria's name, or the lab's one of `_lab_name:=`; ConfigError if that is none."""
    given = [each.removeprefix(LAB_NAME) for each in arguments if each.startswith(LAB_NAME)]
    return lab_node(given[-1]) if given else NODE


async def begin_node(name: str, arguments: Sequence[str], master: str) -> None:
    """Be a node of rospy from now on."""
    import rospy

    stay_on_this_computer(master)
    argv = ["pioneer3", *arguments]
    await asyncio.to_thread(rospy.init_node, name, argv=argv, disable_signals=True)
    log_in_background()


def stay_on_this_computer(master: str) -> None:
    """Listen on loopback only, unless the environment says otherwise or the master is elsewhere."""
    chosen = os.environ.keys() & {"ROS_IP", "ROS_HOSTNAME"}
    if not chosen and urlsplit(master).hostname in LOOPBACK:
        os.environ["ROS_IP"] = LOCAL


class BoundedQueueHandler(QueueHandler):
    """Puts records into a queue; drops those that find it full."""

    def enqueue(self, record: logging.LogRecord) -> None:
        """Put a record into the queue if there is room."""
        try:
            self.queue.put_nowait(record)
        except Full:
            return


def _on_one_line(record: logging.LogRecord) -> bool:
    """Let a terminal obey nothing in a record."""
    record.msg, record.args = printable(record.getMessage()), None
    return True


def log_in_background() -> None:
    """Let a thread of its own publish the records of rospy; `rospy.init_node` comes first.

    rospy asks the master for a parameter whenever something is logged, without a timeout: in a
    network that is cut, the thread that logs a warning hangs. That must not be the one that stops
    the robot. Records are on the terminal at once, as before.
    """
    from rospy.impl.rosout import RosOutHandler

    log = logging.getLogger("rosout")
    log.addFilter(_on_one_line)
    publishers = [each for each in log.handlers if isinstance(each, RosOutHandler)]
    if not publishers:
        return
    waiting: Queue[logging.LogRecord] = Queue(LONGEST_QUEUE)
    for each in publishers:
        log.removeHandler(each)
    log.addHandler(BoundedQueueHandler(waiting))
    QueueListener(waiting, *publishers).start()  # a daemon: it may hang when the program ends


def _introduce(info: RobotInfo) -> None:
    """Let programs know the robot's model, and whether it is a simulator."""
    import rospy

    rospy.set_param(f"~{MODEL}", info.model.name)
    rospy.set_param(f"~{SIMULATED}", is_simulator(info))


def _forget(arguments: Sequence[str]) -> None:
    """Delete the parameters that were for this run only: they would hold for the next one."""
    private = [each[1:] for each in arguments if each.startswith("_") and each[1:2] != "_"]
    for name in (*(each.partition(":=")[0] for each in private), MODEL, SIMULATED):
        _delete(f"~{name}")


def _delete(name: str) -> None:
    """Delete a parameter, and the folders of parameters that are empty without it."""
    import rospy

    with suppress(OSError, KeyError, rospy.ROSException):
        full = rospy.resolve_name(name)
        rospy.delete_param(full)
        folder = full.rpartition("/")[0]
        if folder and rospy.get_param(folder, None) == {}:
            _delete(folder)


LASER_NODE: Final = "laser"


async def serve_laser(
    arguments: Sequence[str],
    find: Callable[[Sequence[str]], Awaitable[Sequence[LaserSpec]]],
    tell: Callable[[str], None],
) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    `find` looks for the laser, given its port if the parameters have one. Raises PioneerError if
    something could not be started; the message says what to do.
    """
    async with on_ros(LASER_NODE, arguments, tell) as watch:
        import rospy

        raw = rospy.get_param("~", {})
        parameters = read_laser_parameters(raw)
        for sentence in unused_laser_parameters(raw):
            rospy.logwarn(sentence)
        watch.start()
        spec = parameters.applied_to(await find(parameters.ports))[0]
        tell(f"laser at {spec.url}")
        driver = LaserDriver(spec.config(), mounting=lambda: spec.mounting_on(None))
        middleware = RospyMiddleware()
        node = LaserNode(driver, parameters.frame_id.lstrip("/") or FRAME, middleware)
        await node.run(lambda: announce(middleware, tell))
    return 0
