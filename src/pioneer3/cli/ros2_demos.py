"""`pioneer3 ros2 wander` and its like: the demos on topics of ROS 2, from any computer."""

from collections.abc import Callable
from dataclasses import dataclass
from inspect import Parameter as Argument
from math import inf
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.behaviors.modes import MODES, Mode
from pioneer3.cli.motion import keyword, mode_options, with_signature
from pioneer3.cli.options import Flag, Patience, Seconds, Speed, TurnRate
from pioneer3.cli.process import run_until_told_to_leave, write_json, write_line
from pioneer3.cli.ros1_program import ANY, RobotNames, Which
from pioneer3.cli.ros2_network import ANYWHERE, NetworkOptions
from pioneer3.cli.topic_driving import (
    KeyOptions,
    drive_by_keys,
    drive_by_mode,
    drive_by_phone,
    drive_several_by_keys,
)

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from pioneer3.ros.client.robot import TopicRobot
    from pioneer3.ros.node.middleware import Topics


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """A program on ROS 2: its name, the robot and the network; `words` are told at the start."""

    name: str
    which: Which
    network: NetworkOptions
    words: str | None = None

    def run(self, work: "Callable[[TopicRobot], Coroutine[Any, Any, None]]") -> int:
        """Find the robot and do `work`, until that ends or Ctrl-C."""
        return self.run_on_topics(lambda driven, topics: work(driven))

    def run_on_topics(
        self, work: "Callable[[TopicRobot, Topics], Coroutine[Any, Any, None]]"
    ) -> int:
        """Find the robot and do `work`, which takes the node's topics, too."""
        from pioneer3.cli.live import announce
        from pioneer3.ros.ros2.client import run_program

        async def working(robots: "list[TopicRobot]", topics: "Topics") -> None:
            (driven,) = robots
            if self.words is not None:
                announce(driven, self.words)
            await work(driven, topics)

        node = self.network.node(self.name)
        names = () if self.which.robot is None else (self.which.robot,)
        return run_until_told_to_leave(run_program(node, names, self.which.model, working))


def robots(*, network: NetworkOptions = ANYWHERE, json: Flag = False) -> int:
    """List the robots on the network.

    Example: pioneer3 ros2 robots --domain 3

    Args:
        network: Where they are.
        json: Print JSON.
    """
    return run_until_told_to_leave(_list(network, json=json))


async def _list(network: NetworkOptions, *, json: bool) -> int:
    from pioneer3.ros.ros2.client import find_robots

    found = await find_robots(network.node("robots"))
    if json:
        write_json(found)
        return 0
    for robot in found:
        write_line(f"{robot.name:24}  drive it on {robot.commands}, it is at {robot.pose}")
    if not found:
        write_line("None: start the node of one, as with pioneer3 ros2 --port /dev/ttyUSB0")
    return 0


def rob_key(
    *,
    which: Which = ANY,
    network: NetworkOptions = ANYWHERE,
    speed: Speed = 0.5,
    turn_rate: TurnRate = 0.5,
    latch: bool = True,
    patience: Patience = 10.0,
) -> int:
    """Drive a robot with the keyboard: a press keeps it moving, space stops, q quits.

    k is the emergency stop, Ctrl-R releases it. It sends ten commands a second:
    should this program or the network fail, the robot stops.

    Example: pioneer3 ros2 rob_key --robot robot1

    Args:
        which: The robot.
        network: Where it is.
        speed: Of the forward key; + and - change it.
        turn_rate: Of the turning keys; + and - change it.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """
    keys = KeyOptions(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)
    program = Program(name="rob_key", which=which, network=network, words="waits for keys")
    return program.run(lambda driven: drive_by_keys(driven, keys))


