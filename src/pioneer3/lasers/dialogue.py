"""The dialogue by which a client makes its laser scan, in any protocol. No I/O.

A script is a generator. It yields requests of its protocol, pauses, and events for the client's
caller; it is sent the answer to each request. Requests and answers are the protocol's own, and so
is how long the client waits for one, and when it repeats a request.
"""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Generic, TypeVar

from pioneer3.lasers.client import Event, ScansLost

RequestT = TypeVar("RequestT")
ReplyT = TypeVar("ReplyT")
ResultT = TypeVar("ResultT")


@dataclass(frozen=True, slots=True)
class Pause:
    """Send nothing for some time [s]."""

    seconds: float


class HopelessError(Exception):
    """The laser cannot be brought to send scans; the reason for people."""


Script = Generator[RequestT | Pause | Event, ReplyT, ResultT]


class Dialogue(Generic[RequestT, ReplyT, ResultT]):
    """Runs a script from one request or pause to the next.

    `step` is the one that the script waits for, `None` before and after it runs. Once the script
    has `finished`, there is its `result`, and the laser is to scan.
    """

    def __init__(self, script: Script[RequestT, ReplyT, ResultT]) -> None:
        self.step: RequestT | Pause | None = None
        self.result: ResultT | None = None
        self.finished = False
        self._script = script

    def go_on(self, reply: ReplyT | None) -> list[Event]:
        """Send the script `reply`, `None` at its begin; return its events up to its next step."""
        events: list[Event] = []
        self.step = None
        try:
            step = next(self._script) if reply is None else self._script.send(reply)
            while isinstance(step, Event):
                events.append(step)
                step = next(self._script)
            self.step = step
        except StopIteration as end:
            self.result, self.finished = end.value, True
        except HopelessError as error:
            events.append(ScansLost(str(error)))
        return events
