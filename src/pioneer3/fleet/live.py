"""The state of all robots now: asked side by side, and no host waited for longer than the rest."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from struct import unpack
from types import MappingProxyType
from typing import Final

from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.reports.sip import SipFlag
from pioneer3.doctor.probe_session import ProbeSession
from pioneer3.errors import LinkError, NoRobotError, PioneerError
from pioneer3.fleet.ros_graph import MASTER_PORT, MasterGraph, NodeAddress, RosGraphError
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.ssh_settings import SSH_PORT
from pioneer3.links.stream import open_tcp
from pioneer3.units import DECIVOLT

log = logging.getLogger(__name__)
TIMEOUT: Final = 3.0
"""For each answer [s]."""
LEEWAY: Final = 0.5
"""To join a network of ROS 2, whose robots are then waited for [s]."""
LONGEST_BANNER: Final = 255
"""Longest banner of ssh [bytes] (RFC 4253, 4.2)."""


@dataclass(frozen=True, slots=True)
class SshAnswer:
    """An answer in a few words; `ok` if it is the wanted one, `None` where nobody was asked."""

    ok: bool | None
    said: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """The answers of a robot and its computer, which took some `seconds`.

    The `driver` is the robot's own port or its ROS node, and `ros` the ROS master that knows it, or
    the network of ROS 2. What nobody told is `None`: the `battery` [V], whether the motors have
    power, whether its emergency stop is latched or its button pressed, the `age` of its newest
    odometry over ROS 2 [s], and how far its clock is ahead of this computer's [s].
    """

    robot: str
    up: SshAnswer
    ssh: SshAnswer
    driver: SshAnswer
    ros: SshAnswer
    battery: float | None = None
    motors: bool | None = None
    stopped: bool | None = None
    age: float | None = None
    clock: float | None = None
    seconds: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class OnTopics:
    """The state of a robot by its topics of ROS 2, as in :class:`Live`, on a network.

    The `age` is by its clock and this computer's, and `nodes` the number of those of its name.
    """

    network: str
    battery: float | None = None
    motors: bool | None = None
    stopped: bool | None = None
    age: float | None = None
    nodes: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Questions:
    """How robots are asked, with a timeout for each answer [s].

    ROS masters are asked before the robot's own, with the addresses of hosts by their names in
    lower case. `ros2` asks a robot's topics, and is given the longest time for an answer [s], too;
    `clock` returns how far a robot's clock is ahead [s], and is `None` to leave clocks alone.
    """

    timeout: float = TIMEOUT
    masters: tuple[NodeAddress, ...] = ()
    addresses: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    ros2: Callable[[FleetRobot, float], Awaitable[OnTopics]] | None = None
    clock: Callable[[FleetRobot], Awaitable[float]] | None = None
    ssh_port: int = SSH_PORT
    master_port: int = MASTER_PORT


async def look(robots: Sequence[FleetRobot], questions: Questions) -> tuple[Live, ...]:
    """Return the state of all `robots`, in their order."""
    return tuple(await asyncio.gather(*(look_at(robot, questions) for robot in robots)))


async def look_at(robot: FleetRobot, questions: Questions) -> Live:
    """Return the state of one robot."""
    clock = asyncio.get_running_loop().time
    began = clock()
    (up, ssh), told, ahead = await asyncio.gather(
        _ssh(robot, questions), _driver(robot, questions), _clock(robot, questions)
    )
    if ahead is not None:
        up = ssh = SshAnswer(True, "yes")  # at another port, or by way of another computer
    if not up.ok and (told.driver.ok or (told.ros.ok and robot.ros == "1")):
        up = SshAnswer(True, "yes")  # a firewall that lets ssh go unanswered
    return Live(
        robot=robot.name,
        up=up,
        ssh=ssh,
        driver=told.driver,
        ros=told.ros,
        battery=told.battery,
        motors=told.motors,
        stopped=told.stopped,
        age=None if told.age is None else told.age + (ahead or 0.0),
        clock=ahead,
        seconds=clock() - began,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Told:
    """The answer of the robot's port or node."""

    driver: SshAnswer
    ros: SshAnswer = SshAnswer(None, "")
    battery: float | None = None
    motors: bool | None = None
    stopped: bool | None = None
    age: float | None = None


