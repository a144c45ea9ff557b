"""The reason that the robot stands still, in one sentence."""

from collections.abc import Iterator
from typing import Literal

from pioneer3.robot.limits import limit
from pioneer3.robot.pilot import STANDING, Pilot
from pioneer3.state import Snapshot

SILENT = 0.5
IDLE = "Nothing is asked of it"
_STANDING = "It stands because of "
_EXPIRED = "The last command expired after "
_SWITCHING_ON = "The motors are off; they are being switched on."
_STAY_OFF = "The motors are off, and commands do not switch them on: switch them on first."
_SENT = "The command has just been sent; the wheels do not turn yet."


def why_not_moving(
    pilot: Pilot, snapshot: Snapshot | None, now: float, decided: str | None = None
) -> str | None:
    """Return the reason to remove first; `None` while the robot moves.

    Args:
        pilot: Of the robot; has the last command.
        snapshot: The latest of the session that is open, or `None` without one.
        now: [s, monotonic].
        decided: The reason for a command to stand still, if there was one.
    """
    if snapshot is None:
        return f"No robot is connected{f': {pilot.blocked}' if pilot.blocked else ''}."
    twist = snapshot.odometry.twist
    if abs(twist.v) >= STANDING.v or abs(twist.w) >= STANDING.w:
        return None
    return next(_reasons(pilot, snapshot, now, decided))


def kind_of(why: str | None) -> Literal["idle", "normal", "fault"] | None:
    """Return the kind of a reason from :func:`why_not_moving`, `None` for none.

    `idle` means no command, `normal` a robot that works as it should, `fault` a robot that needs
    help.
    """
    if why is None:
        return None
    if why.startswith(IDLE):
        return "idle"
    normal = why.startswith((_STANDING, _EXPIRED, _SWITCHING_ON, _SENT))
    return "normal" if normal else "fault"


def _reasons(pilot: Pilot, snapshot: Snapshot, now: float, decided: str | None) -> Iterator[str]:
    """Yield the reasons, the hardest to remove first."""
    silent = now - snapshot.stamp
    if pilot.emergency:
        yield "The emergency stop is latched: reset it, then ask again."
    if pilot.refusal:
        yield f"Nothing drives it: {pilot.refusal}."
    if snapshot.motors.stop_button:
        yield "The stop button on the robot is pressed: pull it out, then ask again."
    if silent > SILENT:
        yield f"The robot has said nothing for {silent:.1f} s: the link is failing."
    if pilot.blocked:
        yield f"Waiting for a fresh command: {pilot.last_stop.told}."
    if decided and pilot.asked(now).is_zero:
        yield f"{_STANDING}{decided}."
    yield from _about_the_request(pilot, snapshot, now)


def _about_the_request(pilot: Pilot, snapshot: Snapshot, now: float) -> Iterator[str]:
    limits, motors, asked = pilot.limits, snapshot.motors, pilot.asked(now)
    if pilot.enable_failed:
        yield (
            "The motors do not come on: is the stop button pressed, the charger plugged in, "
            "or the battery empty?"
        )
    if asked.is_zero and pilot.asked_for_motion and limits:
        yield (f"{_EXPIRED}{limits.expiry:g} s: send it again for as long as the robot shall move.")
    if asked.is_zero:
        yield f"{IDLE}{'' if motors.enabled else ', and the motors are off'}."
    if not motors.enabled:
        yield _SWITCHING_ON if pilot.switches_on else _STAY_OFF
    if motors.stalled:
        yield "The wheels are stalled: something blocks them."
    if limits and limit(asked, limits, snapshot.bumpers).is_zero:
        yield "A bumper touches something in that direction: drive the other way."
    yield _SENT
