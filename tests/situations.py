"""Situations that tell how a robot moves: straight lines, squares, slopes, sills, edges, walls.

Each drives one robot in a world of its own, on a plane or with physics, without firmware, and
returns what a person beside it would measure.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import acos, cos, degrees, hypot, pi, radians, tan
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.dynamics import Dynamics, dynamics_of
from pioneer3.sim.realism import Realism
from pioneer3.sim.relief import Ramp, Step
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, WorldFile
from pioneer3.sim.worldfile.spec import Physics, Wall
from tests.support import moves

Float = NDArray[np.float64]

TICK = 0.02
LONGEST = 60.0
"""A drive that has not ended after so long has failed [s]."""
SLOPE = 10.0
"""Of the ramp [degrees]."""
EDGE = 0.3
"""Height of the platform that a robot drives over [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """One robot in a world, at rest at the origin with its motors on.

    Attributes:
        world: Where it is.
        body: The robot.
        dynamics: Of the world.
    """

    world: World
    body: Body
    dynamics: Dynamics

    @classmethod
    def of(
        cls,
        model: str,
        physics: Physics,
        file: WorldFile | None = None,
        *,
        start: Pose2 = ORIGIN,
        realism: Realism | None = None,
    ) -> "Drive":
        """Return a robot of this model, in the world of `file` or on an empty floor."""
        file = file or WorldFile(name="floor")
        body, dynamics = Body(load_model(model), start), dynamics_of(physics)
        line_map = file.line_map()
        world = World(
            line_map, [body], dynamics=dynamics, realism=realism, relief=file.relief(line_map)
        )
        for box in file.movable:
            world.add_obstacle(box)
        body.enable_motors(on=True)
        return cls(world=world, body=body, dynamics=dynamics)

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / TICK)):
            self.world.step(TICK)

    def finish(self, each: Callable[[], None] = lambda: None) -> None:
        """Let time pass until the robot stands; call `each` at every step."""
        self.wait(TICK)
        for _ in range(round(LONGEST / TICK)):
            if not moves(self.body.drive) and self.body.speeds == (0.0, 0.0):
                return
            self.world.step(TICK)
            each()

    @property
    def upright(self) -> Float:
        """The rotation of its body, shape (3, 3)."""
        scene = getattr(self.dynamics, "scene", None)
        if scene is None:
            return np.eye(3)
        rotation: Float = scene.data.xmat[scene.bodies[self.body.number]].reshape(3, 3)
        return rotation

    @property
    def tilt(self) -> float:
        """Between its own axis and the vertical [degrees]; 180 on its back."""
        return degrees(acos(max(-1.0, min(1.0, float(self.upright[2, 2])))))


def straight(model: str, physics: Physics, realism: Realism | None = None) -> tuple[float, float]:
    """Return how far aside 10 m end [mm], and turned by how much [degrees]."""
    drive = Drive.of(model, physics, realism=realism)
    drive.body.drive.linear.travel(10.0)
    drive.finish()
    pose = drive.body.robot_in_world
    return abs(pose.y) * 1000, abs(degrees(pose.theta))


def square(
    model: str, physics: Physics, turn: int, realism: Realism | None = None
) -> tuple[float, float]:
    """Return how far from its start a square of 4 m ends [m], and turned by how much [degrees].

    The robot measures sides and turns by its own odometry, as in UMBmark; `turn` is 1 for
    counter-clockwise, -1 for clockwise.
    """
    drive = Drive.of(model, physics, realism=realism)
    for corner in range(1, 5):
        drive.body.drive.linear.travel(4.0)
        drive.finish()
        drive.body.turn_to(wrap(turn * corner * pi / 2))
        drive.finish()
    pose = drive.body.robot_in_world
    return hypot(pose.x, pose.y), abs(degrees(pose.theta))


