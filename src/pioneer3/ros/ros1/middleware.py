"""The middleware of ROS 1: topics, services, parameters and time, by rospy."""

import asyncio
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from time import time
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.models.description.xml import MAKER
from pioneer3.ros.definitions import DEFINITIONS
from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.middleware import QUEUE, Lose, Receive, Sender, Unsubscribe
from pioneer3.ros.node.parameters import NodeParameters
from pioneer3.ros.ros1.connection import DirectConnection, DirectReading
from pioneer3.ros.ros1.reconfigure import Reconfigure

DESCRIPTION: Final = "robot_description"
"""The parameter in which rviz looks for the robot's description."""
PLACES: Final = (
    Path("/usr/lib/python3/dist-packages"),
    Path("/opt/ros/noetic/lib/python3/dist-packages"),
)
"""Debian's own packages, and Ubuntu's ROS Noetic."""
PACKAGES: Final = (
    "python3-roslaunch python3-rospy rosout python3-rostopic python3-rosservice python3-rosparam"
    " python3-rosnode python3-rosmsg rosbash python3-rosbag python3-dynamic-reconfigure"
    " python3-nav-msgs python3-sensor-msgs python3-geometry-msgs python3-std-srvs python3-tf2-msgs"
    " python3-diagnostic-msgs python3-actionlib-msgs python3-move-base-msgs"
    " ros-std-msgs ros-geometry-msgs ros-nav-msgs ros-sensor-msgs"
    " ros-std-srvs ros-tf2-msgs ros-diagnostic-msgs ros-actionlib-msgs ros-move-base-msgs"
)
"""Packages of Debian 12 for the node and ROS's own command-line tools."""
NAVIGATION_PACKAGES: Final = {
    "actionlib_msgs": "python3-actionlib-msgs",
    "move_base_msgs": "python3-move-base-msgs",
}
"""Modules that a node with a map imports, and their packages."""


def find_rospy(places: Sequence[Path] = PLACES) -> None:
    """Make `import rospy` work, from one of `places` if need be.

    The place comes last in the search path: where both have a package, ours is taken. Raises
    ConfigError if ROS 1 is not installed; the message has the command that installs it.
    """
    if find_spec("rospy") is not None:
        return
    for place in places:
        if (place / "rospy").is_dir():
            sys.path.append(str(place))
            return
    raise ConfigError(
        "ROS 1 is not installed on this computer; on Debian 12 run:\n"
        f"sudo apt-get update && sudo apt-get install -y --no-install-recommends {PACKAGES}"
    )


def find_move_base() -> None:
    """Make sure that the messages of move_base are there; :func:`find_rospy` comes first.

    Raises:
        ConfigError: They are not installed; the message has the command that installs them.
    """
    missing = [name for name in NAVIGATION_PACKAGES if find_spec(name) is None]
    if missing:
        raise ConfigError(
            f"a map needs the messages of {' and '.join(missing)}; on Debian 12 run:\n"
            "sudo apt-get update && sudo apt-get install -y --no-install-recommends"
            f" {' '.join(NAVIGATION_PACKAGES.values())}"
        )


@cache
def message_class(type_name: str) -> Any:
    """Return the class of a message type such as `nav_msgs/Odometry`."""
    if type_name in DEFINITIONS:
        from genpy.dynamic import generate_dynamic

        return generate_dynamic(type_name, DEFINITIONS[type_name])[type_name]
    package, name = type_name.split("/")
    return getattr(import_module(f"{package}.msg"), name)


