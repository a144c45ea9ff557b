"""Moves robots by the torque of their motors, and boxes by what pushes them."""

import logging
import os
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache, partial
from math import ceil
from typing import Any

import numpy as np

from pioneer3.arrays import Bool, Float
from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, empty_map
from pioneer3.models.description.mjcf import CAMERA
from pioneer3.sim.body import Body, Speeds
from pioneer3.sim.kernels import DriveArrays, Grid, Kernels, RobotArrays
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.physics.colors import TOUCHING
from pioneer3.sim.physics.elements import turned
from pioneer3.sim.physics.ground import Ground, feet_of, feet_of_box, has_ground
from pioneer3.sim.physics.motors import MotorArrays
from pioneer3.sim.physics.scene import Scene, build, set_contacts
from pioneer3.sim.physics.sensing import MujocoSensing
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.sensing import Sensing
from pioneer3.sim.sensors import GRAVITY, ImuReading
from pioneer3.sim.worldfile import Person
from pioneer3.sim.worldfile.spec import PHYSICS_STEP

log = logging.getLogger(__name__)

CYCLE = 0.02
"""The wheel-speed loop gets another speed so often [s]; one call of MuJoCo for each."""
WORTH_A_THREAD = 40
"""Worlds with so many degrees of freedom take longer than the way to another thread and back: four
robots, or seven boxes."""
FASTEST = 50.0
"""Nothing moves faster unless there is no solution: a fall of 100 m ends at 44 m/s [m/s]."""
NO_SOLUTION = (
    "the physics of this world have no solution, so that nothing moves: boxes or robots overlap; "
    "take one away or move it"
)
ALMOST = 1e-6
GL = "MUJOCO_GL"
"""Variable that tells MuJoCo at its import which OpenGL to load."""


def _mujoco() -> Any:
    """Return MuJoCo, without OpenGL: a value of MUJOCO_GL that does not fit lets its import fail.

    Raises:
        ConfigError: It is not installed.
    """
    given = os.environ.get(GL)
    os.environ[GL] = "disabled"
    try:
        import mujoco
    except ImportError:
        raise ConfigError(f"physics need MuJoCo: {how_to_get('physics')}") from None
    finally:
        del os.environ[GL]
        if given is not None:
            os.environ[GL] = given
    mujoco.set_mju_user_warning(_warn)  # else it writes a file where people work
    return mujoco


@lru_cache(maxsize=64)
def _warn(text: str) -> None:
    """Log a warning of MuJoCo, which may come with each step, only once."""
    log.warning("MuJoCo: %s", text)


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """A scene at one instant, for pictures by the camera of that name.

    `qpos` (Q,) and `people` (P, 3) are copies of MuJoCo's `qpos` and `mocap_pos`, and `hidden` the
    names of the other robots that are not to be seen.
    """

    scene: Scene
    camera: str
    qpos: Float
    people: Float
    hidden: tuple[str, ...]