def brake(model: str, physics: Physics) -> tuple[float, float]:
    """Return the way from 0.7 m/s to rest [m], and the largest tilt [degrees]."""
    drive = Drive.of(model, physics)
    drive.body.drive.linear.go(0.7)
    drive.wait(6.0)
    began, tilts = drive.body.robot_in_world.x, [0.0]
    drive.body.drive.linear.go(0.0)
    drive.finish(lambda: tilts.append(drive.tilt))
    return drive.body.robot_in_world.x - began, max(tilts)


def slope(angle: float = SLOPE) -> WorldFile:
    """Return a ramp of this angle [degrees], 4 m long, that begins 0.6 m ahead."""
    length = 4.0 * cos(radians(angle))
    ramp = Ramp(
        pose=Pose2(0.6 + length / 2, 0.0), size=(length, 2.0), height=length * tan(radians(angle))
    )
    return WorldFile(name="slope", solids=(ramp,))


def climb(model: str, physics: Physics) -> tuple[float, float]:
    """Drive up a ramp of 10 degrees at 0.2 m/s, and stand on it with the motors on.

    Returns:
        The way made on the slope as a share of the way that was asked for, and how fast the robot
        creeps down while it stands [mm/s].
    """
    drive = Drive.of(model, physics, slope())
    drive.body.drive.linear.top = 0.2
    drive.body.drive.linear.go(0.2)
    drive.wait(8.0)
    began, asked = _along(drive, 0.0), 0.0
    drive.wait(5.0)
    asked = 0.2 * 5.0
    made = _along(drive, began) / asked
    drive.body.drive.linear.go(0.0)
    drive.wait(3.0)
    stood = _along(drive, 0.0)
    drive.wait(10.0)
    return made, abs(_along(drive, stood)) / 10.0 * 1000


def gets_up(model: str, angle: float) -> bool:
    """Return whether a robot gets up a ramp of this angle [degrees] at 0.3 m/s."""
    drive = Drive.of(model, "mujoco", slope(angle))
    drive.body.drive.linear.top = 0.3
    drive.body.drive.linear.go(0.3)
    drive.wait(5.0)
    began = _along(drive, 0.0)
    drive.wait(3.0)
    return _along(drive, began) > 0.9 * 0.3 * 3.0


def _along(drive: Drive, since: float) -> float:
    """Return the way along the slope since another place on it [m]; on a plane, along the floor."""
    return drive.body.robot_in_world.x / cos(radians(drive.tilt)) - since


def push(model: str, physics: Physics) -> float:
    """Return how far a box of 5 kg is pushed within 6 s at 0.2 m/s [m]."""
    box = Box(pose=Pose2(0.8, 0.0), size=(0.4, 0.4), movable=True)
    drive = Drive.of(model, physics, WorldFile(name="box", boxes=(box,)))
    drive.body.drive.linear.go(0.2)
    drive.wait(6.0)
    return drive.world.obstacles[0].pose.x - 0.8


def hit(model: str, physics: Physics) -> tuple[float, float]:
    """Drive into a wall at 0.3 m/s, push for 5 s, and back off.

    Returns:
        From the contact to the stall [s], infinite without one; and from the command to back off
        until the robot is 1 cm away [s].
    """
    wall = WorldFile(name="wall", walls=(Wall(points=((1.5, -2.0), (1.5, 2.0))),))
    drive, touched = Drive.of(model, physics, wall), 0.0
    drive.body.drive.linear.go(0.3)
    for _ in range(round(20.0 / TICK)):
        drive.world.step(TICK)
        touched += TICK * (abs(drive.body.speeds[0]) < 0.2 and drive.world.time > 3.0)
        if drive.body.stalled:
            break
    stalls = touched if drive.body.stalled else float("inf")
    drive.wait(5.0)
    stood, began = drive.body.robot_in_world.x, drive.world.time
    drive.body.drive.linear.go(-0.2)
    while drive.body.robot_in_world.x > stood - 0.01 and drive.world.time < began + 10.0:
        drive.world.step(TICK)
    return stalls, drive.world.time - began


