"""The options that the commands of ROS 2 have in common: their network, and ROS 2's own."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec
from cyclopts import Parameter

from pioneer3.ros.ros2.network import Network

if TYPE_CHECKING:
    from pioneer3.ros.ros2.start import NodeOptions

Several = Parameter(negative=())


@Parameter(name="*", negative=())
@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkOptions(Network):
    """The network.

    Attributes:
        ros_args: ROS 2's own arguments, after all others: -r FROM:=TO, -p NAME:=VALUE,
            --params-file FILE.
    """

    ros_args: str = ""

    def node(self, name: str, namespace: str = "/") -> "NodeOptions":
        """Return the options of a node on this network."""
        from pioneer3.ros.ros2.start import NodeOptions

        words = ros_words(self.ros_args)
        return NodeOptions(name=name, namespace=namespace, network=self, arguments=words)


ANYWHERE = NetworkOptions()


def ros_words(text: str) -> tuple[str, ...]:
    """Return the words that `gather_ros_arguments` has put into one."""
    return tuple(msgspec.json.decode(text, type=list[str])) if text.startswith("[") else ()
