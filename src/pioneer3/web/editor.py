"""Changes of the simulated world that drivers make on the page, and permission to make them.

A client that moves a thing has a lease of it, until it leaves the thing alone for a moment. A robot
that the page drives is changed by the operator who has control of it, and the simulated time by a
client that can have control of all robots. Every driver may press a stop button.
"""

import asyncio
from collections.abc import Callable
from dataclasses import replace

from pioneer3.errors import CommandError, PioneerError, PortBusyError
from pioneer3.geometry import Pose2, wrap
from pioneer3.models import load_model, model_names
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.server.running import SimulatedRobot
from pioneer3.sim.worldfile import Box, Person, RobotSpec
from pioneer3.web import requests
from pioneer3.web.control import Lease
from pioneer3.web.messages import Added, EditRefused
from pioneer3.web.world import Item, WorldView

MOST_OBSTACLES = 200
"""Most obstacles of a world to which a page adds more."""
MOST_ROBOTS = 50
"""Most robots of a world to which a page adds more."""
STROLL = 0.8
"""Speed of people who are added [m/s]."""

Placing = requests.AddBox | requests.AddRobot | requests.MoveRequest


class Editor:
    """Carries out edits.

    `take_control` gives a client control of a robot by its number on the page, or of all robots
    without a number, if that is free; it returns whether the client has it. `stop` stops a driven
    robot; commands that are held must be let go before they count again.
    """

    def __init__(
        self,
        view: WorldView,
        take_control: Callable[[object, int | None], bool],
        stop: Callable[[int], None],
    ) -> None:
        self._view = view
        self._simulation = view.simulation
        self._take_control = take_control
        self._stop = stop
        self._leases: dict[int, Lease[object]] = {}
        self._clock = asyncio.get_running_loop().time

    async def apply(self, client: object, edit: requests.Edit) -> Added | EditRefused | None:
        """Make a change for `client`; return the answer, if there is one.

        The answer to an addition is its number; the answer to a refusal is the reason.
        """
        try:
            match edit:
                case requests.AddBox() | requests.AddPerson() | requests.AddRobot():
                    added = await self._add(edit)
                    return Added(self._view.items.get(added))
                case requests.PauseRequest() | requests.StepRequest() | requests.SetSpeed():
                    self._set_pace(client, edit)
                case _:
                    await self._change(client, edit)
        except PioneerError as error:
            return EditRefused(str(error))
        return None

    async def _add(self, edit: requests.AddBox | requests.AddPerson | requests.AddRobot) -> Item:
        simulation = self._simulation
        if isinstance(edit, requests.AddRobot):
            _refuse_more(len(simulation.robots), MOST_ROBOTS, "robots")
            return await self._add_robot(edit.model, _pose(edit))
        _refuse_more(len(simulation.world.obstacles), MOST_OBSTACLES, "boxes and people")
        if isinstance(edit, requests.AddBox):
            return simulation.add_box(Box(pose=_pose(edit), size=(edit.length, edit.width)))
        return simulation.add_person(Person(path=edit.path, speed=STROLL, loop=False))

    async def _add_robot(self, model: str, pose: Pose2) -> SimulatedRobot:
        if model not in model_names():  # a page reads no files
            raise CommandError(f"{model[:40]}: no such model; `pioneer3 model list` shows all")
        if not self._simulation.has_room(load_model(model), pose):
            raise CommandError(
                f"{model}: something stands at {pose.x:.2f} {pose.y:.2f}; choose another place"
            )
        # a page that goes must not leave half a robot
        return await asyncio.shield(self._new_robot(RobotSpec(model=model, start=pose)))

    async def _new_robot(self, spec: RobotSpec) -> SimulatedRobot:
        """Add a robot at the next port, or at any that is free."""
        try:
            return await self._simulation.add_robot(spec)
        except PortBusyError:
            return await self._simulation.add_robot(replace(spec, port=0))

    async def _change(
        self,
        client: object,
        edit: requests.MoveRequest
        | requests.Remove
        | requests.PressStopButton
        | requests.PlugCable
        | requests.SetCharge,
    ) -> None:
        item = self._view.find(edit.id)
        if not (isinstance(edit, requests.PressStopButton) and edit.pressed):
            self._take(client, edit.id, item)
        match edit, item:
            case requests.MoveRequest(), _:
                if (own := self._own(item)) is not None:
                    self._stop(own)  # a robot that is lifted stops
                self._simulation.move(item, _pose(edit))
            case requests.Remove(), SimulatedRobot():
                if self._own(item) is not None:
                    raise CommandError(f"{item.name}: this page drives it; it stays")
                await asyncio.shield(self._simulation.remove_robot(item))
            case requests.Remove(), Obstacle():
                self._simulation.remove(item)
            case requests.PressStopButton(_, pressed), SimulatedRobot():
                item.body.stop_button = pressed
            case requests.PlugCable(_, plugged), SimulatedRobot():
                item.port.faults.unplugged = not plugged
            case requests.SetCharge(_, charge), SimulatedRobot():
                item.body.battery.fill(charge)
            case _:
                raise CommandError("only robots have a stop button, a cable and a battery")

    def _set_pace(
        self, client: object, edit: requests.PauseRequest | requests.StepRequest | requests.SetSpeed
    ) -> None:
        if not self._take_control(client, None):
            raise CommandError("somebody else drives")
        pace = self._simulation.pace
        match edit:
            case requests.PauseRequest(paused):
                pace.paused = paused
            case requests.StepRequest(seconds):
                pace.step(seconds)
            case requests.SetSpeed(speed):
                pace.speed = speed

    def _own(self, item: Item) -> int | None:
        """Return the page's number of a robot that it drives, `None` of anything else."""
        return self._view.driven.get(item) if isinstance(item, SimulatedRobot) else None

    def _take(self, client: object, number: int, item: Item) -> None:
        """Take the lease of `item` for `client`; CommandError if another client has it."""
        if (own := self._own(item)) is not None:
            if not self._take_control(client, own):
                raise CommandError("somebody else drives")
            return
        now, held = self._clock(), self._leases
        self._leases = {n: lease for n, lease in held.items() if lease.holder(now) is not None}
        if not self._leases.setdefault(number, Lease()).take(client, now):
            raise CommandError("somebody else holds it")


def _pose(edit: Placing) -> Pose2:
    return Pose2(edit.x, edit.y, wrap(edit.theta))


def _refuse_more(there: int, most: int, what: str) -> None:
    if there >= most:
        raise CommandError(f"there are {there} {what} already; remove some first")