async def _ssh(robot: FleetRobot, questions: Questions) -> tuple[SshAnswer, SshAnswer]:
    """Return whether the computer is up, and its ssh server; a refusal is an answer too."""
    try:
        async with asyncio.timeout(questions.timeout):
            reader, writer = await asyncio.open_connection(robot.address, questions.ssh_port)
    except ConnectionRefusedError:
        return SshAnswer(True, "yes"), SshAnswer(False, "refused")
    except TimeoutError:
        return SshAnswer(False, "no answer"), SshAnswer(False, "")
    except OSError as error:
        return SshAnswer(False, (error.strerror or str(error)).lower()), SshAnswer(False, "")
    try:
        async with asyncio.timeout(questions.timeout):
            banner = await reader.read(LONGEST_BANNER)
    except TimeoutError:
        return SshAnswer(True, "yes"), SshAnswer(False, "silent")
    except OSError:
        banner = b""
    finally:
        writer.transport.abort()
    if banner.startswith(b"SSH-"):
        return SshAnswer(True, "yes"), SshAnswer(True, "yes")
    return SshAnswer(True, "yes"), SshAnswer(False, "hung up" if not banner else "not ssh")


async def _driver(robot: FleetRobot, questions: Questions) -> _Told:
    """Ask the ROS node of the robot, or else its own port; a node has the port to itself."""
    if robot.ros == "1":
        return await _node(robot, questions)
    if robot.ros == "2":
        return await _topics(robot, questions)
    if robot.endpoint is not None:
        return await _port(robot, robot.endpoint, questions)
    return _Told(driver=SshAnswer(None, ""))  # a device of its computer


async def _topics(robot: FleetRobot, questions: Questions) -> _Told:
    """Ask the robot's topics of ROS 2."""
    if questions.ros2 is None:
        return _Told(driver=SshAnswer(None, ""))
    try:
        async with asyncio.timeout(questions.timeout + LEEWAY):
            told = await questions.ros2(robot, questions.timeout)
    except NoRobotError as error:
        return _Told(driver=SshAnswer(False, "no node"), ros=SshAnswer(False, str(error)))
    except TimeoutError:
        return _Told(driver=SshAnswer(False, "no network"), ros=SshAnswer(False, "silent"))
    except PioneerError as error:
        return _Told(driver=SshAnswer(False, "no network"), ros=SshAnswer(False, str(error)))
    except Exception as error:  # the others are to be told of all the same
        log.exception("%s: failed", robot.name)
        return _Told(driver=SshAnswer(False, "failed"), ros=SshAnswer(False, type(error).__name__))
    if told.nodes > 1:
        driver = SshAnswer(False, f"{told.nodes} nodes")
    else:
        driver = SshAnswer(False, "silent") if told.age is None else SshAnswer(True, robot.node)
    return _Told(
        driver=driver,
        ros=SshAnswer(True, told.network),
        battery=told.battery,
        motors=told.motors,
        stopped=told.stopped,
        age=told.age,
    )


async def _port(robot: FleetRobot, endpoint: tuple[str, int], questions: Questions) -> _Told:
    host, number = endpoint
    address = questions.addresses.get(host.lower(), host)
    try:
        async with asyncio.timeout(questions.timeout):
            told = await asked_port(address, number, questions.timeout)
    except TimeoutError:
        return _Told(driver=SshAnswer(False, "silent"))
    except ConnectionResetError:
        return _Told(driver=SshAnswer(False, "busy"))
    except LinkError:
        return _Told(driver=SshAnswer(False, "refused"))
    says = f"{number} in use" if told.motors else f"{number} answers"
    return _Told(driver=SshAnswer(True, says), battery=told.battery, motors=told.motors)


