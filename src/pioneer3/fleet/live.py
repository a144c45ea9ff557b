"""The state of all robots now: asked side by side, and no host waited for longer than the rest."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from struct import unpack
from types import MappingProxyType
from typing import Final, TypeVar

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
T = TypeVar("T")
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


NOT_ASKED: Final = SshAnswer(None, "")
UP: Final = SshAnswer(True, "yes")


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """The answers of a robot and its computer, which took some `seconds`.

    The `driver` is the robot's own port or its ROS node, and `ros` the ROS master that knows it, or
    the network of ROS 2. What nobody told is `None`: the `battery` [V], whether the motors have
    power, whether its emergency stop is latched or its button pressed, the `age` of its newest
    odometry over ROS 2 [s], and how far its clock is ahead of this computer's [s].
    """

    robot: str
    up: SshAnswer = NOT_ASKED
    ssh: SshAnswer = NOT_ASKED
    driver: SshAnswer = NOT_ASKED
    ros: SshAnswer = NOT_ASKED
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


AskTopics = Callable[[FleetRobot, float], Awaitable[OnTopics]]


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
    ros2: AskTopics | None = None
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
        _ssh(robot, questions),
        _driver(robot, questions),
        _within(questions.timeout, (questions.clock or _unknown)(robot)),
    )
    if ahead is not None:
        up = ssh = UP  # at another port, or by way of another computer
    if not up.ok and (told.driver.ok or (told.ros.ok and robot.ros == "1")):
        up = UP  # a firewall that lets ssh go unanswered
    age = None if told.age is None else told.age + (ahead or 0.0)
    return replace(told, up=up, ssh=ssh, age=age, clock=ahead, seconds=clock() - began)


async def _ssh(robot: FleetRobot, questions: Questions) -> tuple[SshAnswer, SshAnswer]:
    """Return whether the computer is up, and its ssh server; a refusal is an answer too."""
    try:
        async with asyncio.timeout(questions.timeout):
            reader, writer = await asyncio.open_connection(robot.address, questions.ssh_port)
    except ConnectionRefusedError:
        return UP, SshAnswer(False, "refused")
    except TimeoutError:
        return SshAnswer(False, "no answer"), SshAnswer(False, "")
    except OSError as error:
        return SshAnswer(False, (error.strerror or str(error)).lower()), SshAnswer(False, "")
    try:
        async with asyncio.timeout(questions.timeout):
            banner = await reader.read(LONGEST_BANNER)
    except TimeoutError:
        return UP, SshAnswer(False, "silent")
    except OSError:
        banner = b""
    finally:
        writer.transport.abort()
    if banner.startswith(b"SSH-"):
        return UP, UP
    return UP, SshAnswer(False, "hung up" if not banner else "not ssh")


async def _driver(robot: FleetRobot, questions: Questions) -> Live:
    """Ask the ROS node of the robot, or else its own port; a node has the port to itself."""
    if robot.ros == "1":
        return await _node(robot, questions)
    if robot.ros == "2" and questions.ros2 is not None:
        return await _topics(robot, questions.ros2, questions.timeout)
    if robot.endpoint is not None and not robot.ros:
        return await _port(robot, robot.endpoint, questions)
    return Live(robot=robot.name)  # a device of its computer


async def _topics(robot: FleetRobot, ask: AskTopics, patience: float) -> Live:
    """Ask the robot's topics of ROS 2."""
    name = robot.name
    try:
        async with asyncio.timeout(patience + LEEWAY):
            told = await ask(robot, patience)
    except NoRobotError as error:
        return _without_driver(name, "no node", SshAnswer(False, str(error)))
    except TimeoutError:
        return _without_driver(name, "no network", SshAnswer(False, "silent"))
    except PioneerError as error:
        return _without_driver(name, "no network", SshAnswer(False, str(error)))
    except Exception as error:  # the others are to be told of all the same
        log.exception("%s: failed", name)
        return _without_driver(name, "failed", SshAnswer(False, type(error).__name__))
    if told.nodes > 1:
        driver = SshAnswer(False, f"{told.nodes} nodes")
    else:
        driver = SshAnswer(False, "silent") if told.age is None else SshAnswer(True, robot.node)
    return Live(
        robot=name,
        driver=driver,
        ros=SshAnswer(True, told.network),
        battery=told.battery,
        motors=told.motors,
        stopped=told.stopped,
        age=told.age,
    )


def _without_driver(robot: str, said: str, ros: SshAnswer = NOT_ASKED) -> Live:
    return Live(robot=robot, driver=SshAnswer(False, said), ros=ros)


async def _port(robot: FleetRobot, endpoint: tuple[str, int], questions: Questions) -> Live:
    host, number = endpoint
    address = questions.addresses.get(host.lower(), host)
    try:
        async with asyncio.timeout(questions.timeout):
            told = await asked_port(address, number, questions.timeout)
    except TimeoutError:
        return _without_driver(robot.name, "silent")
    except ConnectionResetError:
        return _without_driver(robot.name, "busy")
    except LinkError:
        return _without_driver(robot.name, "refused")
    says = SshAnswer(True, f"{number} in use" if told.motors else f"{number} answers")
    return Live(robot=robot.name, driver=says, battery=told.battery, motors=told.motors)


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


async def _node(robot: FleetRobot, questions: Questions) -> Live:
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


async def _on_graph(robot: FleetRobot, graph: MasterGraph, patience: float) -> Live:
    place = f"{graph.master.host}:{graph.master.port}"
    name = f"/{robot.node.lstrip('/')}"
    try:
        async with asyncio.timeout(patience):
            node = await graph.node(name)
    except TimeoutError:
        return _without_driver(robot.name, "no master", SshAnswer(False, "silent"))
    except OSError as error:
        why = "no ROS" if isinstance(error, RosGraphError) else "no master"
        return _without_driver(robot.name, why, SshAnswer(False, why))
    here = SshAnswer(True, place)
    if node is None:
        return _without_driver(robot.name, "no node", here)
    alive = await _within(patience, graph.answers(node))
    if not alive:
        return _without_driver(robot.name, "node silent", here)
    battery, motors = await asyncio.gather(
        _within(patience, graph.message(node, f"{name}/battery_voltage", "std_msgs/Float64")),
        _within(patience, graph.message(node, f"{name}/motors_state", "std_msgs/Bool")),
    )
    return Live(
        robot=robot.name,
        driver=SshAnswer(True, robot.node),
        ros=here,
        battery=unpack("<d", battery)[0] if battery and len(battery) == 8 else None,
        motors=bool(motors[0]) if motors else None,
    )


async def _unknown(robot: FleetRobot) -> None:
    """Tell nothing of a robot's clock."""


async def _within(patience: float, answer: Awaitable[T]) -> T | None:
    """Return an answer; `None` if none came in time."""
    with suppress(TimeoutError, OSError, PioneerError):
        async with asyncio.timeout(patience):
            return await answer
    return None


def exit_code(answers: Sequence[Live]) -> int:
    """Return 0 if all computers are up, 1 if some are, 3 if none is."""
    up = sum(bool(answer.up.ok) for answer in answers)
    return 0 if up == len(answers) else 1 if up else 3
