"""What the server tells the page: JSON, one object a message, told apart by `type`."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

import msgspec

from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.robot.identity import kind
from pioneer3.robot.supervisor import RobotInfo, Status
from pioneer3.runtime.arbiter import Ended
from pioneer3.state import Snapshot
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web.guest import Guest

SONAR_MAX = 5.0
DEFAULT_SPEED, DEFAULT_TURN_RATE = 0.3, 0.6


def encode(message: dict[str, Any]) -> str:
    """Return the JSON text of a message to the page."""
    return msgspec.json.encode(message).decode()


def hello(
    version: str,
    robots: Sequence[dict[str, Any]],
    models: list[dict[str, str]] | None = None,
) -> dict[str, Any]:
    """Say what is here: `robots` as :func:`robot` tells of them, and what can join them.

    Without models the world is not the page's to change.
    """
    return {
        "type": "hello",
        "version": version,
        "robots": robots,
        "models": models,
        "gamepad": msgspec.to_builtins(SCHEME),
    }


def robot(number: int, name: str, info: RobotInfo | None, *, laser: bool = False) -> dict[str, Any]:
    """Say what a robot is and looks like, how fast it may be driven, and if it has a laser."""
    return {
        "id": number,
        "name": name,
        "connection": kind(info) if info else "ROBOT",
        "url": info.url if info else "",
        "robot": _shape(info.identity.name, info.model) if info else None,
        "limits": _limits(info.limits) if info else None,
        "laser": laser,
    }


def status(number: int, now: Status) -> dict[str, Any]:
    """Say how it stands with the link of a robot."""
    return {
        "type": "status",
        "robot": number,
        "state": now.connection.value,
        "message": now.message,
    }


def snapshot(
    number: int,
    now: Snapshot,
    *,
    pose: Pose2,
    why: str | None,
    standing: str | None = None,
    emergency_stop: bool,
    driver: dict[str, Any] | None,
    mode: str | None = None,
    decided: Sequence[str] = (),
    ended: Ended | None = None,
    commanded: Twist2 | None = None,
    target: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Say how it stands with a robot, ten times a second.

    `pose` is the robot's in the map; `why` says why it does not move, and `standing` of which kind
    that is (:func:`pioneer3.robot.explain.kind_of`); `driver` is as :func:`somebody` tells;
    `decided` says who in the running `mode` decides what, `target` as :func:`goal` tells where it
    is going, and `ended` how the last one ended; `commanded` is what the robot was last told to do.
    """
    battery, motors = now.battery, now.motors
    return {
        "robot": number,
        "sequence": now.sequence,
        "pose": _pose(pose),
        "twist": _twist(now.odometry.twist),
        "sonar": {
            "ranges": [r if isfinite(r) else None for r in now.sonar.ranges],
            "enabled": now.sonar.enabled,
        },
        "bumpers": {"front": now.bumpers.front, "rear": now.bumpers.rear},
        "battery": {
            "voltage": battery.voltage,
            "charge": battery.charge,
            "charging": battery.charging.value,
            "low": battery.low,
        },
        "motors": {
            "enabled": motors.enabled,
            "stalled": motors.stalled,
            "moving": motors.moving,
            "stop_button": motors.stop_button,
        },
        "link": {
            "rate": now.link.rate,
            "bad_checksums": now.link.bad_checksums,
            "reports": now.link.reports,
            "sessions": now.link.sessions,
        },
        "faults": now.faults,
        "why": why,
        "standing": standing,
        "emergency_stop": emergency_stop,
        "driver": driver,
        "mode": mode,
        "decided": decided,
        "ended": {"mode": ended.mode.name, "done": ended.done, "why": ended.why} if ended else None,
        "commanded": _twist(commanded) if commanded else None,
        "target": target,
    }


def goal(place: Pose2, *, heads: bool, person: bool) -> dict[str, Any]:
    """Say where a robot is going, in the map; `person` if it follows whom it takes to be there."""
    return {
        "x": round(place.x, 3),
        "y": round(place.y, 3),
        "heading": round(place.theta, 3) if heads else None,
        "person": person,
    }


def somebody(name: str, number: int | None) -> dict[str, Any]:
    """Say who it is: `id` is the number of a guest, `None` for a script or the like."""
    return {"id": number, "name": name}


def people(you: Guest, number: int, wheels: msgspec.Raw, guests: msgspec.Raw) -> dict[str, Any]:
    """Say who you are, who else is here, and who has which wheel."""
    return {
        "type": "people",
        "id": number,
        "name": you.name,
        "role": you.role.value,
        "wheels": wheels,
        "guests": guests,
    }


def _shape(name: str, model: RobotModel) -> dict[str, Any]:
    return {
        "name": name,
        "model": model.name,
        "title": model.title,
        "length_front": model.length_front,
        "length_rear": model.length_rear,
        "width": model.width,
        "sonars": [{"x": s.x, "y": s.y, "theta": s.theta} for s in model.sonars],
        "front_bumpers": model.front_bumpers,
        "rear_bumpers": model.rear_bumpers,
        "sonar_max": SONAR_MAX,
    }


def _limits(limits: Limits) -> dict[str, float]:
    return {
        "speed": limits.max_speed,
        "turn_rate": limits.max_turn_rate,
        "default_speed": min(DEFAULT_SPEED, limits.max_speed),
        "default_turn_rate": min(DEFAULT_TURN_RATE, limits.max_turn_rate),
    }


def _pose(pose: Pose2) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "theta": pose.theta}


def _twist(twist: Twist2) -> dict[str, float]:
    return {"v": twist.v, "w": twist.w}
