"""A running simulator: its robots, and the methods that change its world."""

import asyncio
import logging
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import hypot
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.arcos.reports import MapChanged
from pioneer3.errors import CommandError, DeviceError, PioneerError
from pioneer3.geometry import Pose2
from pioneer3.links.hosts import url_of
from pioneer3.models import RobotModel, load_model
from pioneer3.names import free_name
from pioneer3.sim.body import Body
from pioneer3.sim.collision import footprint_hits, hits, overlap, stands_in
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.placer import PlacementRequest, Placer
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.server.port import RobotPort
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, ClientMaps, Person, RobotSpec

if TYPE_CHECKING:
    from pioneer3.sim.server.camera import SimulatedCamera

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimulatedRobot:
    """One robot of a running simulation, with its range finder that has a port of its own.

    Its name is for people; to programs it is `MobileSim`, unless it has such a laser. Its URL is
    for hosts; `memory:NAME` where it does not listen.
    """

    name: str
    body: Body
    firmware: Firmware
    port: RobotPort
    url: str
    pty: str | None = None
    laser: SimulatedLaser | None = None
    camera: "SimulatedCamera | None" = None

    @classmethod
    def at(
        cls,
        port: RobotPort,
        name: str,
        pty: str | None = None,
        laser: SimulatedLaser | None = None,
        camera: "SimulatedCamera | None" = None,
    ) -> Self:
        """Return the robot behind `port`."""
        firmware, address = port.firmware, port.address
        return cls(
            name=name,
            body=firmware.body,
            firmware=firmware,
            port=port,
            url=url_of(*address) if address is not None else f"memory:{name}",
            pty=pty,
            laser=laser,
            camera=camera,
        )

    @property
    def model(self) -> RobotModel:
        """Its type."""
        return self.body.model