def rob_key_multi(
    *,
    network: NetworkOptions = ANYWHERE,
    robot: RobotNames = (),
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

    Example: pioneer3 ros2 rob_key_multi --robot robot1 --robot robot2

    Args:
        network: Where they are.
        robot: Which ones; all on the network if none is said.
        model: What they are; without it the largest, a P3-AT.
        speed: Of the forward key.
        turn_rate: Of the turning keys.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """
    from pioneer3.ros.ros2.client import run_program

    keys = KeyOptions(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)

    async def drive(driven: "list[TopicRobot]", topics: "Topics") -> None:
        await drive_several_by_keys(driven, keys)

    node = network.node("rob_key_multi")
    return run_until_told_to_leave(run_program(node, robot, model, drive, several=True))


def android_teleop(
    *,
    which: Which = ANY,
    network: NetworkOptions = ANYWHERE,
    imu: str = "/android/imu",
    speed: Speed = 0.2,
    turn_rate: TurnRate = 0.5,
) -> int:
    """Drive a robot by turning a phone that publishes sensor_msgs/Imu.

    Flick it, faster than 3 rad/s: about x for forward and back, about z to turn,
    about y to stop. A flick acts until the next one, for 10 s at most; when the
    phone falls silent, the robot stops.

    Example: pioneer3 ros2 android_teleop --robot robot1 --imu /phone/imu

    Args:
        which: The robot.
        network: Where it is.
        imu: Topic of the phone.
        speed: Of flicks forward and back.
        turn_rate: Of flicks to the side.
    """
    program = Program(name="android_teleop", which=which, network=network, words=f"waits for {imu}")
    return program.run_on_topics(
        lambda driven, topics: drive_by_phone(driven, topics, imu, speed, turn_rate)
    )


def p3_sonar(
    *,
    which: Which = ANY,
    network: NetworkOptions = ANYWHERE,
    seconds: Seconds | None = None,
    json: Flag = False,
) -> int:
    """Show the sonars of a robot, distances in mm from its hull; nothing moves.

    Example: pioneer3 ros2 p3_sonar --robot robot1

    Args:
        which: The robot.
        network: Where it is.
        seconds: End after this time.
        json: One JSON object for each reading, a line each.
    """

    async def show(driven: "TopicRobot") -> None:
        from pioneer3.cli.sonar import show_sonar

        await show_sonar(driven, inf if seconds is None else seconds, json=json)

    return Program(name="p3_sonar", which=which, network=network).run(show)


def mode_demo(mode: type[Mode]) -> Callable[..., int]:
    """Return the function of the command that runs `mode` on topics."""

    def run(
        *,
        which: Which = ANY,
        network: NetworkOptions = ANYWHERE,
        seconds: float | None = None,
        json: bool = False,
        **values: Any,
    ) -> int:
        from pioneer3.cli.live import how_to_stop

        asked = mode(**values)
        speed = values.get("speed")
        words = None if json else f"{asked.doing}; {how_to_stop()}"
        program = Program(name=mode.name(), which=which, network=network, words=words)
        return program.run(
            lambda driven: drive_by_mode(driven, asked, seconds=seconds, json=json, speed=speed)
        )

    run.__doc__ = f"{mode.summary()}\n\nSee pioneer3 {mode.name()} --help. Ctrl-C stops it."
    length = Annotated[Seconds | None, Parameter(help="Stop after this time.")]
    lines = Annotated[Flag, Parameter(help="One JSON object for each reading, a line each.")]
    common = [
        keyword("which", Which, ANY),
        keyword("network", NetworkOptions, ANYWHERE),
        *mode_options(mode),
        keyword("seconds", length, None),
        keyword("json", lines, default=False),
    ]
    assert all(each.kind is Argument.KEYWORD_ONLY for each in common)
    return with_signature(run, mode.name(), common)


DEMOS: tuple[Callable[..., int], ...] = (
    robots,
    rob_key,
    rob_key_multi,
    p3_sonar,
    android_teleop,
    *(mode_demo(mode) for mode in MODES if not mode.arguments),
)