class MujocoDynamics:
    """`Dynamics` of bodies with mass: wheels slip, robots push and tip, motors stall.

    The ramps of the firmware are those of the plane. The speeds at their ends go to a loop a side
    that turns the wheels with the motors' torque. Odometry counts the wheels.

    Raises:
        ConfigError: MuJoCo is not installed.
    """

    has_slip = True
    is_still = False

    def __init__(self, step: float = PHYSICS_STEP) -> None:
        self._mujoco: Any = _mujoco()
        self._step = step
        self._map, self._relief = empty_map(), FLAT
        self._names: dict[Body | Obstacle, str] = {}
        self._named = 0
        self._robots: Sequence[Body] = ()
        self._obstacles: Sequence[Obstacle] = ()
        self._drives, self._outlines = DriveArrays.at_rest(0), RobotArrays(*np.zeros((3, 0)))
        self._scene: Scene | None = None
        self._ground: Ground | None = None
        self._owed = self._cycle_time = 0.0
        self._thread: ThreadPoolExecutor | None = None
        self._work: Future[None] | None = None
        self._motors = MotorArrays()
        self._good, self._is_stuck = np.zeros(0), False
        self._velocity = self._gained = np.zeros((3, 0))
        self._known, self._hidden = np.zeros((3, 0)), np.zeros(0)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy all but the module: where a copy is made it is imported as here, before the rest."""
        state = {name: value for name, value in vars(self).items() if name != "_mujoco"}
        return MujocoDynamics, (self._step,), state

    @property
    def scene(self) -> Scene:
        """The compiled world; replaced when robots, obstacles or walls come and go."""
        assert self._scene is not None
        return self._scene

    def new_sensing(self, sonar: SonarErrors) -> Sensing:
        return MujocoSensing(partial(getattr, self, "scene"), sonar)  # which can be copied

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        before = self._map, self._relief
        self._map, self._relief = line_map, relief
        if self._scene is None:
            return
        try:
            self._rebuild()
        except ConfigError:
            self._map, self._relief = before
            raise
        if has_ground(relief) or has_ground(before[1]):
            for number, pose in enumerate(self._known.T.tolist()):
                self._put(number, Pose2(*pose))

    def change_bodies(
        self,
        robots: Sequence[Body],
        obstacles: Sequence[Obstacle],
        drives: DriveArrays,
        outlines: RobotArrays,
    ) -> None:
        self._robots, self._obstacles = robots, obstacles
        self._drives, self._outlines = drives, outlines
        self._motors.change(robots, drives)
        self._names = {
            item: self._names.get(item) or self._new_name(kind)
            for kind, items in (("robot", robots), ("obstacle", obstacles))
            for item in items
        }
        self._rebuild()

    def _new_name(self, kind: str) -> str:
        self._named += 1
        return f"{kind}{self._named - 1}"

    def place(self) -> None:
        poses = self._outlines.poses
        moved = np.flatnonzero((poses != self._known).any(axis=0))
        for number in moved.tolist():
            self._put(number, Pose2(*poses[:, number].tolist()))
        walking = len(self._robots) + np.flatnonzero(self.scene.people >= 0)
        if np.setdiff1d(moved, walking).size:
            self._mujoco.mj_forward(self.scene.model, self.scene.data)  # finds the contacts there
        if (self._outlines.hidden != self._hidden).any():
            self._hide()
        self._known = poses.copy()

    def step(self, kernels: Kernels, dt: float, noise: Float | None) -> None:
        pieces = max(1, ceil(dt / CYCLE - 1e-9))
        for _ in range(pieces):
            steps = self._begin_cycle(kernels, dt / pieces)
            if steps:
                self._mujoco.mj_step(self.scene.model, self.scene.data, steps)
            self._end_cycle(kernels)
        self._see(kernels)

    def start(self, kernels: Kernels, dt: float) -> Future[None] | None:
        if self.scene.model.nv < WORTH_A_THREAD or dt > CYCLE + ALMOST:
            return None
        scene, steps = self.scene, self._begin_cycle(kernels, dt)
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, "physics")
        self._work = self._thread.submit(self._mujoco.mj_step, scene.model, scene.data, steps)
        return self._work

    def finish(self, kernels: Kernels) -> None:
        self._work = None
        self._end_cycle(kernels)
        self._see(kernels)

    def speeds(self, number: int) -> Speeds:
        return self._motors.speeds(number)

    def imu(self, number: int) -> ImuReading:
        scene = self.scene
        turned = scene.data.xmat[scene.bodies[number]].reshape(3, 3)
        first = scene.base_speed[number]
        rates = scene.data.qvel[first + 3 : first + 6].tolist()
        gained = self._gained[:, number] + (0.0, 0.0, GRAVITY)
        return ImuReading(tuple(rates), tuple((gained @ turned).tolist()))

    def _velocities(self) -> Float:
        """Return the velocity of each robot's origin in the world [m/s], shape (3, N)."""
        scene = self.scene
        velocity: Float = scene.data.qvel[scene.base_speed + np.arange(3)[:, None]]
        return velocity

    def instant(self, body: Body) -> Instant:
        """Return the present state of the world for the camera of a robot."""
        if self._work is not None:
            self._work.result()  # positions do not change while they are copied
        hidden = np.flatnonzero(self._outlines.hidden[: len(self._robots)])
        others = [self._robots[number] for number in hidden.tolist()]
        return Instant(
            scene=self.scene,
            camera=f"{self._names[body]}/{CAMERA}",
            qpos=self.scene.data.qpos.copy(),
            people=self.scene.data.mocap_pos.copy(),
            hidden=tuple(self._names[other] for other in others if other is not body),
        )

    def _begin_cycle(self, kernels: Kernels, dt: float) -> int:
        """Tell the motors how fast to turn; return the steps that MuJoCo is to make."""
        self._motors.begin(self.scene, kernels, dt)
        self._cycle_time = dt
        self._owed += dt / self.scene.model.opt.timestep
        steps = int(self._owed + ALMOST)
        self._owed -= steps
        return steps

    def _end_cycle(self, kernels: Kernels) -> None:
        """Let the motors count their ways, and accelerometers feel the change of velocity."""
        self._keep_finite()
        self._motors.end(self.scene, kernels, self._cycle_time)
        velocity = self._velocities()
        self._gained, self._velocity = (velocity - self._velocity) / self._cycle_time, velocity

    def _keep_finite(self) -> None:
        """Take back a step that has no solution: nothing moves then, and hosts are still served."""
        data = self.scene.data
        fastest = abs(data.qvel[self.scene.free]).max(initial=0.0)
        if np.isfinite(data.qpos).all() and fastest < FASTEST:
            self._good, self._is_stuck = data.qpos.copy(), False
            return
        data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = self._good, 0.0, 0.0
        data.act[:] = 0.0
        if not self._is_stuck:
            log.error("%s", NO_SOLUTION)
            self._is_stuck = True

    def _see(self, kernels: Kernels) -> None:
        """Tell the outlines and the boxes where they are, but not those that were put elsewhere."""
        put = (self._outlines.poses != self._known).any(axis=0)
        self._known = self._poses()
        self._outlines.poses[:, ~put] = self._known[:, ~put]
        self._see_boxes(put)
        self._see_contacts()
        kernels.place(self._outlines)

    def _see_boxes(self, put: Bool) -> None:
        boxes = (self.scene.boxes >= 0) & ~put[len(self._robots) :]
        for number in np.flatnonzero(boxes).tolist():
            x, y, theta = self._known[:, len(self._robots) + number].tolist()
            self._obstacles[number].pose = Pose2(x, y, theta)

    def _poses(self) -> Float:
        """Return where everything is; of people, who do not move here, as the outlines have it."""
        scene, poses, first = self.scene, self._outlines.poses.copy(), len(self._robots)
        boxes = np.flatnonzero(scene.boxes >= 0)
        at = np.concatenate([scene.base, scene.boxes[boxes]])
        x, y, _, qw, qx, qy, qz = scene.data.qpos[at[:, None] + np.arange(7)].T
        theta = np.arctan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
        poses[:, np.concatenate([np.arange(first), first + boxes])] = x, y, theta
        return poses

    def _see_contacts(self) -> None:
        """Note which robots' hulls touch something that is not the floor."""
        scene, flags = self.scene, self._drives.flags
        flags[TOUCHED] = 0
        contact = scene.data.contact
        pairs = contact.geom[contact.exclude == 0]  # the others are only near
        if len(pairs):
            touching = scene.hull[pairs]
            touching[(pairs == scene.floor).any(axis=1)] = -1
            flags[TOUCHED, touching[touching >= 0]] = 1

    def _put(self, number: int, pose: Pose2) -> None:
        """Put a robot, a box or a person elsewhere, at rest."""
        data, scene = self.scene.data, self.scene
        if number < len(self._robots):
            robot = self._robots[number]
            places, speeds = scene.joints[self._names[robot]]
            z, turn = 0.0, turned(pose.theta)
            if self._ground is not None:
                z, turn = self._ground.standing(pose, feet_of(robot.model))
            data.qpos[places] = 0.0  # the caster's, too: the same place always begins the same
            data.qpos[places[:7]] = pose.x, pose.y, z, *turn
            data.qvel[speeds] = data.qacc_warmstart[speeds] = 0.0
            self._velocity[:, number] = 0.0
            self._motors.rest(scene, number)
            return
        own = number - len(self._robots)
        if scene.people[own] >= 0:
            data.mocap_pos[scene.people[own], :2] = pose.x, pose.y
            return
        at, box = int(scene.boxes[own]), self._obstacles[own].kind
        data.qpos[at : at + 2] = pose.x, pose.y
        if self._ground is None or isinstance(box, Person):
            data.qpos[at + 3 : at + 7] = turned(pose.theta)
        else:
            z, turn = self._ground.standing(pose, feet_of_box(box))
            _, qx, qy, _ = data.qpos[at + 3 : at + 7] = turn
            data.qpos[at + 2] = z + box.block.size[2] / 2 / (1 - 2 * (qx * qx + qy * qy))
        data.qvel[scene.joints[self._names[self._obstacles[own]]][1]] = 0.0

    def _put_new(self, before: Scene | None) -> None:
        """Put robots and boxes that were not there before onto the ground."""
        old = before.joints if before is not None else {}
        items: list[Body | Obstacle] = [*self._robots, *self._obstacles]
        for number, item in enumerate(items):
            raised = isinstance(item, Obstacle) and (
                isinstance(item.kind, Person) or item.kind.z > 0
            )
            if self._names[item] not in old and not raised:
                self._put(number, Pose2(*self._known[:, number].tolist()))

    def _hide(self) -> None:
        """Let robots that are neither seen nor touched stand on the floor alone."""
        model, robot = self.scene.model, self.scene.robot
        self._hidden = self._outlines.hidden.copy()
        hidden = (robot >= 0) & (self._hidden[robot] != 0)
        set_contacts(model, robot >= 0, hidden)
        model.geom_group[:] = np.where(hidden, TOUCHING, self.scene.groups)

    def _rebuild(self) -> None:
        """Compile the world anew; everything that stays keeps its state."""
        before = self._scene
        robots = [(self._names[body], body) for body in self._robots]
        obstacles = [(self._names[each], each) for each in self._obstacles]
        self._scene = scene = build(self._map, self._relief, robots, obstacles, self._step)
        self._ground = Ground(scene.model, scene.data) if has_ground(self._relief) else None
        self._hidden = np.zeros(len(self._outlines))
        self._velocity = self._gained = np.zeros((3, len(robots)))
        if before is not None:
            self._keep(before, scene)
        self._known = self._poses()  # the outlines may have others, which are still to be taken
        if self._ground is not None:
            self._put_new(before)
        self._mujoco.mj_forward(scene.model, scene.data)
        self._motors.look(scene)
        self._good = scene.data.qpos.copy()
        self._velocity = self._velocities()
        if self._outlines.hidden.any():
            self._hide()

    def _keep(self, old: Scene, new: Scene) -> None:
        """Take over the state of everything that was there before."""
        new.data.time = old.data.time
        for name, (places, speeds) in new.joints.items():
            if name in old.joints:
                was_places, was_speeds = old.joints[name]
                new.data.qpos[places] = old.data.qpos[was_places]
                new.data.qvel[speeds] = old.data.qvel[was_speeds]
                new.data.qacc_warmstart[speeds] = old.data.qacc_warmstart[was_speeds]
        for number in range(new.model.nu):
            name = new.model.actuator(number).name
            if name.partition("/")[0] in old.joints:
                new.data.act[number] = old.data.act[old.model.actuator(name).id]
