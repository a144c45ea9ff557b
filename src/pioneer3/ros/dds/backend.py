"""A node of ROS 2 as a participant of DDS.

One thread takes everything that comes; it hands messages over and never waits for anybody.
"""

import logging
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from importlib import import_module
from importlib.metadata import version
from time import monotonic, sleep
from typing import Any, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.ros.dds.discovery import INFO, TOPIC, Discovery
from pioneer3.ros.dds.endpoints import SAMPLES, DdsReader, DdsWriter
from pioneer3.ros.dds.entities import Entities
from pioneer3.ros.dds.services import HEAD, ServiceClient, ServiceResponder
from pioneer3.ros.dds.settings import DOMAINS, DdsOptions
from pioneer3.ros.ros2.backend import (
    LATCHED,
    Closable,
    Failed,
    Graph,
    Left,
    MessageType,
    NodeName,
    Qos,
    Received,
    Respond,
    ServiceType,
    Unread,
)
from pioneer3.ros.ros2.types import MessageTypes

LOOK: Final = 0.01
"""Pause between two looks whether a service is there [s]."""
WARNINGS: Final = 20
"""Programs that are told of because their messages of the graph cannot be read."""
REQUESTS: Final = Qos(depth=1000)
"""Quality of requests and responses: who loses one waits in vain."""
EVERYBODY: Final = Qos(transient_local=True, depth=100)
"""Quality of the graph's topic: a message of each participant."""
NO_HEAD: Final[Mapping[str, str]] = {}
FAILED: Final = "DDS has failed, so that nothing is received any more; the log has the reason"
log = logging.getLogger(__name__)


