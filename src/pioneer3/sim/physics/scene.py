"""The parts of a world for MuJoCo: a floor, extruded walls, solids, robots, boxes and people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import atan2, hypot
from typing import Any

import numpy as np

from pioneer3.arrays import Bool, Int
from pioneer3.maps import LineMap
from pioneer3.maps.materials import GLASS, PLAIN, Codes, codes_of
from pioneer3.models import shape_of
from pioneer3.models.description.mjcf import SIDES, bumper_geoms, mjcf_of
from pioneer3.models.description.tree import wheel_joint_names
from pioneer3.sim.body import Body
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.physics.colors import BODIES, LEGS, PARTS, THINGS, WALLS, paint
from pioneer3.sim.physics.elements import FLOOR, GROUND_FRICTION, SOLID, Elements, tires_of, turned
from pioneer3.sim.relief import Relief
from pioneer3.sim.worldfile import Box, Person

WALL_THICKNESS = 0.01
"""[m]."""
PORTION = 2000
"""Walls are added so many at a time: the time of each grows with the number before it."""
SHARED_OPTIONS = ("timestep", "integrator", "cone", "impratio", "disableflags")
"""Options that all parts of a world share, else MuJoCo warns."""
LEG_HEIGHT = 0.85
"""[m]."""
BASE, WALL = "base", "wall"
TALL = 0.8
"""From this height on a wall is one for all sensors, as on the plane [m]."""
SMALL = 0.05
"""Parts of robots whose ball around them is smaller are not seen by sensors [m]."""
_mjcf = lru_cache(maxsize=16)(mjcf_of)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A compiled world, and where the numbers of its N robots and M obstacles are in it.

    Attributes:
        model: MuJoCo's `MjModel`.
        data: Its `MjData`.
        base: Where the pose of each robot begins in `qpos`, shape (N,).
        base_speed: Where the velocity of each robot begins in `qvel`, shape (N,).
        free: The places in `qvel` of all that moves along x, y and z, shape (F, 3).
        wheels: The wheels of each side in `qpos`, shape (2, N, W); a robot with fewer wheels than
            others has some of them twice.
        wheel_speeds: The same in `qvel`.
        motors: The actuators of each side, shape (2, N); also their places in `act`.
        hull: Of each geom the robot whose hull it is part of, -1 for all other geoms, shape (G,).
        robot: Of each geom the robot that it is part of, -1 for all others, shape (G,).
        boxes: Of each obstacle that is pushed, where its pose begins in `qpos`, else -1, (M,).
        people: Of each obstacle that walks by itself, its number among `mocap_pos`, else -1, (M,).
        legs: Of the same its left and its right leg there, else -1, shape (M, 2).
        bodies: The body of each robot without its wheels, shape (N,).
        groups: The group of each geom, also while its robot is hidden, shape (G,).
        moving: Whether each geom may move, shape (G,).
        codes: The material of each geom, shape (G,).
        bumpers: Of each geom the bits of the segments that it is, in front and behind, (G, 2).
        joints: By name of a part, its places in `qpos` and `qvel`.
    """

    model: Any
    data: Any
    base: Int
    base_speed: Int
    free: Int
    wheels: Int
    wheel_speeds: Int
    motors: Int
    hull: Int
    robot: Int
    boxes: Int
    people: Int
    legs: Int
    bodies: Int
    floor: int
    groups: Int
    moving: Bool
    codes: Codes
    bumpers: Int
    joints: Mapping[str, tuple[Int, Int]]

    @property
    def has_glass(self) -> bool:
        """Whether any geom is of glass."""
        return bool((self.codes == GLASS).any())


def build(
    line_map: LineMap,
    relief: Relief,
    robots: Sequence[tuple[str, Body]],
    obstacles: Sequence[tuple[str, Obstacle]],
    step: float,
) -> Scene:
    """Return a world of these parts, all at rest on the floor where they are now.

    Walls are the geoms `wall_0`, `wall_1`..., solids geoms of their names; robots and obstacles
    have unique names. `step` is that of the simulation [s].

    Raises:
        ConfigError: MuJoCo refuses a part, or the hull of a mesh is no likeness of it.
    """
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.timestep = step
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    _ground(spec, line_map, relief)
    elements = Elements(spec, relief)
    elements.add_solids()
    for name, body in robots:
        pose = body.robot_in_world
        frame = spec.worldbody.add_frame(pos=[pose.x, pose.y, 0.0], quat=turned(pose.theta))
        child = mujoco.MjSpec.from_string(_mjcf(body.model))
        child.option.timestep = step
        spec.attach(child, prefix=f"{name}/", frame=frame)
    for name, obstacle in obstacles:
        _add_obstacle(spec, name, obstacle)
    elements.pair_carpets([(name, body.model) for name, body in robots])
    paint(spec, dict(obstacles))
    model = elements.compiled()
    materials = _materials(line_map, relief, obstacles)
    return _indexed(model, mujoco.MjData(model), materials, robots, obstacles)


