"""`pioneer3 ros1`."""

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from inspect import Parameter as Argument
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from pioneer3.cli.options import AUTO, LINK, UNITS, LaserOptions, LinkOptions
from pioneer3.cli.places import MapName, StartPlace, start_of
from pioneer3.cli.process import run_until_told_to_leave, until_told_to_leave, write_line
from pioneer3.cli.topic_demos import commands

if TYPE_CHECKING:
    from pioneer3.cli.topic_demos import Work
    from pioneer3.robot.lasers.spec import LaserSpec
    from pioneer3.ros.client.graph import RobotTopics

ros1_app = App(
    name="ros1",
    help="""Be the robot's ROS 1 node, in the place of RosAria; Ctrl-C stops the robot.

    Or, with a command, drive a robot whose node runs, from any computer.

    Without a port the node takes the simulator at localhost:8101, else the robot
    at a serial port.

    Example: pioneer3 ros1 --port /dev/ttyUSB0 _cmd_vel_timeout:=0.5
    """,
    help_epilogue=UNITS,
)
ARGUMENTS = Annotated[str, Parameter(show=False, help="ROS's own, such as __name:=mine.")]


@dataclass(frozen=True, slots=True)
class Ros1Graph:
    """The graph of a ROS master, with ROS's own arguments of the command."""

    arguments: tuple[str, ...]
    ros: str = "ros1"

    def find(self, show: "Callable[[Sequence[RobotTopics]], None]") -> int:
        """Have all robots shown."""
        return run_until_told_to_leave(self._find(show))

    async def _find(self, show: "Callable[[Sequence[RobotTopics]], None]") -> int:
        from pioneer3.ros.ros1.client import find_robots

        show(await find_robots(self.arguments))
        return 0

    def run(
        self, name: str, robots: Sequence[str], model: str | None, work: "Work", *, several: bool
    ) -> int:
        """Be a node and do `work` with robots; see :class:`Graph`."""
        return run_until_told_to_leave(self._run(name, robots, model, work, several=several))

    async def _run(
        self, name: str, robots: Sequence[str], model: str | None, work: "Work", *, several: bool
    ) -> int:
        from pioneer3.ros.client.graph import wanted
        from pioneer3.ros.ros1.client import find_robots, run_program

        topics = wanted(await find_robots(self.arguments), robots, several=several)
        node = name if several else f"{name}_{topics[0].name.replace('/', '_')}"
        await run_program(node, self.arguments, topics, model, work)
        return 0


for command in commands(
    Ros1Graph,
    Argument("arguments", Argument.VAR_POSITIONAL, annotation=ARGUMENTS),
    {"ros": "ros1", "robot": "p3at_1_113", "another": "p3at_2_246"},
):
    ros1_app.command(command, name=command.__name__)


@ros1_app.default
def ros1(
    *arguments: Annotated[str, Parameter(show=True)],
    link: LinkOptions = LINK,
    map_: MapName = None,
    start: StartPlace = None,
    install_package: Path | None = None,
) -> int:
    """Be the robot's ROS 1 node, in the place of RosAria; Ctrl-C stops the robot.

    Without a port it takes the simulator at localhost:8101, else the robot at a
    serial port. With a map it takes goals, too, as move_base does.

    Example: pioneer3 ros1 --port /dev/ttyUSB0 _cmd_vel_timeout:=0.5
    Example: pioneer3 ros1 --map office --start Lab

    Args:
        arguments: ROS's own: _port:=/dev/ttyS0, __name:=front, '~cmd_vel:=/teleop/cmd_vel';
            with _profile:=standard cmd_vel:=/teleop/cmd_vel.
        map_: To navigate on: a file, or the name of one that ships.
        start: Where the robot is: a name, x,y,heading, or unknown; without it as it was last.
        install_package: Only write a ROS package to this folder, for rosrun and roslaunch.
    """
    if install_package is not None:
        return _install(install_package)
    from pioneer3.ros.ros1.start import serve

    options = link.node(map_, start_of(start, "ros1"), arguments)
    return run_until_told_to_leave(serve(options, write_line))


@ros1_app.command
@until_told_to_leave
async def laser(
    *arguments: Annotated[str, Parameter(show=True)],
    port: Annotated[str, Parameter(env_var="PIONEER3_LASER", metavar="PORT")] = AUTO,
) -> int:
    """Be a laser's ROS 1 node, in place of hokuyo_node, urg_node, sicklms, LMS1xx.

    No robot is needed. It has their parameters, and publishes scan and
    /diagnostics.

    Example: pioneer3 ros1 laser _port:=/dev/ttyACM0 _min_ang:=-1.57
    Example: pioneer3 ros1 laser _ip_address:=192.168.0.10
    Example: pioneer3 ros1 laser _host:=192.168.0.1 _inverted:=true

    Args:
        arguments: ROS's own: _serial_port:=/dev/ttyACM0, __name:=front, scan:=front/scan.
        port: [MODEL@]PORT, such as /dev/ttyACM0, lms-200@/dev/ttyUSB1; auto looks for
            one. Parameters come first.
    """
    from pioneer3.ros.ros1.start import serve_laser

    def find(ports: Sequence[str]) -> "Awaitable[Sequence[LaserSpec]]":
        return LaserOptions(laser=tuple(ports) or (port,)).specs()

    return await serve_laser(arguments, find, write_line)


def _install(folder: Path) -> int:
    from pioneer3.ros.ros1.package import install_package

    package = install_package(folder)
    write_line(
        f"wrote {package}; now: export ROS_PACKAGE_PATH={folder.resolve()}:$ROS_PACKAGE_PATH"
    )
    return 0
