"""The solids of a world as geoms of MuJoCo, each named after its table and number."""

import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from math import cos, sin
from typing import Any

from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel, physics_of
from pioneer3.models.description.tree import wheel_joint_names
from pioneer3.sim.physics.colors import PARTS, THINGS
from pioneer3.sim.relief import Carpet, Relief, Solid
from pioneer3.sim.relief.mesh_file import Triangles
from pioneer3.sim.relief.shapes import Block, Hull, Shape, Terrain, UprightCylinder, Wedge
from pioneer3.text import one_line

SOLID = 1
"""Bit of contact with solids."""
FLOOR = 2
"""Bit of contact with the floor: robots that are neither seen nor touched still stand on it."""
GROUND_FRICTION = 0.6
"""Friction of the floor, steps and ramps; tires have their own."""
CARPET_PRIORITY = 2
"""Above that of boxes and tires: the friction of a carpet holds for all that touches it."""
BOX = "box"
"""Table of the solids whose sides are walls of the map, too."""
TERRAIN_BASE = 0.1
"""Thickness of a terrain below its lowest point [m], so that nothing falls through."""
MOST_HULL = 1.3
"""Volume of a mesh's hull, as a share of the mesh's: a larger one is no likeness of it."""
_NAMED = re.compile(r"'([a-z]+_\d+)(?:_\w+)?'")
"""An element in an error of MuJoCo, without the name of its part."""


def turned(theta: float) -> list[float]:
    """Return the quaternion w, x, y, z of a heading [rad]."""
    return [cos(theta / 2), 0.0, 0.0, sin(theta / 2)]


class Elements:
    """Adds the solids of a relief to a specification, and compiles it."""

    def __init__(self, spec: Any, relief: Relief) -> None:
        self._spec, self._relief = spec, relief
        self._meshes: dict[Triangles, str] = {}

    def add_solids(self) -> None:
        """Add a geom for each part of each solid; ConfigError, which names it, for a wrong file."""
        for name, solid in self._relief.solids.items():
            for part in solid.parts:
                self._add(f"{name}_{part.name}" if part.name else name, solid, part.shape)

    def pair_carpets(self, robots: Iterable[tuple[str, RobotModel]]) -> None:
        """Let tires keep their own softness on carpets, whose friction holds.

        By priority alone a carpet would have its own softness, and a P3-AT would hop on it.
        """
        carpets = [(n, s) for n, s in self._relief.solids.items() if isinstance(s, Carpet)]
        if not carpets:
            return
        for name, model in robots:
            contact = physics_of(model).contact
            for tire in tires_of(model, name):
                if self._spec.geom(tire) is None:
                    continue
                for carpet, solid in carpets:
                    slide = solid.friction
                    self._spec.add_pair(
                        geomname1=tire,
                        geomname2=carpet,
                        condim=3,
                        friction=[slide, slide, 0.005, 0.0001, 0.0001],
                        solref=[*contact.solref],
                        solimp=[*contact.solimp, *(0.5, 2.0)][:5],
                    )

    def compiled(self) -> Any:
        """Return the model; ConfigError, which names it, for an element that MuJoCo refuses."""
        try:
            return self._spec.compile()
        except ValueError as error:
            raise self._refused(error) from None

    def _add(self, name: str, solid: Solid, shape: Shape) -> None:
        at, ground = shape.pose, solid.is_ground
        geom: dict[str, object] = {
            "name": name,
            "contype": FLOOR if ground else SOLID,
            "conaffinity": 0 if ground else SOLID,
            "quat": turned(at.theta),
            "group": THINGS,
        }
        if ground:
            friction = solid.friction if isinstance(solid, Carpet) else GROUND_FRICTION
            geom["friction"] = [friction, 0.005, 0.0001]
        if solid.table == BOX and solid.z <= 0:
            geom["group"] = PARTS  # sensors meet the walls around it, which have its material
        if isinstance(solid, Carpet):
            geom["priority"] = CARPET_PRIORITY
        self._spec.worldbody.add_geom(**geom | self._shaped(name, shape))

    def _shaped(self, name: str, shape: Shape) -> dict[str, object]:
        """Return the type, size and place of a geom."""
        import mujoco

        x, y, kinds = shape.pose.x, shape.pose.y, mujoco.mjtGeom
        match shape:
            case Block(size=(length, width, height)):
                return {
                    "type": kinds.mjGEOM_BOX,
                    "size": [length / 2, width / 2, height / 2],
                    "pos": [x, y, shape.z + height / 2],
                }
            case UprightCylinder(radius=radius, height=height):
                return {
                    "type": kinds.mjGEOM_CYLINDER,
                    "size": [radius, height / 2, 0.0],
                    "pos": [x, y, shape.z + height / 2],
                }
            case Terrain():
                return {"type": kinds.mjGEOM_HFIELD} | self._terrain(name, shape)
            case Wedge():
                self._spec.add_mesh(name=name, uservert=shape.corners.ravel().tolist())
            case Hull():
                check_hull(name, shape, self._relief.source)
                if shape.triangles not in self._meshes:
                    self._meshes[shape.triangles] = name
                    add_mesh(self._spec, name, shape.triangles)
                name = self._meshes[shape.triangles]
        return {"type": kinds.mjGEOM_MESH, "meshname": name, "pos": [x, y, shape.z]}

    def _terrain(self, name: str, shape: Terrain) -> dict[str, object]:
        """Add the data of a terrain; MuJoCo spreads them from 0 to 1."""
        length, width, height = shape.size
        low, high = float(shape.heights.min()), float(shape.heights.max())
        rows, columns = shape.heights.shape
        self._spec.add_hfield(
            name=name,
            size=[length / 2, width / 2, (high - low) * height, TERRAIN_BASE],
            nrow=rows,
            ncol=columns,
            userdata=((shape.heights - low) / (high - low)).ravel().tolist(),
        )
        x, y = shape.pose.x, shape.pose.y
        return {"hfieldname": name, "pos": [x, y, shape.z + low * height]}

    def _refused(self, error: ValueError) -> ConfigError:
        found = _NAMED.search(str(error))
        name = f"{shown_name(found[1])}: " if found and found[1] in self._relief.solids else ""
        problem = f"MuJoCo refuses it: {_reason(error)}"
        return ConfigError(f"{_before(self._relief.source)}{name}{problem}")


