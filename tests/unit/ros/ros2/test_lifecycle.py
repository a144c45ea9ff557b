"""The life cycle of a managed node: requests in, calls, responses and events out."""

from collections.abc import Callable
from threading import Event, Thread
from typing import Any

import pytest

from pioneer3.ros.ros2.distros import distro_of, distros
from pioneer3.ros.ros2.lifecycle import TRANSITIONS, Lifecycle, LifecycleState
from pioneer3.ros.ros2.types import MessageTypes

TYPES = MessageTypes(distro_of("jazzy"))
UNCONFIGURED, INACTIVE, ACTIVE = (
    LifecycleState.UNCONFIGURED,
    LifecycleState.INACTIVE,
    LifecycleState.ACTIVE,
)
FINALIZED = LifecycleState.FINALIZED


class Node:
    """A managed node whose services are called over the wire; `results` are its outcomes."""

    def __init__(self, **results: bool | Exception) -> None:
        self.calls: list[tuple[str, LifecycleState]] = []
        self.events: list[Any] = []
        self.lifecycle = Lifecycle(
            TYPES,
            {
                LifecycleState.CONFIGURING: self.callback("configure", results),
                LifecycleState.ACTIVATING: self.callback("activate", results),
                LifecycleState.DEACTIVATING: self.callback("deactivate", results),
                LifecycleState.CLEANINGUP: self.callback("cleanup", results),
                LifecycleState.SHUTTINGDOWN: self.callback("shutdown", results),
                LifecycleState.ERRORPROCESSING: self.callback("error", results),
            },
            self.events.append,
        )

    def callback(self, name: str, results: dict[str, bool | Exception]) -> Callable[[], bool]:
        def call() -> bool:
            self.calls.append((name, self.lifecycle.state))
            result = results.get(name, True)
            if isinstance(result, Exception):
                raise result
            return result

        return call

    def call(self, name: str, transition: str | int = "") -> Any:
        type_name, respond = self.lifecycle.services[f"~/{name}"]
        type_ = TYPES.service_type(type_name)
        request = TYPES.make(type_.request.name)
        if isinstance(transition, int):
            request.transition.id = transition
        elif transition:
            request.transition.label = transition
        response = respond(TYPES.decode(TYPES.encode(request), type_.request.name))
        return TYPES.decode(TYPES.encode(response), type_.response.name)

    def change(self, *transitions: str | int) -> list[bool]:
        return [self.call("change_state", each).success for each in transitions]


@pytest.mark.parametrize("distro", distros())
def test_numbers_are_those_of_the_messages(distro: str) -> None:
    fields = MessageTypes(distro_of(distro)).fields
    constants = {name: n for name, _, n in fields["lifecycle_msgs/msg/State"][0]}
    for state in LifecycleState:
        kind = "TRANSITION" if state >= 10 else "PRIMARY"
        assert constants[f"{kind}_STATE_{state.name}"] == state
    constants = {name: n for name, _, n in fields["lifecycle_msgs/msg/Transition"][0]}
    for each in TRANSITIONS:
        ending = each.label.removeprefix("transition_").upper()
        if each.label == "shutdown":
            name = f"{each.start.name}_SHUTDOWN"
        elif each.start < 10:
            name = ending
        else:
            verbs = {"ERRORPROCESSING": "ERROR", "SHUTTINGDOWN": "SHUTDOWN"}
            verbs |= {"CLEANINGUP": "CLEANUP", "CONFIGURING": "CONFIGURE"}
            verbs |= {"ACTIVATING": "ACTIVATE", "DEACTIVATING": "DEACTIVATE"}
            name = f"ON_{verbs[each.start.name]}_{ending}"
        assert constants[f"TRANSITION_{name}"] == each.id


