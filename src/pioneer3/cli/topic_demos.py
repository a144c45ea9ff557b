"""The demos on topics, from any computer: one description of each for ROS 1 and ROS 2."""

from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from inspect import Parameter as Argument
from inspect import signature
from math import inf
from typing import TYPE_CHECKING, Annotated, Any, Protocol

from cyclopts import Parameter

from pioneer3.behaviors.modes import MODES, Mode
from pioneer3.cli.live import announce, how_to_stop
from pioneer3.cli.motion import keyword, mode_options, with_signature
from pioneer3.cli.options import Flag, Json, Patience, Seconds, Speed, TurnRate
from pioneer3.cli.process import write_json, write_line
from pioneer3.cli.topic_driving import (
    drive_by_keys,
    drive_by_mode,
    drive_by_phone,
    drive_several_by_keys,
)

if TYPE_CHECKING:
    from pioneer3.ros.client.graph import RobotTopics
    from pioneer3.ros.client.robot import TopicRobot
    from pioneer3.ros.node.middleware import Topics

    Work = Callable[[list[TopicRobot], Topics], Coroutine[Any, Any, None]]
    WorkOfOne = Callable[[TopicRobot, Topics], Coroutine[Any, Any, None]]

Several = Annotated[tuple[str, ...], Parameter(name=["--robot", "-r"], negative=())]
Demo = Callable[..., int]


class DemoGraph(Protocol):
    """The ROS graph that a demo finds robots on; `ros` is the command with the demos, as `ros1`."""

    @property
    def ros(self) -> str: ...

    def find(self, show: "Callable[[Sequence[RobotTopics]], None]") -> int:
        """Have all robots shown."""

    def run(
        self, name: str, robots: Sequence[str], model: str | None, work: "Work", *, several: bool
    ) -> int:
        """Be the node `name` and do `work` with robots, until that ends or Ctrl-C.

        Without names it is the only robot, or if there may be `several` all there are; `model` is
        what they are, `None` for what their nodes tell. `work` is given the topics of the node,
        too.
        """


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Which:
    """The robot to drive.

    Attributes:
        robot: Its name, if there are several; the command robots lists them.
        model: What it is, where its node does not tell: p3at-sh, p3dx-sh.
    """

    robot: Annotated[str | None, Parameter(name=["--robot", "-r"])] = None
    model: str | None = None


ANY = Which()


def robots(graph: DemoGraph, *, json: Json = False) -> int:
    """List the robots on the ROS graph.

    Example: pioneer3 {ros} robots
    """

    def show(found: "Sequence[RobotTopics]") -> None:
        if json:
            write_json(found)
            return
        for robot in found:
            write_line(f"{robot.name:24}  drive it on {robot.commands}, it is at {robot.pose}")
        if not found:
            example = f"pioneer3 {graph.ros} --port /dev/ttyUSB0"
            write_line(f"None: start the node of one, as with {example}")

    return graph.find(show)


def rob_key(
    graph: DemoGraph,
    *,
    which: Which = ANY,
    speed: Speed = 0.5,
    turn_rate: TurnRate = 0.5,
    latch: bool = True,
    patience: Patience = 10.0,
) -> int:
    """Drive a robot with the keyboard: a press keeps it moving, space stops, q quits.

    k is the emergency stop, Ctrl-R releases it. It sends ten commands a second:
    should this program or the network fail, the robot stops.

    Example: pioneer3 {ros} rob_key --robot {robot}

    Args:
        speed: Of the forward key; + and - change it.
        turn_rate: Of the turning keys; + and - change it.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """
    from pioneer3.teleop.keyboard import Manner

    keys = Manner(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)
    return _run(
        graph, "rob_key", which, lambda driven, _: drive_by_keys(driven, keys), "waits for keys"
    )


def rob_key_multi(
    graph: DemoGraph,
    *,
    robot: Several = (),
    model: str | None = None,
    speed: Speed = 0.1,
    turn_rate: TurnRate = 0.1,
    latch: bool = True,
    patience: Patience = 10.0,
) -> int:
    """Drive several robots with one keyboard, one at a time or all together.

    Arrows drive, q goes on to the next robot, a number chooses one, a all of them,
    s several: mark them, then y; who is left stands. Space stops all, k is the
    emergency stop of all, Ctrl-R releases it; Ctrl-D quits.

    Example: pioneer3 {ros} rob_key_multi --robot {robot} --robot {another}

    Args:
        robot: Which ones; all that are there if none is said.
        model: What they are, where their nodes do not tell.
        speed: Of the forward key.
        turn_rate: Of the turning keys.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """
    from pioneer3.teleop.keyboard import Manner

    keys = Manner(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)
    return graph.run(
        "rob_key_multi",
        robot,
        model,
        lambda driven, _: drive_several_by_keys(driven, keys),
        several=True,
    )


