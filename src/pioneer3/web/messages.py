"""What the server tells the page: JSON, one object a message, told apart by `type`."""

from collections.abc import Sequence
from math import isfinite
from typing import Any, Literal

import msgspec

from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.identity import kind
from pioneer3.runtime.scene import Scene
from pioneer3.sim.maps import LineMap
from pioneer3.state import Snapshot

SONAR_MAX = 5.0
DEFAULT_SPEED, DEFAULT_TURN_RATE = 0.3, 0.6


def encode(message: dict[str, Any]) -> str:
    """Return the JSON text of a message to the page."""
    return msgspec.json.encode(message).decode()


def hello(
    version: str,
    info: RobotInfo | None,
    scene: Scene,
    models: list[dict[str, str]] | None = None,
) -> dict[str, Any]:
    """Say what is connected, how it looks, where it drives, and what `models` can join it there.

    Without models the world is not the page's to change.
    """
    return {
        "type": "hello",
        "version": version,
        "connection": kind(info) if info else "ROBOT",
        "url": info.url if info else "",
        "robot": _robot(info.identity.name, info.model) if info else None,
        "limits": _limits(info.limits) if info else None,
        "map": _map(scene.map) if scene.map else None,
        "models": models,
    }


def snapshot(
    now: Snapshot,
    *,
    pose: Pose2,
    why: str | None,
    emergency_stop: bool,
    driver: Literal["you", "other"] | None,
    mode: str | None = None,
    decided: Sequence[str] = (),
) -> dict[str, Any]:
    """Say how it stands, ten times a second.

    `pose` is the robot's in the map; `decided` says who in the running `mode` decides what.
    """
    battery, motors = now.battery, now.motors
    return {
        "type": "snapshot",
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
        "emergency_stop": emergency_stop,
        "driver": driver,
        "mode": mode,
        "decided": decided,
    }


def _robot(name: str, model: RobotModel) -> dict[str, Any]:
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


def _map(line_map: LineMap) -> dict[str, Any]:
    return {"name": line_map.name, "walls": line_map.walls.round(4).tolist()}


def _pose(pose: Pose2) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "theta": pose.theta}


def _twist(twist: Twist2) -> dict[str, float]:
    return {"v": twist.v, "w": twist.w}