def test_a_whole_life_by_numbers_and_labels() -> None:
    node = Node()
    assert node.call("get_state").current_state.label == "unconfigured"
    assert node.change(1, 3) == [True, True]
    state = node.call("get_state").current_state
    assert (state.id, state.label) == (3, "active")
    assert node.change("deactivate", "cleanup", "configure", "activate", "shutdown") == [True] * 5
    assert node.lifecycle.state is FINALIZED
    assert [name for name, _ in node.calls] == [
        *("configure", "activate", "deactivate", "cleanup", "configure", "activate", "shutdown")
    ]
    assert node.calls[0][1] is LifecycleState.CONFIGURING
    assert node.calls[-1][1] is LifecycleState.SHUTTINGDOWN


def test_events_tell_each_change_of_the_state() -> None:
    node = Node()
    node.change("configure")
    told = [(e.start_state.label, e.goal_state.id, e.transition.label) for e in node.events]
    assert told == [
        ("unconfigured", 10, "configure"),
        ("configuring", 2, "transition_success"),
    ]
    assert TYPES.encode(node.events[0])


@pytest.mark.parametrize("transition", ["activate", 3, 2, 7, "none", 0, 99, 10, "shutdown "])
def test_what_does_not_begin_here_changes_nothing(transition: str | int) -> None:
    node = Node()
    assert node.change(transition) == [False]
    assert (node.lifecycle.state, node.calls, node.events) == (UNCONFIGURED, [], [])


def test_the_label_counts_before_the_number() -> None:
    node, request = Node(), TYPES.make("lifecycle_msgs/srv/ChangeState_Request")
    request.transition.id, request.transition.label = 3, "configure"
    assert node.lifecycle.services["~/change_state"][1](request).success
    assert node.lifecycle.state is INACTIVE


@pytest.mark.parametrize(
    ("before", "failing", "after"),
    [
        ([], "configure", UNCONFIGURED),
        (["configure"], "activate", INACTIVE),
        (["configure", "activate"], "deactivate", ACTIVE),
        (["configure"], "cleanup", INACTIVE),
        ([], "shutdown", FINALIZED),
    ],
)
def test_a_failure_leads_back_and_an_error_to_the_beginning(
    before: list[str], failing: str, after: LifecycleState
) -> None:
    node = Node(**{failing: False})
    assert node.change(*before, failing) == [True] * len(before) + [False]
    assert node.lifecycle.state is after
    for recovers, end in ((True, UNCONFIGURED), (False, FINALIZED), (OSError("no"), FINALIZED)):
        node = Node(**{failing: OSError("no port")}, error=recovers)
        assert node.change(*before, failing) == [True] * len(before) + [False]
        assert node.lifecycle.state is end
        assert node.calls[-1] == ("error", LifecycleState.ERRORPROCESSING)


def test_states_and_transitions_are_listed() -> None:
    node = Node()
    states = node.call("get_available_states").available_states
    assert [(each.id, each.label) for each in states][:3] == [
        (0, "unknown"),
        (1, "unconfigured"),
        (2, "inactive"),
    ]
    assert len(states) == 11
    now = node.call("get_available_transitions").available_transitions
    assert [(each.transition.id, each.transition.label) for each in now] == [
        (1, "configure"),
        (5, "shutdown"),
    ]
    graph = node.call("get_transition_graph").available_transitions
    assert len(graph) == len(TRANSITIONS) == 25
    first = graph[0]
    assert (first.start_state.label, first.goal_state.label) == ("unconfigured", "configuring")


def test_the_state_can_be_asked_for_while_a_transition_waits() -> None:
    began, go_on = Event(), Event()

    def configure() -> bool:
        began.set()
        return go_on.wait(30)

    lifecycle = Lifecycle(TYPES, {LifecycleState.CONFIGURING: configure}, lambda event: None)
    threads = [Thread(target=lifecycle.trigger, args=(name,)) for name in ("configure", "activate")]
    threads[0].start()
    assert began.wait(30)
    assert lifecycle.services["~/get_state"][1](None).current_state.label == "configuring"
    threads[1].start()
    go_on.set()
    for thread in threads:
        thread.join(30)
    assert lifecycle.state is ACTIVE