def sill(model: str, physics: Physics, height: float, speed: float) -> bool:
    """Whether the robot gets over a door sill, 4 cm wide, of this height [m] at this speed."""
    step = Step(pose=Pose2(1.0, 0.0), size=(0.04, 2.0), height=height)
    drive = Drive.of(model, physics, WorldFile(name="sill", solids=(step,)))
    drive.body.drive.linear.go(speed)
    drive.wait(2.2 / speed + 2.0)
    return drive.body.robot_in_world.x > 1.6


def fall(model: str, physics: Physics) -> tuple[float, float]:
    """Return the largest tilt on the way over an edge of 0.3 m, and that in the end [degrees].

    180 is on its back.
    """
    step = Step(pose=ORIGIN, size=(2.0, 2.0), height=EDGE)
    drive = Drive.of(model, physics, WorldFile(name="edge", solids=(step,)))
    drive.body.drive.linear.go(0.3)
    tilts = [0.0]
    for _ in range(round(10.0 / TICK)):
        drive.world.step(TICK)
        tilts.append(drive.tilt)
    return max(tilts), tilts[-1]


def rows() -> Iterator[tuple[str, list[str]]]:
    """Yield each situation, and its figures: P3-AT and P3-DX with physics, then on the plane."""
    pairs: list[tuple[str, Physics]] = [
        (model, physics) for physics in get_args(Physics)[::-1] for model in ("p3at-sh", "p3dx-sh")
    ]
    for what, say in SITUATIONS.items():
        yield what, [say(model, physics) for model, physics in pairs]


def _error(physics: Physics) -> Realism | None:
    """Return the errors of odometry: on a plane the usual ones, as physics has its own."""
    return Realism() if physics == "planar" else None


def _straight(model: str, physics: Physics) -> str:
    aside, turned = straight(model, physics, _error(physics))
    return f"{aside:.1f} mm, {turned:.2f}°"


def _square(turn: int, model: str, physics: Physics) -> str:
    away, turned = square(model, physics, turn, _error(physics))
    return f"{away:.2f} m, {turned:.1f}°"


def _brake(model: str, physics: Physics) -> str:
    way, tilt = brake(model, physics)
    return f"{way:.2f} m, {tilt:.1f}°"


def _climb(model: str, physics: Physics) -> str:
    share, creep = climb(model, physics)
    return f"{share:.3f}; {creep:.2f} mm/s"


def _hit(model: str, physics: Physics) -> str:
    stalls, away = hit(model, physics)
    return f"{stalls:.2f} s; {away:.2f} s"


def _sill(height: float, model: str, physics: Physics) -> str:
    over = (sill(model, physics, height, speed) for speed in SPEEDS)
    return ", ".join("over" if each else "stuck" for each in over)


def _fall(model: str, physics: Physics) -> str:
    largest, last = fall(model, physics)
    return f"{largest:.0f}°, {last:.0f}°"


SPEEDS = 0.1, 0.15, 0.3
"""At which sills are tried [m/s]."""
SITUATIONS: dict[str, Callable[[str, Physics], str]] = {
    "10 m straight: aside, turned": _straight,
    "square of 4 m, counter-clockwise: end beside start, turned": partial(_square, 1),
    "square of 4 m, clockwise: end beside start, turned": partial(_square, -1),
    "braking from 0.7 m/s: way, tilt": _brake,
    "10° up at 0.2 m/s: way made of way asked; creep when held": _climb,
    "box of 5 kg, 6 s at 0.2 m/s: pushed by": lambda m, p: f"{push(m, p):.2f} m",
    "wall at 0.3 m/s: stall after; 1 cm away after": _hit,
    "sill of 1 cm at 0.1, 0.15, 0.3 m/s": partial(_sill, 0.01),
    "sill of 1.5 cm, likewise": partial(_sill, 0.015),
    "sill of 2 cm, likewise": partial(_sill, 0.02),
    "over an edge of 0.3 m at 0.3 m/s: largest tilt, tilt in the end": _fall,
}
