"""Why the robot stands still, in one sentence."""

from collections.abc import Iterator

from pioneer3.robot.limits import limit
from pioneer3.robot.pilot import STANDING, Pilot
from pioneer3.state import Snapshot

SILENT = 0.5


def why_not_moving(
    pilot: Pilot, snapshot: Snapshot | None, now: float, decided: str | None = None
) -> str | None:
    """Return the reason, the one to be mended first; `None` while the robot moves.

    Args:
        pilot: What was asked for.
        snapshot: The latest of the session that is open, or `None` without one.
        now: [s, monotonic].
        decided: Why standing still is what was asked for, if somebody asked for that.
    """
    if snapshot is None:
        return f"No robot is connected{f': {pilot.blocked}' if pilot.blocked else ''}."
    twist = snapshot.odometry.twist
    if abs(twist.v) >= STANDING.v or abs(twist.w) >= STANDING.w:
        return None
    return next(_reasons(pilot, snapshot, now, decided))


def _reasons(pilot: Pilot, snapshot: Snapshot, now: float, decided: str | None) -> Iterator[str]:
    """Yield what keeps the robot from moving, the hardest obstacle first."""
    silent = now - snapshot.stamp
    if pilot.emergency:
        yield "The emergency stop is latched: reset it, then ask again."
    if snapshot.motors.stop_button:
        yield "The stop button on the robot is pressed: pull it out, then ask again."
    if silent > SILENT:
        yield f"The robot has said nothing for {silent:.1f} s: the link is failing."
    if pilot.blocked:
        yield f"Waiting for a fresh command: {pilot.last_stop.told}."
    if decided and pilot.asked(now).is_zero:
        yield f"It stands because of {decided}."
    yield from _about_the_request(pilot, snapshot, now)


def _about_the_request(pilot: Pilot, snapshot: Snapshot, now: float) -> Iterator[str]:
    limits, motors, asked = pilot.limits, snapshot.motors, pilot.asked(now)
    if pilot.enable_failed:
        yield (
            "The motors do not come on: is the stop button pressed, the charger plugged in, "
            "or the battery empty?"
        )
    if asked.is_zero and pilot.expired and limits:
        yield (
            f"The last command expired after {limits.expiry:g} s: "
            "send it again for as long as the robot shall move."
        )
    if asked.is_zero:
        yield f"Nothing is asked of it{'' if motors.enabled else ', and the motors are off'}."
    if not motors.enabled:
        yield "The motors are off; they are being switched on."
    if motors.stalled:
        yield "The wheels are stalled: something blocks them."
    if limits and limit(asked, limits, snapshot.bumpers).is_zero:
        yield "A bumper touches something in that direction: drive the other way."
    yield "The command has just been sent; the wheels do not turn yet."
