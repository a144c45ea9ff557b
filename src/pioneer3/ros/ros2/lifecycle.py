"""The life cycle of a managed node: its states, transitions and services; no network.

States and transitions are those of the design page "Managed nodes"
(https://design.ros2.org/articles/node_lifecycle.html), their numbers those of `lifecycle_msgs`,
their labels those of rcl_lifecycle since Humble.
"""

import logging
import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum
from types import MappingProxyType
from typing import Any, Final

from pioneer3.ros.ros2.parameter_services import Service
from pioneer3.ros.ros2.types import MessageTypes

log = logging.getLogger(__name__)


class LifecycleState(IntEnum):
    """The states; those from 10 on last as long as a callback does."""

    UNKNOWN = 0
    UNCONFIGURED = 1
    INACTIVE = 2
    ACTIVE = 3
    FINALIZED = 4
    CONFIGURING = 10
    CLEANINGUP = 11
    SHUTTINGDOWN = 12
    ACTIVATING = 13
    DEACTIVATING = 14
    ERRORPROCESSING = 15

    @property
    def label(self) -> str:
        """Such as `unconfigured`."""
        return self.name.lower()


class TransitionOutcome(Enum):
    """The outcomes of a callback; the values are labels of transitions."""

    SUCCESS = "transition_success"
    FAILURE = "transition_failure"
    ERROR = "transition_error"


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition: its number, its label, and the states before and after it."""

    id: int
    label: str
    start: LifecycleState
    goal: LifecycleState


def _attempt(
    number: int, label: str, start: LifecycleState, during: LifecycleState, goal: LifecycleState
) -> tuple[Transition, ...]:
    """Return the transition to the state `during`, and those out of it, by the outcome."""
    outcome = 10 * number
    return (
        Transition(number, label, start, during),
        Transition(outcome, TransitionOutcome.SUCCESS.value, during, goal),
        Transition(outcome + 1, TransitionOutcome.FAILURE.value, during, start),
        Transition(
            outcome + 2, TransitionOutcome.ERROR.value, during, LifecycleState.ERRORPROCESSING
        ),
    )


UNCONFIGURED, INACTIVE, ACTIVE = (
    LifecycleState.UNCONFIGURED,
    LifecycleState.INACTIVE,
    LifecycleState.ACTIVE,
)
SHUTTINGDOWN, ERRORPROCESSING = LifecycleState.SHUTTINGDOWN, LifecycleState.ERRORPROCESSING
TRANSITIONS: Final = (
    *_attempt(1, "configure", UNCONFIGURED, LifecycleState.CONFIGURING, INACTIVE),
    *_attempt(2, "cleanup", INACTIVE, LifecycleState.CLEANINGUP, UNCONFIGURED),
    *_attempt(3, "activate", INACTIVE, LifecycleState.ACTIVATING, ACTIVE),
    *_attempt(4, "deactivate", ACTIVE, LifecycleState.DEACTIVATING, INACTIVE),
    Transition(5, "shutdown", UNCONFIGURED, SHUTTINGDOWN),
    Transition(6, "shutdown", INACTIVE, SHUTTINGDOWN),
    Transition(7, "shutdown", ACTIVE, SHUTTINGDOWN),
    Transition(50, TransitionOutcome.SUCCESS.value, SHUTTINGDOWN, LifecycleState.FINALIZED),
    Transition(51, TransitionOutcome.FAILURE.value, SHUTTINGDOWN, LifecycleState.FINALIZED),
    Transition(52, TransitionOutcome.ERROR.value, SHUTTINGDOWN, ERRORPROCESSING),
    Transition(60, TransitionOutcome.SUCCESS.value, ERRORPROCESSING, UNCONFIGURED),
    Transition(61, TransitionOutcome.FAILURE.value, ERRORPROCESSING, LifecycleState.FINALIZED),
    Transition(62, TransitionOutcome.ERROR.value, ERRORPROCESSING, LifecycleState.FINALIZED),
)


Callbacks = Mapping[LifecycleState, Callable[[], bool]]
"""The work of states from 10 on, if any: it tells whether it succeeds; an exception is an error.

