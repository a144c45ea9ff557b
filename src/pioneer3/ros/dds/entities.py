"""The objects of Cyclone DDS that belong to one participant; none of them outlives its use."""

import threading
from collections.abc import Mapping, Sequence
from ctypes import addressof
from math import isinf
from typing import Any, Final, NamedTuple

from pioneer3.ros.dds.samples import SampleTypes
from pioneer3.ros.ros2.backend import MessageType, Qos
from pioneer3.ros.ros2.types import MessageTypes

FOREVER: Final = 10 * 1_000_000_000
"""Longest wait for anything [ns]."""
TRIGGERED: Final = 8
"""Readers with samples that are told apart; of more, all are looked at."""
Key = tuple[str, Any]
"""Name of a topic, and the class of its samples."""


class EndpointParts(NamedTuple):
    """The objects that end with an endpoint: its topic, and the condition of a reader."""

    key: Key
    condition: Any = None


class Entities:
    """Makes and deletes endpoints in a domain, and waits for samples; of use in any thread.

    The library itself keeps what it has made until the program ends.
    """

    def __init__(self, domain: int, types: MessageTypes) -> None:
        from cyclonedds.core import GuardCondition, WaitSet
        from cyclonedds.domain import DomainParticipant
        from cyclonedds.internal import dds_c_t
        from cyclonedds.qos import Policy
        from cyclonedds.qos import Qos as DdsQos

        self._samples = SampleTypes(types)
        self._participant = DomainParticipant(domain, qos=DdsQos(Policy.Userdata(b"enclave=/;")))
        self._waitset, self._woken = WaitSet(self._participant), GuardCondition(self._participant)
        self._waitset.attach(self._woken)
        self._triggered = (dds_c_t.attach * TRIGGERED)()
        self._topics: dict[Key, Any] = {}
        self._parts: dict[Any, EndpointParts] = {}
        self._readers: dict[int | None, Any] = {}
        self._lock = threading.RLock()  # two threads would register a type twice

    @property
    def guid(self) -> bytes:
        """Identity of the participant."""
        found: bytes = self._participant.guid.bytes
        return found

    def writer(
        self, topic: str, type_: MessageType, head: Mapping[str, str], qos: Qos
    ) -> tuple[Any, Any]:
        """Return a new writer, and the class of its samples."""
        from cyclonedds.pub import DataWriter

        with self._lock:
            key = topic, self._samples.of(type_, head)
            made = DataWriter(self._participant, self._topic(key), _dds_qos(qos, type_))
            self._parts[made] = EndpointParts(key)
        return made, key[1]

    def reader(self, topic: str, type_: MessageType, head: Mapping[str, str], qos: Qos) -> Any:
        """Return a new reader, whose samples end a :meth:`wait`."""
        from cyclonedds.sub import DataReader

        with self._lock:
            key = topic, self._samples.of(type_, head)
            made = DataReader(self._participant, self._topic(key), _dds_qos(qos, type_))
            self._parts[made] = EndpointParts(key, condition := self._attach(made))
            self._readers[self._mark(condition)] = made
        self.wake()  # for messages that came before it was attached
        return made

    def news(self) -> tuple[Any, Any, Any]:
        """Return readers of the news of participants, of writers, and of readers."""
        from cyclonedds import builtin

        participants, writers, readers = (
            builtin.BuiltinDataReader(self._participant, topic)
            for topic in (
                builtin.BuiltinTopicDcpsParticipant,
                builtin.BuiltinTopicDcpsPublication,
                builtin.BuiltinTopicDcpsSubscription,
            )
        )
        for each in (participants, writers, readers):
            self._attach(each)
        return participants, writers, readers

    def wait(self) -> Sequence[Any] | None:
        """Wait for samples or :meth:`wake`; return the readers with samples, if that is all.

        To ask each reader takes as long as all the rest.
        """
        from cyclonedds.core import DDSException

        number = self._waitset._waitset_wait(
            self._waitset._ref, self._triggered, TRIGGERED, FOREVER
        )
        if number < 0:
            raise DDSException(number)
        found = [self._readers.get(mark) for mark in self._triggered[:number]]
        if 0 < number <= TRIGGERED and None not in found:  # neither news nor a call of `wake`
            return found
        self._woken.set(False)
        return None

    def wake(self) -> None:
        """End the wait."""
        self._woken.set(True)

    def delete(self, endpoint: Any) -> None:
        """Delete an endpoint with all that it alone needs."""
        with self._lock:
            part = self._parts.pop(endpoint, None)
            if part is None:
                return
            if part.condition is not None:
                del self._readers[self._mark(part.condition)]
                self._waitset.detach(part.condition)
                _delete(part.condition)
            _delete(endpoint)
            if not any(each.key == part.key for each in self._parts.values()):
                _delete(self._topics.pop(part.key))

    def close(self) -> None:
        """Delete everything; nobody may wait any more."""
        with self._lock:
            for each in list(self._parts):
                self.delete(each)
            _delete(self._participant)

    def _topic(self, key: Key) -> Any:
        from cyclonedds.topic import Topic

        if key not in self._topics:
            self._topics[key] = Topic(self._participant, *key)
        return self._topics[key]

    def _mark(self, condition: Any) -> int:
        """Return the address by which the library names a condition that has triggered."""
        marks = (mark for attached, mark in self._waitset.attached if attached is condition)
        return addressof(next(marks))

    def _attach(self, reader: Any) -> Any:
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        condition = ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.NotRead)
        self._waitset.attach(condition)
        return condition


def _delete(entity: Any) -> None:
    if entity._entities.pop(entity._ref, None) is not None:
        entity._delete(entity._ref)


def _dds_qos(qos: Qos, type_: MessageType) -> Any:
    from cyclonedds.qos import Policy
    from cyclonedds.qos import Qos as DdsQos

    policies = [
        Policy.Reliability.Reliable(0) if qos.reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if qos.transient_local else Policy.Durability.Volatile,
        Policy.History.KeepLast(qos.depth),
        Policy.WriterDataLifecycle(autodispose=False),
    ]
    if qos.transient_local:
        policies.append(Policy.DurabilityService(0, Policy.History.KeepLast(qos.depth), -1, -1, -1))
    if not isinf(qos.lifespan):
        policies.append(Policy.Lifespan(round(qos.lifespan * 1e9)))
    if type_.hash:
        policies.append(Policy.Userdata(f"typehash={type_.hash};".encode()))
    return DdsQos(*policies)
