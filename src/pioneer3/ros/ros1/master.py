"""The ROS 1 master: registers a node of rospy again with the one that follows it."""

import threading
from collections.abc import Callable
from http.client import HTTPException
from typing import Any, Final
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error as XmlRpcError
from xmlrpc.client import ServerProxy

LOOK: Final = 2.0
"""Pause between two looks at the master [s]; each costs it, and the node, a millisecond."""
SURVEY_EVERY: Final = 5
"""Looks between two at the types of topics and at our parameters: these lists are long."""


class MasterWatch:
    """Registers this node again after the master was away; rospy does so only at its start.

    `tell` is given a sentence when the master goes, and when it is back, and `on_registered` is
    called when this node is registered with a new one; both by a thread.
    """

    def __init__(self, name: str, tell: Callable[[str], None]) -> None:
        from rosgraph import Master
        from rospy import get_node_uri

        self._name, self._uri = name, str(get_node_uri())
        self._master = Master(name)
        self._parameters: Any = {}
        self._tell = tell
        self.on_registered: Callable[[], None] = lambda: None
        self._away = False
        self._looks = 0
        self._odd: dict[str, str] = {}
        self._unfinished = False
        self._leaving = threading.Event()

    def start(self) -> None:
        """Begin to look, in a thread that ends with the program."""
        threading.Thread(target=self._run, name="master watch", daemon=True).start()

    def stop(self) -> None:
        """Look no more."""
        self._leaving.set()

    def _run(self) -> None:
        while not self._leaving.wait(LOOK):
            self.look()

    def look(self) -> None:
        """Find out whether the master is there and knows this node; see to it that it does."""
        from rosgraph import MasterException
        from rospy import ROSException, get_param

        try:
            known = self._knows_us() and not self._unfinished
            if not known:
                self._unfinished = True  # half of it would make us known too
                self._register()
                self.on_registered()
                self._unfinished = False
            if self._looks % SURVEY_EVERY == 0:
                self._look_at_types()
                self._parameters = get_param(self._name, {})  # for the next master
            self._looks += 1
        except (OSError, HTTPException, XmlRpcError, ExpatError, MasterException, ROSException):
            if not self._away:
                self._away = True
                self._tell(
                    "ROS MASTER LOST: who is connected stays connected, and the robot still stops"
                    " without commands; registers again when it is back"
                )
            return
        if self._away or not known:
            self._away = False
            self._tell("the ROS master is back; registered with it")

    def _look_at_types(self) -> None:
        """Tell of topics that somebody publishes as another type: ROS just drops those messages."""
        from rospy.impl.registration import get_topic_manager

        types, odd = dict(self._master.getTopicTypes()), {}
        for topic, ours in get_topic_manager().get_subscriptions():
            theirs = types.get(topic, ours)
            if theirs != ours:
                odd[topic] = theirs
                if self._odd.get(topic) != theirs:
                    self._tell(
                        f"{topic} is published as {theirs}: that is IGNORED, it must be {ours};"
                        f" `rostopic info {topic}` says by whom"
                    )
        self._odd = odd

    def _knows_us(self) -> bool:
        from rosgraph import MasterException

        try:  # a node is known to a new master by its first log message; its services are not
            self._master.lookupService(f"{self._name}/get_loggers")
        except MasterException:
            return False
        return True

    def _register(self) -> None:
        from rospy.impl.registration import get_service_manager, get_topic_manager

        topics: Any = get_topic_manager()
        self._master.setParam(self._name, self._parameters)
        for service, at in get_service_manager().get_services():
            self._master.registerService(service, at, self._uri)
        for topic, kind in topics.get_publications():
            self._master.registerPublisher(topic, kind, self._uri)
        us = ServerProxy(self._uri)
        for topic, kind in topics.get_subscriptions():
            publishers = self._master.registerSubscriber(topic, kind, self._uri)
            us.publisherUpdate("/master", topic, publishers)  # as the master does for later ones