class RospyPublisher:
    """A `rospy.Publisher` whose connections are each a :class:`DirectConnection`.

    It is `subscribed` while anybody subscribes.
    """

    def __init__(self, name: str, type_name: str, *, latched: bool, queue: int) -> None:
        import rospy

        self._lock = Lock()
        with self._lock:
            self._publisher = rospy.Publisher(
                name,
                message_class(type_name),
                queue_size=queue,
                latch=latched,
                tcp_nodelay=True,
                subscriber_listener=self,
            )
            impl = self._publisher.impl
            add = impl.add_connection
            impl.add_connection = lambda transport: add(DirectConnection(transport, queue))
            impl.set_queue_size(None)  # else rospy wraps them once more
        self._count()

    def peer_subscribe(self, name: str, publish: object, publish_to_it: object) -> None:
        """Take note of a subscriber, in a thread of rospy's."""
        self._count()

    def peer_unsubscribe(self, name: str, left: int) -> None:
        """Take note of one that is gone, in a thread of rospy's."""
        self._count()

    def _count(self) -> None:
        with self._lock:  # two that come and go at once leave the last count
            self.subscribed = self._publisher.get_num_connections() > 0

    def publish(self, message: Any) -> None:
        """Send a message."""
        self._publisher.publish(message)


class RospyTopics:
    """Publishing and subscribing; :func:`find_rospy` comes first."""

    def __init__(self) -> None:
        import rospy

        self._rospy = rospy
        self._loop = asyncio.get_running_loop()
        self._asked: set[str] = set()

    def make(self, type_name: str) -> Any:
        """Return an empty message."""
        return message_class(type_name)()

    def resolve(self, name: str) -> str:
        """Return the full name of a topic, service or parameter after remapping."""
        full = _full(name)
        self._asked.add(full)
        final = {_full(source): _full(target) for source, target in _rules().items()}
        return final.get(full, full)

    def tell_unused_rules(self) -> None:
        """Warn of each remapping of a name that this node does not have, in a thread."""
        own = f"{self._rospy.get_name()}/"
        for source, target in _rules().items():
            full, last = _full(source), source.rpartition("/")[2].lstrip("~")
            if full in self._asked or _is_known(_full(target)):
                continue
            meant = sorted(each for each in self._asked if each.rpartition("/")[2] == last)
            name = meant[0].replace(own, "~") if meant else ""
            hint = f"; did you mean '{name}:={target}'?" if name else ""
            self._rospy.logwarn(
                f"{source}:={target} changes nothing: there is no {full} here{hint}"
            )

    def _once(self, name: str) -> str:
        """Return a name after remapping that rospy does not remap again.

        It looks the full name up in its rules twice, so one rule would follow another.
        """
        final = self.resolve(name)
        self._rospy.names.get_resolved_mappings().pop(final, None)
        return final

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> RospyPublisher:
        """Return a publisher."""
        return RospyPublisher(self._once(name), type_name, latched=latched, queue=queue)

    def subscribe(
        self, name: str, type_name: str, receive: Receive, *, queue: int, left: Lose | None = None
    ) -> Unsubscribe:
        """Call `receive` in a thread of the connection; with `left` in the loop, but for the first.

        What drives the robot is worth a connection that the loop reads itself.
        """
        full = self._once(name)
        senders: dict[int, Sender] = {}

        def received(message: Any) -> None:
            header = message._connection_header
            if (sender := senders.get(id(header))) is None:
                latched = header.get("latching") == "1"
                sender = Sender(header.get("callerid", ""), header, latched)
                senders[id(header)] = sender
                if left is not None:
                    _read_directly(full, header, self._loop, partial(ended, sender))
            receive(message, sender)

        def ended(sender: Sender) -> None:
            if senders.pop(id(sender.connection), None) is not None and left is not None:
                left(sender)

        subscriber = self._rospy.Subscriber(
            full, message_class(type_name), received, queue_size=queue, tcp_nodelay=True
        )
        return subscriber.unregister  # type: ignore[no-any-return]


def _rules() -> dict[str, str]:
    """Return the rules of remapping, as somebody has written them."""
    import rospy

    rules: dict[str, str] = rospy.names.get_mappings()
    return {source: target for source, target in rules.items() if not source.startswith("__")}


def _full(name: str) -> str:
    """Return the full name of what this node calls `name`, before remapping."""
    import rosgraph
    import rospy

    return str(rosgraph.names.resolve_name(name, rospy.get_name()))