def tires_of(model: RobotModel, robot: str) -> Sequence[str]:
    """Return the names of the geoms that a robot stands on, which need not all be there."""
    links = [joint.removesuffix("_joint") for joint in wheel_joint_names(model)]
    return [f"{robot}/{link}" for link in (*links, "caster")]


def shown_name(name: str) -> str:
    """Return the name of an element for people: the table and number of `ramp_2`."""
    table, _, number = name.rpartition("_")
    return f"{table} {number}"


def check_hull(name: str, hull: Hull, source: str) -> None:
    """Refuse, with a ConfigError, a mesh much smaller than its hull, or of no use to MuJoCo."""
    try:
        volume = _hull_volume(hull.triangles)
    except ValueError as error:
        problem = f"MuJoCo refuses it: {_reason(error)}"
    else:
        share = volume / abs(hull.triangles.volume)
        if share <= MOST_HULL:
            return
        problem = (
            f"its convex hull, which robots would meet, is {share:.1f} times as large as it; "
            "cut it into convex parts, each a file and a [[mesh]] of its own"
        )
    raise ConfigError(f"{_before(source)}{shown_name(name)}: {problem}")


@lru_cache(maxsize=64)
def _hull_volume(mesh: Triangles) -> float:
    """Return the volume of the convex hull [m3]; a world is often compiled, each mesh the same.

    Raises:
        ValueError: MuJoCo cannot use the mesh.
    """
    import mujoco

    spec = mujoco.MjSpec()
    add_mesh(spec, "mesh", mesh)
    body = spec.worldbody.add_body()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="mesh", density=1.0)
    return float(spec.compile().body_mass[1])


def add_mesh(spec: Any, name: str, mesh: Triangles) -> None:
    """Add a mesh that bodies meet as its convex hull, and rays and pictures as it is."""
    import mujoco

    spec.add_mesh(
        name=name,
        uservert=mesh.points.ravel().tolist(),
        userface=mesh.corners.ravel().tolist(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
    )


def _reason(error: ValueError) -> str:
    return one_line(str(error).partition("\n")[0].removeprefix("Error: "))


def _before(source: str) -> str:
    return f"{source}: " if source else "this world: "
