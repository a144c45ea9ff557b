"""`pioneer3 ros2`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cyclopts import App

from pioneer3.cli.motion import keyword
from pioneer3.cli.options import LINK, UNITS, LinkOptions
from pioneer3.cli.places import MapName, StartPlace, start_of
from pioneer3.cli.process import run_until_told_to_leave, until_told_to_leave, write_line
from pioneer3.cli.ros2_bridge import bridge
from pioneer3.cli.ros2_check import check
from pioneer3.cli.ros2_network import ANYWHERE, NetworkOptions
from pioneer3.cli.topic_demos import commands

if TYPE_CHECKING:
    from pioneer3.cli.topic_demos import Work
    from pioneer3.ros.client.graph import RobotTopics

ros2_app = App(name="ros2", help_epilogue=UNITS)


@dataclass(frozen=True, slots=True)
class Ros2Graph:
    """The graph of a network of ROS 2."""

    network: NetworkOptions
    ros: str = "ros2"

    def find(self, show: "Callable[[Sequence[RobotTopics]], None]") -> int:
        """Have all robots shown."""
        return run_until_told_to_leave(self._find(show))

    async def _find(self, show: "Callable[[Sequence[RobotTopics]], None]") -> int:
        from pioneer3.ros.ros2.client import find_robots

        show(await find_robots(self.network.node("robots")))
        return 0

    def run(
        self, name: str, robots: Sequence[str], model: str | None, work: "Work", *, several: bool
    ) -> int:
        """Be a node and do `work` with robots; see :class:`Graph`."""
        from pioneer3.ros.ros2.client import run_program

        node = self.network.node(name)
        return run_until_told_to_leave(run_program(node, robots, model, work, several=several))


DEMOS = commands(
    Ros2Graph,
    keyword("network", NetworkOptions, ANYWHERE),
    {"ros": "ros2", "robot": "robot1", "another": "robot2"},
)
COMMANDS: tuple[Callable[..., int], ...] = (check, *DEMOS, bridge)
for command in COMMANDS:
    ros2_app.command(command, name=command.__name__)


@ros2_app.default
def ros2(
    *,
    link: LinkOptions = LINK,
    namespace: str = "",
    name: str = "pioneer3",
    network: NetworkOptions = ANYWHERE,
    map_: MapName = None,
    start: StartPlace = None,
    install_package: Path | None = None,
) -> int:
    """Be the robot's ROS 2 node, with or without ROS 2 on this computer.

    Ctrl-C stops the robot. Without a port the node takes the simulator at
    localhost:8101, else the robot at a serial port.

    Example: pioneer3 ros2 --port /dev/ttyUSB0 --namespace robot1
    Example: pioneer3 ros2 --backend zenoh --ros-args -p cmd_vel_timeout:=0.3

    Args:
        namespace: Of the node, such as robot1; its topics are below it.
        name: Of the node.
        map_: To navigate on: a file, or the name of one that ships.
        start: Where the robot is: a name, x,y,heading, or unknown; without it as it was last.
        install_package: Only write a ROS 2 package to this folder, for ros2 run and ros2 launch.
    """
    from pioneer3.ros.ros2.start import serve

    node = network.node(name, namespace or "/")
    if install_package is not None:
        return _install(install_package, node.network.distro_here().name)
    options = link.node(map_, start_of(start, "ros2"))
    return run_until_told_to_leave(serve(node, options, write_line))


@ros2_app.command
@until_told_to_leave
async def router(*, network: NetworkOptions = ANYWHERE) -> int:
    """Run a Zenoh router, for computers that have none of ROS 2's own.

    Programs of this computer find it by themselves; --listen lets others in, and
    --connect joins it to another router. TLS and login are by files.

    Example: pioneer3 ros2 router
    Example: pioneer3 ros2 router --listen tcp/0.0.0.0:7447
    """
    from pioneer3.ros.zenoh.settings import serve_router

    await serve_router(network.router_options(), write_line)
    return 0


def _install(folder: Path, distro: str) -> int:
    from pioneer3.ros.ament.install import install_package

    package = install_package(folder, distro)
    write_line(f"wrote {package}; now: source {folder.resolve()}/setup.bash")
    return 0
