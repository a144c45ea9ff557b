"""The reason that the robot stands still: a kind, and one sentence."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import final

from pioneer3.robot.limits import limit
from pioneer3.robot.pilot import REPORT_TIMEOUT, Pilot, stands
from pioneer3.state import Snapshot


class ReasonKind(StrEnum):
    """Kinds of reasons to stand still."""

    IDLE = "idle"
    """Nothing is asked of the robot."""
    NORMAL = "normal"
    """The robot works as it should."""
    FAULT = "fault"
    """The robot needs help."""


@final
@dataclass(frozen=True, slots=True)
class Reason:
    """The reason that a robot stands still; as a string, the sentence for people."""

    kind: ReasonKind
    text: str

    def __str__(self) -> str:
        return self.text


def why_not_moving(
    pilot: Pilot, snapshot: Snapshot | None, now: float, decided: str | None = None
) -> Reason | None:
    """Return the reason to remove first; `None` while the robot moves.

    The `snapshot` is the latest of the session that is open, `decided` the reason for a command to
    stand still, if there was one.
    """
    if snapshot is None:
        lost = f": {pilot.blocked}" if pilot.blocked else ""
        return Reason(ReasonKind.FAULT, f"No robot is connected{lost}.")
    if not stands(snapshot):
        return None
    return next(_reasons(pilot, snapshot, now, decided))


def _reasons(pilot: Pilot, snapshot: Snapshot, now: float, decided: str | None) -> Iterator[Reason]:
    """Yield the reasons, the hardest to remove first."""
    fault, silent = ReasonKind.FAULT, now - snapshot.stamp
    if pilot.emergency:
        yield Reason(fault, "The emergency stop is latched: reset it, then ask again.")
    if pilot.refusal:
        yield Reason(fault, f"Nothing drives it: {pilot.refusal}.")
    if snapshot.motors.stop_button:
        yield Reason(fault, "The stop button on the robot is pressed: pull it out, then ask again.")
    if silent > REPORT_TIMEOUT:
        yield Reason(fault, f"The robot has said nothing for {silent:.1f} s: the link is failing.")
    if pilot.blocked:
        yield Reason(fault, f"Waiting for a fresh command: {pilot.last_stop.told}.")
    if decided and pilot.asked(now).is_zero:
        yield Reason(ReasonKind.NORMAL, f"It stands because of {decided}.")
    yield from _about_the_request(pilot, snapshot, now)


def _about_the_request(pilot: Pilot, snapshot: Snapshot, now: float) -> Iterator[Reason]:
    limits, motors, asked = pilot.limits, snapshot.motors, pilot.asked(now)
    fault, normal = ReasonKind.FAULT, ReasonKind.NORMAL
    if pilot.enable_failed:
        yield Reason(
            fault,
            "The motors do not come on: is the stop button pressed, the charger plugged in, "
            "or the battery empty?",
        )
    if asked.is_zero and pilot.asked_for_motion and limits:
        yield Reason(
            normal,
            f"The last command expired after {limits.expiry:g} s: send it again for as long as"
            " the robot shall move.",
        )
    if asked.is_zero:
        off = "" if motors.enabled else ", and the motors are off"
        yield Reason(ReasonKind.IDLE, f"Nothing is asked of it{off}.")
    if not motors.enabled and pilot.switches_on:
        yield Reason(normal, "The motors are off; they are being switched on.")
    if not motors.enabled:
        yield Reason(
            fault, "The motors are off, and commands do not switch them on: switch them on first."
        )
    if motors.stalled:
        yield Reason(fault, "The wheels are stalled: something blocks them.")
    if limits and limit(asked, limits, snapshot.bumpers).is_zero:
        yield Reason(fault, "A bumper touches something in that direction: drive the other way.")
    yield Reason(normal, "The command has just been sent; the wheels do not turn yet.")
