"""What one decision costs, with as many echoes as the sonars' memory holds, and with a laser."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, radians, sin
from random import Random
from time import perf_counter

from benchmarks.table import Row
from pioneer3.behaviors.action import Situation
from pioneer3.behaviors.engine import resolve
from pioneer3.behaviors.memory import SONAR, RangeMemory
from pioneer3.behaviors.modes import Preset, wander
from pioneer3.behaviors.surroundings import Surroundings
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import load_model
from pioneer3.state import Battery, Motors, Odometry, Scan, Snapshot

DECISIONS, ROUNDS = 300, 9
BAR_US = 200.0
LASER_BAR_US = 5000.0
READINGS = 1081
"""Of a UTM-30LX: three quarters of a turn."""
PRESETS: tuple[Preset, ...] = ("lab", "aria", "explore")


def situations() -> list[Situation]:
    """Return a robot on its way in a room, at ten readings a second."""
    random, model = Random(1), load_model("p3at-sh")
    limits = Limits(max_speed=0.75, max_turn_rate=1.7)
    found = []
    for n in range(DECISIONS):
        pose, twist = Pose2(0.015 * n, 0.0, 0.01 * n), Twist2(0.15, 0.1)
        motion = Odometry(robot_in_odom=pose, twist=twist, left_speed=0.15, right_speed=0.15)
        echoes = [
            (pose.x + d * cos(b), pose.y + d * sin(b))
            for d, b in ((random.uniform(0.9, 3), random.uniform(-3, 3)) for _ in range(64))
        ]
        found.append(
            Situation(
                now=0.1 * n,
                snapshot=Snapshot(
                    stamp=0.1 * n,
                    sequence=n,
                    odometry=motion,
                    battery=Battery(voltage=12.0),
                    motors=Motors(enabled=True),
                ),
                model=model,
                limits=limits,
                around=Surroundings(pose, echoes[: SONAR.current], echoes, echoes),
            )
        )
    return found


def microseconds(preset: Preset) -> float:
    """Return what one decision takes at best [us]; echoes are turned into the robot's frame."""
    best = float("inf")
    for _ in range(ROUNDS):
        stack, seen = wander(preset=preset), situations()
        began = perf_counter()
        for situation in seen:
            resolve([stack], situation)
        best = min(best, perf_counter() - began)
    return best / DECISIONS * 1e6


def scan_of(situation: Situation, random: Random) -> Scan:
    """Return what a laser sees in a room with a wall 1.5 m to 4 m away all around."""
    step, snapshot = radians(270) / (READINGS - 1), situation.snapshot
    return Scan(
        stamp=snapshot.stamp,
        sequence=snapshot.sequence,
        robot_in_odom=situation.pose,
        sensor_in_robot=Pose2(0.1),
        angles=tuple(n * step - radians(135) for n in range(READINGS)),
        ranges=tuple(random.uniform(1.5, 4.0) for _ in range(READINGS)),
        last_in_odom=situation.pose @ Pose2(0.004, 0.0, 0.003),
    )


def microseconds_with_laser(preset: Preset) -> float:
    """Return what a snapshot with a new scan costs at best [us]: to remember, and to decide."""
    best, random, seen = float("inf"), Random(1), situations()[: DECISIONS // 3]
    scans = [scan_of(situation, random) for situation in seen]
    for _ in range(ROUNDS):
        stack, memory = wander(preset=preset), RangeMemory(seen[0].model)
        began = perf_counter()
        for situation, scan in zip(seen, scans, strict=True):
            memory.update(situation.snapshot, [scan])
            resolve([stack], replace(situation, around=memory.around(situation.now)))
        best = min(best, perf_counter() - began)
    return best / len(seen) * 1e6


def rows() -> Iterator[Row]:
    """Measure every way of wandering."""
    for preset in PRESETS:
        yield Row(f"behaviors: one decision, wander {preset}", microseconds(preset), "us", BAR_US)
    for preset in PRESETS:
        name = f"behaviors: {READINGS} readings and a decision, wander {preset}"
        yield Row(name, microseconds_with_laser(preset), "us", LASER_BAR_US)