def _ground(spec: Any, line_map: LineMap, relief: Relief) -> None:
    """Add the floor, and a thin upright board along each segment of the map."""
    import mujoco

    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 1],
        friction=[GROUND_FRICTION, 0.005, 0.0001],
        contype=FLOOR,
        conaffinity=0,
        group=THINGS,
    )
    heights = relief.heights_of(line_map)
    for first in range(0, len(line_map.walls), PORTION):
        portion = mujoco.MjSpec()
        for name in SHARED_OPTIONS:
            setattr(portion.option, name, getattr(spec.option, name))
        walls = line_map.walls[first : first + PORTION].tolist()
        tall = heights[first : first + PORTION].tolist()
        for number, (wall, height) in enumerate(zip(walls, tall, strict=True), first):
            _add_wall(portion, str(number), wall, height)
        spec.attach(portion, prefix=f"{WALL}_", frame=spec.worldbody.add_frame())


def _add_wall(spec: Any, name: str, wall: list[float], height: float) -> None:
    import mujoco

    x0, y0, x1, y1 = wall
    length = hypot(x1 - x0, y1 - y0)
    if length > 0 and height > 0:
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[length / 2, WALL_THICKNESS / 2, height / 2],
            pos=[(x0 + x1) / 2, (y0 + y1) / 2, height / 2],
            quat=turned(atan2(y1 - y0, x1 - x0)),
            contype=SOLID,
            conaffinity=SOLID,
            group=WALLS if height >= TALL else THINGS,
        )


def _add_obstacle(spec: Any, name: str, obstacle: Obstacle) -> None:
    """Add a box that can be pushed, or a person whom nothing pushes."""
    import mujoco

    pose, kind = obstacle.pose, obstacle.kind
    if isinstance(kind, Person):
        body = spec.worldbody.add_body(name=name, mocap=True, pos=[pose.x, pose.y, 0.0])
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[kind.radius, obstacle.height / 2, 0.0],
            pos=[0.0, 0.0, obstacle.height / 2],
            contype=SOLID,
            conaffinity=SOLID,
            group=BODIES,
        )
        for side, leg in zip(SIDES, obstacle.legs, strict=True):
            body = spec.worldbody.add_body(
                name=f"{name}/{side}", mocap=True, pos=[leg.x, leg.y, 0.0]
            )
            body.add_geom(
                name=f"{name}/{side}",
                type=mujoco.mjtGeom.mjGEOM_CYLINDER,
                size=[obstacle.leg_sizes[0], LEG_HEIGHT / 2, 0.0],
                pos=[0.0, 0.0, LEG_HEIGHT / 2],
                contype=0,
                conaffinity=0,
                group=LEGS,
            )
        return
    length, width, height = kind.block.size
    body = spec.worldbody.add_body(
        name=name, pos=[pose.x, pose.y, kind.z + height / 2], quat=turned(pose.theta)
    )
    body.add_freejoint(name=f"{name}/{BASE}")
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[length / 2, width / 2, height / 2],
        mass=kind.mass,
        priority=1,
        friction=[kind.friction, 0.005, 0.0001],
        contype=SOLID,
        conaffinity=SOLID | FLOOR,
        group=THINGS,
    )


