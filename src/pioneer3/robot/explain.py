"""The reason that the robot stands still: a kind, and one sentence."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final, final

from pioneer3.errors import Symptom
from pioneer3.robot.limits import limit
from pioneer3.robot.pilot import REPORT_TIMEOUT, Pilot, stands
from pioneer3.state import Snapshot


class ReasonKind(StrEnum):
    """Kinds of reasons to stand still."""

    IDLE = "idle"
    """Nothing is asked of the robot."""
    NORMAL = "normal"
    """The robot works as it should."""
    STOPPED = "stopped"
    """Something stopped the robot; it moves again for a fresh command."""
    FAULT = "fault"
    """The robot needs help."""


@final
@dataclass(frozen=True, slots=True)
class Reason:
    """The reason that a robot stands still; as a string, the sentence for people.

    `symptom` has a page of the book that says what mends it.
    """

    kind: ReasonKind
    text: str
    symptom: Symptom = Symptom.DOES_NOT_MOVE

    @property
    def wants_help(self) -> bool:
        """Whether somebody has to do something before the robot moves again."""
        return self.kind in {ReasonKind.STOPPED, ReasonKind.FAULT}

    def __str__(self) -> str:
        return self.text

    def about(self, detail: object) -> "Reason":
        """Return the reason with `detail` in its place in the text."""
        return replace(self, text=self.text.format(detail))


DISCONNECTED: Final = Reason(ReasonKind.FAULT, "No robot is connected{}.", Symptom.LOSES_THE_LINK)
LATCHED: Final = Reason(
    ReasonKind.FAULT,
    "The emergency stop is latched: reset it, then ask again.",
    Symptom.EMERGENCY_STOP,
)
REFUSED: Final = Reason(ReasonKind.FAULT, "Nothing drives it: {}.", Symptom.UNKNOWN_ROBOT)
PRESSED: Final = Reason(
    ReasonKind.FAULT,
    "The stop button on the robot is pressed: pull it out, then ask again.",
    Symptom.EMERGENCY_STOP,
)
SILENT: Final = Reason(
    ReasonKind.FAULT,
    "The robot has said nothing for {:.1f} s: the link is failing.",
    Symptom.LOSES_THE_LINK,
)
STOPPED: Final = Reason(ReasonKind.STOPPED, "Waiting for a fresh command: {}.")
DECIDED: Final = Reason(ReasonKind.NORMAL, "It stands because of {}.")
NO_POWER: Final = Reason(
    ReasonKind.FAULT,
    "The motors do not come on: is the stop button pressed, the charger plugged in, "
    "or the battery empty?",
)
EXPIRED: Final = Reason(
    ReasonKind.NORMAL,
    "The last command expired after {:g} s: send it again for as long as the robot shall move.",
    Symptom.STOPS_BY_ITSELF,
)
IDLE: Final = Reason(ReasonKind.IDLE, "Nothing is asked of it{}.")
IDLE_ON: Final = IDLE.about("")
IDLE_OFF: Final = IDLE.about(", and the motors are off")
SWITCHED_ON: Final = Reason(ReasonKind.NORMAL, "The motors are off; they are being switched on.")
SWITCHED_OFF: Final = Reason(
    ReasonKind.FAULT,
    "The motors are off, and commands do not switch them on: switch them on first.",
)
STALLED: Final = Reason(ReasonKind.FAULT, "The wheels are stalled: something blocks them.")
BUMPED: Final = Reason(
    ReasonKind.FAULT, "A bumper touches something in that direction: drive the other way."
)
JUST_SENT: Final = Reason(
    ReasonKind.NORMAL, "The command has just been sent; the wheels do not turn yet."
)
REASONS: Final = (
    *(DISCONNECTED, LATCHED, REFUSED, PRESSED, SILENT, STOPPED, DECIDED, NO_POWER, EXPIRED),
    *(IDLE, SWITCHED_ON, SWITCHED_OFF, STALLED, BUMPED, JUST_SENT),
)
"""All reasons, the hardest to remove first; braces have the place of a detail."""


def advised(why: Reason | None) -> str:
    """Return the sentence; where it wants help, followed by the command that opens its page."""
    if why is None:
        return ""
    return f"{why} See: {why.symptom.command}" if why.wants_help else why.text


def why_not_moving(
    pilot: Pilot, snapshot: Snapshot | None, now: float, decided: str | None = None
) -> Reason | None:
    """Return the reason to remove first; `None` while the robot moves.

    The `snapshot` is the latest of the session that is open, `decided` the reason for a command to
    stand still, if there was one.
    """
    if snapshot is None:
        return DISCONNECTED.about(f": {pilot.blocked}" if pilot.blocked else "")
    if not stands(snapshot):
        return None
    return next(_reasons(pilot, snapshot, now, decided))


FROM_READINGS: Final = frozenset(
    {PRESSED, IDLE_ON, IDLE_OFF, SWITCHED_ON, SWITCHED_OFF, STALLED, BUMPED, JUST_SENT}
)
"""Reasons that are told only where the readings allow it."""


def allowed(snapshot: Snapshot) -> frozenset[Reason | None]:
    """Return those that readings allow, whatever was asked; `None` alone where the robot moves."""
    motors = snapshot.motors
    if not stands(snapshot):
        return frozenset({None})
    if motors.stop_button:
        return frozenset({PRESSED})
    if not motors.enabled:
        return frozenset({IDLE_OFF, SWITCHED_ON, SWITCHED_OFF})
    return frozenset({IDLE_ON, STALLED} if motors.stalled else {IDLE_ON, BUMPED, JUST_SENT})


def _reasons(pilot: Pilot, snapshot: Snapshot, now: float, decided: str | None) -> Iterator[Reason]:
    """Yield the reasons, the hardest to remove first."""
    silent = now - snapshot.stamp
    if pilot.emergency:
        yield LATCHED
    if pilot.refusal:
        yield REFUSED.about(pilot.refusal)
    if snapshot.motors.stop_button:
        yield PRESSED
    if silent > REPORT_TIMEOUT:
        yield SILENT.about(silent)
    if pilot.blocked:
        stopped = STOPPED.about(pilot.last_stop.told)
        yield replace(stopped, kind=ReasonKind.FAULT) if pilot.last_stop.stalled else stopped
    if decided and pilot.asked(now).is_zero:
        yield DECIDED.about(decided)
    yield from _about_the_request(pilot, snapshot, now)


def _about_the_request(pilot: Pilot, snapshot: Snapshot, now: float) -> Iterator[Reason]:
    limits, motors, asked = pilot.limits, snapshot.motors, pilot.asked(now)
    if pilot.enable_failed:
        yield NO_POWER
    if asked.is_zero and pilot.asked_for_motion and limits:
        yield EXPIRED.about(limits.expiry)
    if asked.is_zero:
        yield IDLE_ON if motors.enabled else IDLE_OFF
    if not motors.enabled:
        yield SWITCHED_ON if pilot.switches_on else SWITCHED_OFF
    if motors.stalled:
        yield STALLED
    if limits and limit(asked, limits, snapshot.bumpers).is_zero:
        yield BUMPED
    yield JUST_SENT