def p3_sonar(
    graph: DemoGraph, *, which: Which = ANY, seconds: Seconds | None = None, json: Flag = False
) -> int:
    """Show the sonars of a robot, distances in mm from its hull; nothing moves.

    Example: pioneer3 {ros} p3_sonar --robot {robot}

    Args:
        seconds: End after this time.
        json: One JSON object for each reading, a line each.
    """

    async def show(driven: "TopicRobot", _: "Topics") -> None:
        from pioneer3.cli.sonar import show_sonar

        await show_sonar(driven, inf if seconds is None else seconds, json=json)

    return _run(graph, "p3_sonar", which, show)


def android_teleop(
    graph: DemoGraph,
    *,
    which: Which = ANY,
    imu: str = "/android/imu",
    speed: Speed = 0.2,
    turn_rate: TurnRate = 0.5,
) -> int:
    """Drive a robot by turning a phone that publishes sensor_msgs/Imu.

    Flick it, faster than 3 rad/s: about x for forward and back, about z to turn,
    about y to stop. A flick acts until the next one, for 10 s at most; when the
    phone falls silent, the robot stops.

    Example: pioneer3 {ros} android_teleop --robot {robot} --imu /phone/imu

    Args:
        imu: Topic of the phone.
        speed: Of flicks forward and back.
        turn_rate: Of flicks to the side.
    """
    return _run(
        graph,
        "android_teleop",
        which,
        lambda driven, topics: drive_by_phone(driven, topics, imu, speed, turn_rate),
        f"waits for {imu}",
    )


def mode_demo(mode: type[Mode]) -> Demo:
    """Return the demo that runs `mode` on topics."""

    def run(
        graph: DemoGraph,
        *,
        which: Which = ANY,
        seconds: float | None = None,
        json: bool = False,
        **values: Any,
    ) -> int:
        asked, speed = mode(**values), values.get("speed")
        return _run(
            graph,
            mode.name(),
            which,
            lambda driven, _: drive_by_mode(driven, asked, seconds=seconds, json=json, speed=speed),
            None if json else f"{asked.doing}; {how_to_stop()}",
        )

    run.__doc__ = f"{mode.summary()}\n\nSee pioneer3 {mode.name()} --help. Ctrl-C stops it."
    length = Annotated[Seconds | None, Parameter(help="Stop after this time.")]
    lines = Annotated[Flag, Parameter(help="One JSON object for each reading, a line each.")]
    arguments = [
        Argument("graph", Argument.POSITIONAL_ONLY, annotation=DemoGraph),
        keyword("which", Which, ANY),
        *mode_options(mode),
        keyword("seconds", length, None),
        keyword("json", lines, default=False),
    ]
    return with_signature(run, mode.name(), arguments)


DEMOS: tuple[Demo, ...] = (
    robots,
    rob_key,
    rob_key_multi,
    p3_sonar,
    android_teleop,
    *(mode_demo(mode) for mode in MODES if not mode.arguments),
)
"""No mode with a place: it counts from odometry's origin, which nobody knows on topics."""


def commands(
    graph_of: Callable[[Any], DemoGraph], where: Argument, names: dict[str, str]
) -> tuple[Demo, ...]:
    """Return the demos as commands on one kind of graph.

    `graph_of` returns the graph that `where`, an argument of each command, means; `names` take the
    place of words such as `{ros}` and `{robot}` in its help.
    """
    return tuple(_command(demo, graph_of, where, names) for demo in DEMOS)


def _command(
    demo: Demo, graph_of: Callable[[Any], DemoGraph], where: Argument, names: dict[str, str]
) -> Demo:
    comes_first = where.kind is Argument.VAR_POSITIONAL

    def run(*given: str, **values: Any) -> int:
        asked = given if comes_first else values.pop(where.name, where.default)
        return demo(graph_of(asked), **values)

    _, *own = signature(demo).parameters.values()
    run.__doc__ = (demo.__doc__ or "").format(**names)
    return with_signature(run, demo.__name__, [where, *own] if comes_first else [*own, where])


def _run(
    graph: DemoGraph, name: str, which: Which, work: "WorkOfOne", words: str | None = None
) -> int:
    """Do `work` with one robot; `words` are told at the start."""

    async def working(driven: "list[TopicRobot]", topics: "Topics") -> None:
        (robot,) = driven
        if words is not None:
            announce(robot, words)
        await work(robot, topics)

    names = () if which.robot is None else (which.robot,)
    return graph.run(name, names, which.model, working, several=False)
