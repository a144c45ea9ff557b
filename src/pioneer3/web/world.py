"""The simulated world as pages see it: its things by number."""

from functools import cached_property
from itertools import count
from typing import Any

from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model, model_names
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.sim.worldfile import Box

Item = SimulatedRobot | Obstacle
Placed = tuple[float, float, float]
"""x, y [m], theta [rad], to a millimetre."""


class WorldView:
    """Numbers what is in a simulation; a number is given once.

    Attributes:
        simulation: What is looked at.
        driven: The robots that the page drives, and the page's number of each.
    """

    def __init__(self, simulation: RunningSimulation) -> None:
        self.simulation = simulation
        self.driven: dict[SimulatedRobot, int] = {}
        self._numbers: dict[Item, int] = {}
        self._count = count(1)

    @cached_property
    def models(self) -> list[dict[str, str]]:
        """What robots can be added, as pages are told."""
        return [{"name": name, "title": load_model(name).title} for name in model_names()]

    @property
    def items(self) -> dict[Item, int]:
        """All that is there now, each with its number."""
        there: list[Item] = [*self.simulation.robots, *self.simulation.world.obstacles]
        known = self._numbers
        self._numbers = {item: known.get(item) or next(self._count) for item in there}
        return self._numbers

    def find(self, number: int) -> Item:
        """Return the item of this number.

        Raises:
            CommandError: It is gone, or never was.
        """
        for item, known in self.items.items():
            if known == number:
                return item
        raise CommandError("this is not there any more")

    def clock(self) -> dict[str, Any]:
        """Say how time passes; what time it is, only while it stands still [s]."""
        pace = self.simulation.pace
        return {
            "paused": pace.paused,
            "speed": pace.speed,
            "factor": round(pace.real_time_factor, 1),
            "time": round(self.simulation.world.time, 2) if pace.paused else None,
        }

    def describe(self, item: Item) -> dict[str, Any]:
        """Say what an item is and looks like, but not where it is.

        `own` is the page's number of a robot that it drives, `None` of all others.
        """
        if isinstance(item, Obstacle):
            front, rear, side, _ = item.sizes
            kind = "box" if isinstance(item.kind, Box) else "person"
            name = item.name
            more: dict[str, Any] = {"walks": item.walks}
        else:
            model, port = item.model, item.port
            front, rear, side = model.length_front, model.length_rear, model.width / 2
            kind, name = "robot", item.name
            more = {
                "model": model.name,
                "title": model.title,
                "url": item.url,
                "own": self.driven.get(item),
                "connected": port.connected,
                "stop_button": item.body.stop_button,
                "plugged": not port.faults.unplugged,
                "charge": round(item.body.battery.charge, 2),
            }
        return {"kind": kind, "name": name, "front": front, "rear": rear, "side": side, **more}

    def placed(self, item: Item) -> Placed:
        """Say where an item is."""
        pose: Pose2 = item.pose if isinstance(item, Obstacle) else item.body.robot_in_world
        return round(pose.x, 3), round(pose.y, 3), round(pose.theta, 3)