@dataclass(frozen=True, slots=True)
class AtPort:
    """The report of a robot at its port: its battery [V], `None` if it reports nothing, and motors.

    At a port of its own a robot has them off, as the question switches them off; over a bridge they
    have power if another program has the robot.
    """

    battery: float | None
    motors: bool


async def asked_port(address: str, number: int, patience: float) -> AtPort:
    """Return the report of a robot at a TCP port.

    Raises:
        LinkError: Nobody listens.
        ConnectionResetError: It hangs up: another program has the robot.
        NoRobotError: It does not answer.
    """
    session = ProbeSession(await open_tcp(address, number), Timing(retry=0.25, give_up=patience))
    try:
        if not await session.handshake():
            if session.closed:
                raise ConnectionResetError
            raise NoRobotError(f"{address}:{number} is silent")
        if not session.sips:
            await session.listen(0.3)
        if not session.sips:
            return AtPort(None, motors=False)
        sip = session.sips[-1][1]
        wide = sip.battery_decivolts_wide
        voltage = (sip.battery_decivolts if wide is None else wide) * DECIVOLT
        return AtPort(voltage, motors=bool(sip.flags & SipFlag.MOTORS_ENABLED))
    finally:
        await session.close()


async def _node(robot: FleetRobot, questions: Questions) -> _Told:
    """Ask the masters for the robot's node, all at once; the first that knows it counts."""
    own = NodeAddress(robot.address, questions.master_port)
    graphs = [
        MasterGraph(master, questions.addresses, robot.address)
        for master in dict.fromkeys((*questions.masters, own))
    ]
    found = await asyncio.gather(*(_on_graph(robot, graph, questions.timeout) for graph in graphs))
    return next(
        (told for told in found if told.driver.ok),
        next((told for told in found if told.ros.ok), found[-1]),
    )


async def _on_graph(robot: FleetRobot, graph: MasterGraph, patience: float) -> _Told:
    place = f"{graph.master.host}:{graph.master.port}"
    name = f"/{robot.node.lstrip('/')}"
    try:
        async with asyncio.timeout(patience):
            node = await graph.node(name)
    except TimeoutError:
        return _Told(driver=SshAnswer(False, "no master"), ros=SshAnswer(False, "silent"))
    except OSError as error:
        why = "no ROS" if isinstance(error, RosGraphError) else "no master"
        return _Told(driver=SshAnswer(False, why), ros=SshAnswer(False, why))
    here = SshAnswer(True, place)
    if node is None:
        return _Told(driver=SshAnswer(False, "no node"), ros=here)
    try:
        async with asyncio.timeout(patience):
            alive = await graph.answers(node)
    except TimeoutError:
        alive = False
    if not alive:
        return _Told(driver=SshAnswer(False, "node silent"), ros=here)
    battery, motors = await asyncio.gather(
        _message(graph, node, f"{name}/battery_voltage", "std_msgs/Float64", patience),
        _message(graph, node, f"{name}/motors_state", "std_msgs/Bool", patience),
    )
    return _Told(
        driver=SshAnswer(True, robot.node),
        ros=here,
        battery=unpack("<d", battery)[0] if battery and len(battery) == 8 else None,
        motors=bool(motors[0]) if motors else None,
    )


async def _message(
    graph: MasterGraph, node: NodeAddress, topic: str, kind: str, patience: float
) -> bytes | None:
    with suppress(TimeoutError, OSError):
        async with asyncio.timeout(patience):
            return await graph.message(node, topic, kind)
    return None


async def _clock(robot: FleetRobot, questions: Questions) -> float | None:
    if questions.clock is None:
        return None
    with suppress(TimeoutError, OSError, PioneerError):
        async with asyncio.timeout(questions.timeout):
            return await questions.clock(robot)
    return None


def exit_code(answers: Sequence[Live]) -> int:
    """Return 0 if all computers are up, 1 if some are, 3 if none is."""
    up = sum(bool(answer.up.ok) for answer in answers)
    return 0 if up == len(answers) else 1 if up else 3