class RunningSimulation:
    """A simulator that listens; made by :func:`pioneer3.sim.server.start.simulator`.

    Robots are in the order of their ports; those of a factory, whose port gives every client a
    robot of its own, come and go. The first ones may have colour trackers (ACTS). `notes` are
    warnings for the person who started it, one per line, and `progress` one about work that has
    just begun. The pace of time may be changed at any time.
    """

    def __init__(
        self,
        simulation: Simulation,
        robots: Iterable[SimulatedRobot],
        rng: Generator,
        client_maps: ClientMaps,
    ) -> None:
        self.world: World = simulation.world
        self.robots = list(robots)
        self.pace: Pacer = simulation.pace
        self.factory_url: str | None = None
        self.acts_urls: list[str] = []
        self.notes: list[str] = []
        self.progress = ""
        self._simulation = simulation
        self._rng = rng
        self._client_maps = client_maps
        self._faults = LinkFaults()
        self._adding = asyncio.Lock()
        for robot in self.robots:
            robot.firmware.on_map_changed = self._tell_all

    @property
    def url(self) -> str:
        """The URL of the factory, or without one of the first robot."""
        return self.factory_url or self.robots[0].url

    @property
    def tcp_ports(self) -> list[int]:
        """The TCP port of each robot that has one."""
        addresses = (robot.port.address for robot in self.robots)
        return [address[1] for address in addresses if address is not None]

    @property
    def body(self) -> Body:
        """The first robot."""
        return self.robots[0].body

    @property
    def lasers(self) -> list[SimulatedLaser]:
        """The lasers of the robots that have one."""
        return [robot.laser for robot in self.robots if robot.laser is not None]

    def robot(self, name: str) -> SimulatedRobot:
        """Return the robot of this name.

        Raises:
            KeyError: There is none.
        """
        return {robot.name: robot for robot in self.robots}[name]

    def set_faults(self, faults: LinkFaults) -> None:
        """Give every robot's cable faults like `faults`, each with chances of its own.

        So has the cable of its laser. Robots that are added later get them too. One robot's are
        `robot.port.faults` and `robot.laser.faults`.
        """
        self._faults = faults
        for number, robot in enumerate(self.robots):
            robot.port.faults = _like(faults, number)
            if robot.laser is not None:
                robot.laser.faults = _like(faults, number)

    async def add_robot(self, spec: RobotSpec) -> SimulatedRobot:
        """Put one more robot into the world and let hosts connect to it.

        Raises:
            ConfigError: Its model or name is wrong, or there is no room for it.
            LinkError: Its port cannot be listened on.
        """
        model = spec.equipment.model_with(load_model(spec.model))
        equipment = spec.equipment.equipment_of(model)
        async with self._adding:
            name = free_name(spec.name or model.name, {each.name for each in self.robots}, "-")
            body = Body(model, self._place_for(PlacementRequest(name, model, spec.start)))
            self.world.add(body)
            firmware = Firmware(
                self.world,
                body,
                own_name=name,
                equipment=equipment,
                client_maps=self._client_maps,
            )
            try:
                laser, camera = await self._listen(firmware, spec.port, equipment)
            except PioneerError:
                self.world.remove(body)
                raise
            added = SimulatedRobot.at(self._simulation.ports[-1], name, laser=laser, camera=camera)
            added.port.faults = _like(self._faults, len(self.robots))
            if laser is not None:
                laser.faults = _like(self._faults, len(self.robots))
            firmware.on_map_changed = self._tell_all
            self.robots.append(added)
        return added

    async def remove_robot(self, robot: SimulatedRobot) -> None:
        """Disconnect a robot's host, close its port and take it out of the world.

        Raises:
            ValueError: It is not here.
        """
        self.robots.remove(robot)
        await self._simulation.remove(robot.firmware)
        if robot.laser is not None:
            self._simulation.lasers.remove(robot.laser)
        if robot.camera is not None and self._simulation.cameras is not None:
            self._simulation.cameras.remove(robot.camera)
        self.world.remove(robot.body)

    def add_box(self, box: Box) -> Obstacle:
        """Put a box into the world; it can always be moved.

        Raises:
            CommandError: A robot stands there, or with physics another box, which it would push
                away with all its might.
        """
        self._refuse_on_robots(box.outline, box.pose)
        if self.world.dynamics.has_slip:
            self._refuse_on_boxes(box)
        return self.world.add_obstacle(box)

    def add_person(self, person: Person) -> Obstacle:
        """Add a person who walks.

        Raises:
            CommandError: A robot stands where they begin.
        """
        self._refuse_on_robots(person.outline_at(0.0), person.pose_at(0.0))
        return self.world.add_obstacle(person)

    def watch(self) -> None:
        """Keep poses up to date between reports too: somebody looks at them."""
        self._simulation.watched = True

    def remove(self, obstacle: Obstacle) -> None:
        """Take a box or a person out of the world."""
        self.world.remove_obstacle(obstacle)

    def move(self, item: SimulatedRobot | Obstacle, pose: Pose2) -> None:
        """Put a robot, a box or a person elsewhere; a robot's odometry does not change.

        Raises:
            CommandError: A robot would stand in something there, or something on a robot.
        """
        if not isinstance(item, SimulatedRobot):
            self._refuse_on_robots(item.outline_at(pose), pose)
            self.world.move_obstacle(item, pose)
        elif self.has_room(item.model, pose, item):
            item.body.robot_in_world = pose
        else:
            raise CommandError(
                f"{item.name}: something stands at {pose.x:.2f} {pose.y:.2f}; choose another place"
            )

    def move_robots(self, places: Mapping[SimulatedRobot, Pose2]) -> list[SimulatedRobot]:
        """Put several robots elsewhere at once, so that one may take another's place.

        Return the robots that stay, because something stands at their new places.
        """
        moving = dict(places)
        while stay := [
            robot for robot, pose in moving.items() if not self.has_room(robot.model, pose, *moving)
        ]:
            for robot in stay:
                del moving[robot]
        for robot, pose in moving.items():
            robot.body.robot_in_world = pose
        return [robot for robot in places if robot not in moving]

    def has_room(self, model: RobotModel, pose: Pose2, *but: SimulatedRobot) -> bool:
        """Whether a robot fits at `pose`: on no wall and in no obstacle or robot except `but`."""
        bodies = [robot.body for robot in self.robots if robot not in but]
        return not (
            hits(model, pose, self.world.map.walls)
            or any(overlap(model, pose, body.model, body.robot_in_world) for body in bodies)
            or any(stands_in(model, pose, o.outline_at(o.pose)) for o in self.world.obstacles)
        )

    async def _listen(
        self, firmware: Firmware, port: int | None, equipment: Equipment
    ) -> "tuple[SimulatedLaser | None, SimulatedCamera | None]":
        """Let hosts connect to a new robot, its laser and its camera; return those two."""
        simulation = self._simulation
        await simulation.add(firmware, port)
        laser: SimulatedLaser | None = None
        try:
            if equipment.laser is not None:
                laser = await simulation.add_laser(firmware, equipment.laser, equipment.laser_port)
            return laser, await self._listen_camera(firmware, equipment)
        except PioneerError:
            if laser is not None:
                simulation.lasers.remove(laser)
            await simulation.remove(firmware)
            raise

    async def _listen_camera(
        self, firmware: Firmware, equipment: Equipment
    ) -> "SimulatedCamera | None":
        """Serve the pictures of a new robot's camera, if there can be any."""
        if equipment.camera is None or self._simulation.cameras is None:
            return None
        try:
            return await self._simulation.cameras.add(firmware, equipment)
        except DeviceError as error:
            log.warning("%s", error)
            return None

    def _refuse_on_robots(self, outline: NDArray[np.float64], pose: Pose2) -> None:
        for robot in self.robots:
            if stands_in(robot.model, robot.body.robot_in_world, outline):
                raise CommandError(
                    f"{robot.name} stands at {pose.x:.2f} {pose.y:.2f}; choose another place"
                )

    def _refuse_on_boxes(self, box: Box) -> None:
        for obstacle in self.world.obstacles:
            there = obstacle.kind
            if isinstance(there, Box) and _overlap(box, replace(there, pose=obstacle.pose)):
                raise CommandError(
                    f"a box stands at {box.pose.x:.2f} {box.pose.y:.2f}; choose another place"
                )

    def _place_for(self, request: PlacementRequest) -> Pose2:
        standing = self.world.robots
        obstacles = [obstacle.outline_at(obstacle.pose) for obstacle in self.world.obstacles]
        placer = Placer(self.world.map, self._rng, obstacles, expected=len(standing) + 1)
        for body in standing:
            placer.occupy(body.model, body.robot_in_world)
        return placer.place(request)

    def _tell_all(self, change: MapChanged) -> None:
        """Tell every host about another map."""
        for robot in self.robots:
            robot.firmware.tell(change)


def _like(faults: LinkFaults, number: int) -> LinkFaults:
    """Return the same faults, with the chances of robot `number`."""
    copy = LinkFaults.parse(str(faults))
    copy.seed = faults.seed + number
    return copy


def _overlap(one: Box, other: Box) -> bool:
    """Whether two boxes stand in each other."""
    apart = hypot(one.pose.x - other.pose.x, one.pose.y - other.pose.y)
    return apart < min(*one.size, *other.size) / 2 or any(
        footprint_hits(a.pose, a.size[0] / 2, a.size[0] / 2, a.size[1] / 2, b.outline)
        for a, b in ((one, other), (other, one))
    )