class DdsBackend:
    """A participant of DDS; ConfigError if the library is missing, or an option is wrong."""

    strict = True

    def __init__(self, node: NodeName, types: MessageTypes, options: DdsOptions) -> None:
        try:
            import_module("cyclonedds.domain")
        except ImportError as error:
            raise ConfigError(
                f"DDS needs Cyclone DDS: {how_to_get('dds')}; on Linux it has no package"
                " for arm64: take --backend zenoh there"
            ) from error
        self._types, self._options = types, options
        self.title = (
            f"DDS (Cyclone DDS {version('cyclonedds')}), domain {options.domain}{options.reach}"
        )
        self.serves = options.services
        self.lacks = (
            "without services, parameters, lifecycle and actions, whose requests ROS 2's usual"
            " middleware sends in a way of its own: topics stand in for services. Nothing is"
            " encrypted: whoever reaches the network can drive the robot"
        )
        if self.serves:
            self.lacks = "without actions; nothing is encrypted: whoever reaches the network drives"
        DOMAINS.join(options)
        self._entities = Entities(options.domain, types)
        self._discovery = Discovery(types, node, self._entities.guid)
        self._readers: list[DdsReader] = []
        self._infos: DdsWriter | None = None
        self._unread: set[bytes] = set()
        self._unclear = Unread("descriptions of endpoints")
        self._failed: Failed | None = None
        self._has_failed = False
        self._lock = threading.RLock()
        self._closed = False
        self._begin()

    def _begin(self) -> None:
        """Join the graph, and start the thread."""
        self._news = self._entities.news()
        info = self._types.message_type(INFO)
        self._infos = self._advertise(TOPIC, info, NO_HEAD, LATCHED)
        self._subscribe(TOPIC, info, EVERYBODY, self._take_info)
        self._thread = threading.Thread(target=self._take, name="dds", daemon=True)
        self._thread.start()
        self._tell()

    def advertise(self, name: str, type_: MessageType, qos: Qos) -> DdsWriter:
        """Publish on a topic."""
        return self._advertise(f"rt{name}", type_, NO_HEAD, qos)

    def subscribe(
        self, name: str, type_: MessageType, qos: Qos, received: Received, left: Left
    ) -> DdsReader:
        """Subscribe to a topic."""
        return self._subscribe(f"rt{name}", type_, qos, received, left=left)

    def serve(self, name: str, type_: ServiceType, respond: Respond) -> Closable:
        """Offer a service; ConfigError if nobody has said that peers have rmw_cyclonedds_cpp."""
        if not self.serves:
            raise ConfigError("services over DDS need --dds-services, and peers that can call them")
        writer = self._advertise(f"rr{name}Reply", type_.response, HEAD, REQUESTS)
        refusal = self._types.encode(self._types.make(type_.response.name))
        server = ServiceResponder(name, respond, refusal, writer.write)
        reader = self._subscribe(
            f"rq{name}Request", type_.request, REQUESTS, server.take, head=HEAD
        )
        parts = ExitStack()  # closed from the last one to the first
        for each in (writer, server, reader):
            parts.callback(each.close)
        return parts

    def call(self, name: str, type_: ServiceType, request: bytes, timeout: float) -> bytes:
        """Call a service of a peer with rmw_cyclonedds_cpp; TimeoutError if nobody responds."""
        asked, answered = f"rq{name}Request", f"rr{name}Reply"
        with closing(self._advertise(asked, type_.request, HEAD, REQUESTS)) as writer:
            client = ServiceClient(writer.write)
            reader = self._subscribe(answered, type_.response, REQUESTS, client.take, head=HEAD)
            with closing(reader):
                until = monotonic() + timeout
                while not (writer.matched and reader.matched) and monotonic() < until:
                    sleep(LOOK)
                return client.call(request, max(LOOK, until - monotonic()))

    def graph(self) -> Graph:
        """Return the nodes and endpoints that are known now."""
        return self._discovery.graph()

    def on_failure(self, call: Failed) -> None:
        """Call `call`, in any thread, if nothing is received any more."""
        with self._lock:
            self._failed = call
            failed_before = self._has_failed
        if failed_before:
            call(FAILED)

    def close(self) -> None:
        """Leave the network."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
        self._entities.wake()
        self._thread.join()
        with self._lock:
            self._readers.clear()
            self._entities.close()
        self._unclear.close()
        DOMAINS.leave(self._options)

    def _advertise(
        self, topic: str, type_: MessageType, head: Mapping[str, str], qos: Qos
    ) -> DdsWriter:
        writer, sample = self._entities.writer(topic, type_, head, qos)
        guid = writer.guid.bytes
        self._discovery.add(guid, reads=False)
        self._tell()
        return DdsWriter(writer, sample, lambda: self._drop(writer, guid))

    def _subscribe(
        self,
        topic: str,
        type_: MessageType,
        qos: Qos,
        received: Received,
        *,
        head: Mapping[str, str] = NO_HEAD,
        left: Left = lambda gid: None,
    ) -> DdsReader:
        reader = self._entities.reader(topic, type_, head, qos)
        guid = reader.guid.bytes

        def release(made: DdsReader) -> None:
            with self._lock:
                if made in self._readers:
                    self._readers.remove(made)
            self._drop(reader, guid)

        made = DdsReader(reader, topic, received, left, release)
        with self._lock:
            self._readers.append(made)
        self._discovery.add(guid, reads=True)
        self._tell()
        self._entities.wake()  # for messages that came before the thread knew of it
        return made

    def _drop(self, endpoint: Any, guid: bytes) -> None:
        """Delete an endpoint, and tell the others."""
        self._entities.delete(endpoint)
        self._discovery.remove(guid)
        self._tell()

    def _tell(self) -> None:
        """Tell the others of our node and its endpoints."""
        with self._lock:
            if self._infos is not None and not self._closed:
                self._infos.write(self._discovery.own_info())

    def _take_info(self, cdr: bytes, gid: bytes) -> None:
        try:
            self._discovery.take_info(cdr)
        except ValueError:
            if gid not in self._unread and len(self._unread) < WARNINGS:
                self._unread.add(gid)
                log.warning(
                    "a program tells the names of its nodes as no program of ROS 2 %s does: if it"
                    " is of another distribution, say which with --distro",
                    self._types.distro.name,
                )

    def _take(self) -> None:
        """Take everything that comes, until the end; in a thread."""
        try:
            while not self._closed:
                self._take_some(self._entities.wait())
        except Exception:
            log.exception("the thread of DDS has failed: nothing is received any more")
            self._fail()

    def _fail(self) -> None:
        """Tell that nobody is heard any more: a robot that somebody drives must stop."""
        with self._lock:
            self._has_failed, failed, readers = True, self._failed, list(self._readers)
        for reader in readers:
            reader.lose_all()
        if failed is not None:
            failed(FAILED)

    def _take_some(self, only: Sequence[Any] | None = None) -> None:
        """Take a part of all that has come: news, messages, and departures after them.

        Nothing else has come if `only` these readers of the library have messages.
        """
        participants, writers, ended = self._arrivals() if only is None else ((), (), ())
        with self._lock:
            readers = [each for each in self._readers if only is None or each.reader in only]
        for reader in readers:
            reader.take()
        for guid in participants:
            self._discovery.lose_participant(guid)
        for guid in ended:
            self._discovery.lose_endpoint(guid)
        for guid in writers:
            if lost := self._discovery.lose_endpoint(guid):
                self._lose(f"rt{lost.name}", guid)

    def _arrivals(self) -> tuple[list[bytes], list[bytes], list[bytes]]:
        """Take note of new endpoints; return participants, writers and readers that are gone."""
        gone: tuple[list[bytes], list[bytes], list[bytes]] = [], [], []
        of_participants, _, of_readers = self._news
        for reader, lost in zip(self._news, gone, strict=True):
            for each in self._told(reader):
                if not each.sample_info.valid_data:
                    lost.append(each.key.bytes)
                elif reader is not of_participants:
                    self._discovery.take_endpoint(each, reads=reader is of_readers)
        return gone

    def _told(self, reader: Any) -> Iterator[Any]:
        """Yield news, taken one by one: with one that cannot be read all others would be lost."""
        from cyclonedds.core import DDSException

        for _ in range(SAMPLES):
            try:
                taken = reader.take(1)
            except DDSException:
                raise
            except Exception as error:  # the library has no class for, say, names without UTF-8
                self._unclear.add(error)
                continue
            if not taken:
                return
            yield taken[0]

    def _lose(self, topic: str, gid: bytes) -> None:
        with self._lock:
            readers = [reader for reader in self._readers if reader.topic == topic]
        for reader in readers:
            reader.lose(gid)