def _is_known(name: str) -> bool:
    """Return whether rospy, or dynamic_reconfigure in it, has a topic, service or parameter."""
    import rospy
    from rospy.impl.registration import get_service_manager, get_topic_manager

    topics, services = get_topic_manager(), get_service_manager()
    several = topics.get_publications(), topics.get_subscriptions(), services.get_services()
    if any(name == each for rows in several for each, _ in rows):
        return True
    with suppress(OSError, rospy.ROSException):  # the master may be gone
        return bool(rospy.has_param(name))
    return True


def _read_directly(
    topic: str, header: object, loop: asyncio.AbstractEventLoop, tell: Callable[[], None]
) -> None:
    """Have the loop read a connection from now on, and `tell` its end unless this node ends it.

    rospy tells nobody. It makes a connection anew that has failed, with another header then.
    """
    from rospy.impl.registration import get_topic_manager

    def before(call: Callable[..., object], *arguments: object) -> object:
        if not impl.closed:
            tell()
        reading.end()
        return call(*arguments)

    impl = get_topic_manager().get_subscriber_impl(topic)
    for connection in impl.connections if impl else ():
        if connection.header is header:
            reading = DirectReading(connection, impl.receive_callback, loop)
            connection.set_cleanup_callback(partial(before, connection.cleanup_cb))
            connection._reconnect = partial(before, connection._reconnect)
            if not connection.done:
                return
    tell()


class RospyMiddleware(RospyTopics):
    """All that a node needs; `rospy.init_node` comes first."""

    serves = True
    mismatches = None

    def __init__(self) -> None:
        super().__init__()
        self._described: str | None = None
        self._reconfigure: Reconfigure | None = None

    @property
    def name(self) -> str:
        """Full name of the node."""
        return str(self._rospy.get_name())

    def stamp(self, age: float) -> Any:
        """Return the ROS time of the moment `age` seconds ago."""
        ours = self._rospy.rostime.is_wallclock()
        now = time() if ours else self._rospy.get_time()
        return self._rospy.Time.from_sec(max(0.0, now - age))

    def age(self, stamp: Any) -> float | None:
        """Return the time since a stamp [s]; `None` for a stamp of 0."""
        return float((self._rospy.get_rostime() - stamp).to_sec()) if stamp else None

    def serve(self, name: str, type_name: str, handle: Callable[[Any], Any]) -> None:
        """Offer a service."""
        package, kind = type_name.split("/")
        srv = import_module(f"{package}.srv")

        def handled(request: Any) -> Any:
            response, result = getattr(srv, f"{kind}Response")(), handle(request)
            for field in response.__slots__:  # EmptyResponse has none
                setattr(response, field, getattr(result, field))
            return response

        self._rospy.Service(self._once(name), getattr(srv, kind), handled)

    def describe(self, urdf: str) -> None:
        """Set `robot_description`, unless it has a description that is not of this package."""
        name = self.resolve(DESCRIPTION)
        there = self._rospy.get_param(DESCRIPTION, "")
        if there and MAKER not in str(there):
            self._rospy.logwarn(f"{name} is somebody else's: it stays as it is")
            return
        if there != urdf:
            self._rospy.set_param(DESCRIPTION, urdf)
        self._described = urdf

    def reconfigure(self, parameters: NodeParameters, driving: DrivingParameters) -> None:
        """Offer dynamic_reconfigure of the driving parameters."""
        self._reconfigure = Reconfigure(driving)

    def forget(self) -> None:
        """Leave the parameter server as it was."""
        with suppress(OSError, KeyError, self._rospy.ROSException):  # the master may be gone
            ours = self._described
            if ours is not None and self._rospy.get_param(DESCRIPTION, "") == ours:
                self._rospy.delete_param(DESCRIPTION)
        if self._reconfigure is not None:
            self._reconfigure.forget()

    def on_shutdown(self, call: Callable[[], None]) -> None:
        """Call `call` in a thread of rospy's when somebody shuts the node down."""
        self._rospy.on_shutdown(call)

    def warn(self, sentence: str) -> None:
        """Log a warning."""
        self._rospy.logwarn(sentence)