def _indexed(
    model: Any,
    data: Any,
    materials: Mapping[str, int],
    robots: Sequence[tuple[str, Body]],
    obstacles: Sequence[tuple[str, Obstacle]],
) -> Scene:
    most = max((len(shape_of(body.model).axles) for _, body in robots), default=1)
    wheels = np.zeros((2, len(robots), most), dtype=np.int64)
    speeds, motors = np.zeros_like(wheels), np.zeros((2, len(robots)), dtype=np.int64)
    hull, robot = np.full(model.ngeom, -1), np.full(model.ngeom, -1)
    numbers = {name: number for number, (name, _) in enumerate(robots)}
    tires = {tire for name, body in robots for tire in tires_of(body.model, name)}
    for number, (name, body) in enumerate(robots):
        names = wheel_joint_names(body.model)
        for side in range(2):
            own = names[side::2]
            for place in range(most):
                joint = model.joint(f"{name}/{own[place % len(own)]}")
                wheels[side, number, place] = joint.qposadr[0]
                speeds[side, number, place] = joint.dofadr[0]
            motors[side, number] = model.actuator(f"{name}/{SIDES[side]}").id
    for geom in range(model.ngeom):
        name = model.geom(geom).name
        prefix, slash, _ = name.partition("/")
        if slash and prefix in numbers:
            robot[geom] = numbers[prefix]
            if model.geom_contype[geom] and name not in tires:
                hull[geom] = numbers[prefix]
    boxes, people = np.full(len(obstacles), -1), np.full(len(obstacles), -1)
    legs = np.full((len(obstacles), 2), -1)
    for number, (name, obstacle) in enumerate(obstacles):
        if isinstance(obstacle.kind, Person):
            people[number] = model.body(name).mocapid[0]
            legs[number] = [model.body(f"{name}/{side}").mocapid[0] for side in SIDES]
        else:
            boxes[number] = model.joint(f"{name}/{BASE}").qposadr[0]
    bases = [model.joint(f"{name}/{BASE}") for name, _ in robots]
    set_contacts(model, robot >= 0, hidden=np.zeros(model.ngeom, dtype=np.bool_))
    large = (model.geom_group == PARTS) & (robot >= 0) & (model.geom_rbound >= SMALL)
    model.geom_group[large] = THINGS
    return Scene(
        model=model,
        data=data,
        base=np.array([joint.qposadr[0] for joint in bases], dtype=np.int64),
        base_speed=np.array([joint.dofadr[0] for joint in bases], dtype=np.int64),
        free=model.jnt_dofadr[model.jnt_type == 0][:, None] + np.arange(3),
        wheels=wheels,
        wheel_speeds=speeds,
        motors=motors,
        hull=hull,
        robot=robot,
        boxes=boxes,
        people=people,
        legs=legs,
        bodies=np.array([model.body(f"{name}/base_link").id for name, _ in robots], dtype=np.int64),
        floor=model.geom("floor").id,
        groups=model.geom_group.astype(np.int64),
        moving=model.geom_bodyid != 0,
        codes=_codes(model, materials),
        bumpers=_bumper_bits(model, robots),
        joints=_joints(model),
    )


def _materials(
    line_map: LineMap, relief: Relief, obstacles: Sequence[tuple[str, Obstacle]]
) -> dict[str, int]:
    """Return the codes of the materials of walls and boxes, by the names of their geoms."""
    boxes = {name: solid for name, solid in relief.solids.items() if isinstance(solid, Box)}
    boxes |= {name: each.kind for name, each in obstacles if isinstance(each.kind, Box)}
    codes = {f"{WALL}_{number}": int(code) for number, code in enumerate(line_map.materials)}
    return codes | {name: int(codes_of([box.material])[0]) for name, box in boxes.items()}


def _codes(model: Any, materials: Mapping[str, int]) -> Codes:
    """Return the material of each geom."""
    names = (model.geom(number).name for number in range(model.ngeom))
    return np.array([materials.get(name, PLAIN) for name in names], dtype=np.uint8)


def _bumper_bits(model: Any, robots: Sequence[tuple[str, Body]]) -> Int:
    """Return the bits of the bumper segments that each geom is, in front and behind, (G, 2)."""
    bits = np.zeros((model.ngeom, 2), dtype=np.int64)
    for name, body in robots:
        front, rear = body.model.front_bumpers, body.model.rear_bumpers
        geoms = (f"{name}/{geom}" for geom in bumper_geoms(body.model))
        segments = [(0, k) for k in range(front)] + [(1, k) for k in range(rear)]
        for geom, (end, segment) in zip(geoms, segments, strict=True):
            bits[model.geom(geom).id, end] = 2 << segment
    return bits


def set_contacts(model: Any, robots: Bool, hidden: Bool) -> None:
    """Let the geoms of `robots` touch the floor, and those not `hidden` all that is solid.

    `model` is changed, with what it knows of the contacts of bodies. Masks are (G,); geoms of
    robots that are only seen are left out.
    """
    touching = robots & (model.geom_conaffinity != 0)
    model.geom_contype[touching] = np.where(hidden, 0, SOLID)[touching]
    model.geom_conaffinity[touching] = np.where(hidden, FLOOR, SOLID | FLOOR)[touching]
    for own, of_body in (
        (model.geom_contype, model.body_contype),
        (model.geom_conaffinity, model.body_conaffinity),
    ):
        of_body[:] = 0
        np.bitwise_or.at(of_body, model.geom_bodyid, own)


def _joints(model: Any) -> dict[str, tuple[Int, Int]]:
    """Return, by the part of a name before the slash, its places in `qpos` and `qvel`."""
    found: dict[str, tuple[list[int], list[int]]] = {}
    for number in range(model.njnt):
        joint = model.joint(number)
        free = len(joint.qpos0) == 7
        places = found.setdefault(joint.name.partition("/")[0], ([], []))
        places[0].extend(range(joint.qposadr[0], joint.qposadr[0] + (7 if free else 1)))
        places[1].extend(range(joint.dofadr[0], joint.dofadr[0] + (6 if free else 1)))
    return {name: (np.array(q), np.array(v)) for name, (q, v) in found.items()}