Work of CLEANINGUP undoes that of CONFIGURING. After an exception that of ERRORPROCESSING cleans up,
so that the node is as new; else it is finalized.
"""


class Lifecycle:
    """The state of a managed node, and its services; any thread may use them.

    Callbacks are called one at a time, by the thread that asks for the transition, and must not ask
    for another one. `changed` is given `lifecycle_msgs/msg/TransitionEvent` after each change of
    the state, without time stamp, which the caller fills in. `services` have type and function, by
    names such as `~/get_state`.
    """

    def __init__(
        self, types: MessageTypes, callbacks: Callbacks, changed: Callable[[Any], None]
    ) -> None:
        self.state = UNCONFIGURED
        self._types, self._callbacks, self._changed = types, callbacks, changed
        self._lock = threading.Lock()
        listed = "GetAvailableTransitions"
        self.services: Mapping[str, Service] = MappingProxyType(
            {
                f"~/{name}": (f"lifecycle_msgs/srv/{type_}", respond)
                for name, type_, respond in (
                    ("change_state", "ChangeState", self._change_state),
                    ("get_state", "GetState", self._get_state),
                    ("get_available_states", "GetAvailableStates", self._get_available_states),
                    ("get_available_transitions", listed, lambda _: self._told(self.available())),
                    ("get_transition_graph", listed, lambda _: self._told(TRANSITIONS)),
                )
            }
        )

    def trigger(self, wanted: str | int) -> bool:
        """Make a transition, by label or number; return whether it succeeded.

        It waits for one that is on the way. One that does not begin in the present state, or that
        callbacks alone can bring about, does not succeed and changes nothing.
        """
        with self._lock:
            asked = self._step(wanted)
            if asked is None or asked.label in {each.value for each in TransitionOutcome}:
                return False
            self._go(asked)
            outcome = self._work()
            if outcome is TransitionOutcome.ERROR:
                self._work()
            return outcome is TransitionOutcome.SUCCESS

    def available(self) -> tuple[Transition, ...]:
        """Return the transitions that begin in the present state."""
        return tuple(each for each in TRANSITIONS if each.start is self.state)

    def _step(self, wanted: str | int) -> Transition | None:
        """Return the transition from the present state; by label, or by number."""
        return next((each for each in self.available() if wanted in {each.id, each.label}), None)

    def _work(self) -> TransitionOutcome:
        """Call the callback of the present state, and leave the state; return the outcome."""
        try:
            succeeded = self._callbacks.get(self.state, lambda: True)()
        except Exception:  # it must not leave the node between two states
            log.exception("the node fails while it is %s", self.state.label)
            outcome = TransitionOutcome.ERROR
        else:
            outcome = TransitionOutcome.SUCCESS if succeeded else TransitionOutcome.FAILURE
        step = self._step(outcome.value)
        assert step is not None
        self._go(step)
        return outcome

    def _go(self, transition: Transition) -> None:
        self.state = transition.goal
        event = self._types.make("lifecycle_msgs/TransitionEvent")
        self._fill(event, transition)
        self._changed(event)

    def _change_state(self, request: Any) -> Any:
        """Change the state: the label counts, or the number where there is none."""
        response = self._types.make("lifecycle_msgs/srv/ChangeState_Response")
        response.success = self.trigger(request.transition.label or int(request.transition.id))
        return response

    def _get_state(self, _: Any) -> Any:
        response = self._types.make("lifecycle_msgs/srv/GetState_Response")
        _fill_state(response.current_state, self.state)
        return response

    def _get_available_states(self, _: Any) -> Any:
        response = self._types.make("lifecycle_msgs/srv/GetAvailableStates_Response")
        for state in LifecycleState:
            response.available_states.append(self._types.make("lifecycle_msgs/State"))
            _fill_state(response.available_states[-1], state)
        return response

    def _told(self, transitions: Iterable[Transition]) -> Any:
        response = self._types.make("lifecycle_msgs/srv/GetAvailableTransitions_Response")
        for each in transitions:
            message = self._types.make("lifecycle_msgs/TransitionDescription")
            response.available_transitions.append(message)
            self._fill(message, each)
        return response

    def _fill(self, message: Any, transition: Transition) -> None:
        message.transition.id, message.transition.label = transition.id, transition.label
        _fill_state(message.start_state, transition.start)
        _fill_state(message.goal_state, transition.goal)


def _fill_state(message: Any, state: LifecycleState) -> None:
    message.id, message.label = int(state), state.label
