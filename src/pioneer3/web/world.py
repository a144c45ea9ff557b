"""The simulated world as pages see it: its map, its things by number, and their changes."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING

from msgspec.structs import replace

from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, OccupancyGrid
from pioneer3.maps import MapObject as NamedPlace
from pioneer3.maps.image import to_png
from pioneer3.models import load_model, model_names
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.running import SimulatedRobot as RobotItem
from pioneer3.sim.worldfile import Box as BoxItem
from pioneer3.web.audience import Audience
from pioneer3.web.messages import (
    BoxThing,
    Drawing,
    DrawnChange,
    DrawnObject,
    Map,
    MapCells,
    Model,
    PersonThing,
    Placed,
    RobotThing,
    SimulatedTime,
    WorldChanges,
    encode,
)
from pioneer3.web.solids import heights_of_lines, solids_of

if TYPE_CHECKING:
    from pioneer3.nav.changes import MapChange

Item = RobotItem | Obstacle
MOST_GONE = 1000
"""So many removed things are remembered; a client that missed more is sent everything anew."""
MOST_CELLS = 4_000_000
"""Most cells of a grid: a phone keeps four bytes for each."""
MOST_CHANGED = 2000
"""Most cells of a change that are drawn."""
SLOW_UPDATES = 5
"""Limited audiences are sent every fifth update about the world."""
SHADE = 85
"""Between the greys of two states of cells: three of them make white."""


class WorldView:
    """Numbers the things of a simulation; a number is never used again.

    `driven` has the robots that the page drives, each with its number on the page, and `urls` has
    those of robots that hosts reach elsewhere than the simulation says.
    """

    def __init__(self, simulation: RunningSimulation) -> None:
        self.simulation = simulation
        simulation.watch()
        self.driven: dict[RobotItem, int] = {}
        self.urls: dict[RobotItem, str] = {}
        self._numbers: dict[Item, int] = {}
        self._count = count(1)
        self._updates = 0
        self._changes, self._slow_changes = WorldChannel(self), WorldChannel(self)

    def show_to(self, audiences: Iterable[Audience]) -> None:
        """Let audiences hear of changes from now on; limited ones less often."""
        for audience in audiences:
            audience.world = self._slow_changes if audience.is_limited else self._changes

    def tell(self, audiences: Iterable[Audience]) -> None:
        """Tell audiences what has changed since the last call."""
        self._updates += 1
        for channel, every in ((self._changes, 1), (self._slow_changes, SLOW_UPDATES)):
            readers = [each for each in audiences if each.world is channel and each.clients]
            if readers and not self._updates % every and channel.update():
                for audience in readers:
                    audience.wake()

    @cached_property
    def models(self) -> tuple[Model, ...]:
        """The types of robots that can be added."""
        return tuple(Model(name, load_model(name).title) for name in model_names())

    @property
    def items(self) -> dict[Item, int]:
        """All that is there now, each with its number."""
        there: list[Item] = [*self.simulation.robots, *self.simulation.world.obstacles]
        known = self._numbers
        self._numbers = {item: known.get(item) or next(self._count) for item in there}
        return self._numbers

    def find(self, number: int) -> Item:
        """Return the item of this number; CommandError if it is gone, or never was."""
        for item, known in self.items.items():
            if known == number:
                return item
        raise CommandError("this is not there any more")

    def clock(self) -> SimulatedTime:
        """Return how fast time runs, and while it stands still the time [s]."""
        pace = self.simulation.pace
        return SimulatedTime(
            paused=pace.paused,
            speed=pace.speed,
            factor=round(pace.real_time_factor, 1),
            time=round(self.simulation.world.time, 2) if pace.paused else None,
        )

    def describe(self, item: Item, number: int) -> BoxThing | PersonThing | RobotThing:
        """Return the message part for an item."""
        if isinstance(item, Obstacle):
            front, rear, side, _ = item.sizes
            kind = BoxThing if isinstance(item.kind, BoxItem) else PersonThing
            return kind(
                id=number,
                name=item.name,
                front=front,
                rear=rear,
                side=side,
                thing_in_map=_placed(item.pose),
                walks=item.walks,
                height=item.height,
            )
        model, port = item.model, item.port
        return RobotThing(
            id=number,
            name=item.name,
            front=model.length_front,
            rear=model.length_rear,
            side=model.width / 2,
            thing_in_map=_placed(item.body.robot_in_world),
            model=model.name,
            title=model.title,
            url=self.urls.get(item, item.url),
            own=self.driven.get(item),
            connected=port.connected,
            stop_button=item.body.stop_button,
            plugged=not port.faults.unplugged,
            charge=round(item.body.battery.charge, 2),
        )


def _placed(pose: Pose2) -> Placed:
    return round(pose.x, 3), round(pose.y, 3), round(pose.theta, 3)


@dataclass(slots=True)
class _Known:
    """A thing as last sent, with the versions of its description and of its place."""

    thing: BoxThing | PersonThing | RobotThing
    described: int
    moved: int


class WorldChannel:
    """The changes of a world, for clients that are more or less up to date."""

    def __init__(self, view: WorldView) -> None:
        self.version = 0
        self._view = view
        self._known: dict[int, _Known] = {}
        self._gone: dict[int, int] = {}
        self._complete_since = 0
        self._clock: SimulatedTime | None = None
        self._texts: dict[int, list[str]] = {}

    def update(self) -> bool:
        """Compare the world with the last update; return whether anything has changed."""
        clock, next_ = self._view.clock(), self.version + 1
        changed = clock != self._clock
        self._clock = clock
        there = self._view.items
        for item, number in there.items():
            changed |= self._note(self._view.describe(item, number), next_)
        for number in self._known.keys() - there.values():
            del self._known[number]
            self._gone[number] = next_
            changed = True
        if changed:
            self.version = next_
            self._texts.clear()
        while len(self._gone) > MOST_GONE:
            self._complete_since = self._gone.pop(next(iter(self._gone)))
        return changed

    def since(self, seen: int) -> list[str]:
        """Return the changes since version `seen`; nothing if that is the present one."""
        if seen == self.version:
            return []
        if seen not in self._texts:
            self._texts[seen] = [encode(self._message(seen))]
        return self._texts[seen]

    def _message(self, seen: int) -> WorldChanges:
        complete = seen == 0 or seen < self._complete_since
        known = self._known.values()
        moved = [k.thing for k in known if k.described <= seen < k.moved and not complete]
        return WorldChanges(
            all=complete,
            things=tuple(k.thing for k in known if complete or k.described > seen),
            moved=tuple((thing.id, *thing.thing_in_map) for thing in moved),
            gone=() if complete else tuple(n for n, at in self._gone.items() if at > seen),
            clock=self._clock,
        )

    def _note(self, thing: BoxThing | PersonThing | RobotThing, version: int) -> bool:
        known = self._known.get(thing.id)
        if known is None or replace(known.thing, thing_in_map=thing.thing_in_map) != thing:
            self._known[thing.id] = _Known(thing, version, version)
        elif known.thing.thing_in_map != thing.thing_in_map:
            known.thing, known.moved = thing, version
        else:
            return False
        return True


def map_message(
    line_map: LineMap | None, relief: Relief = FLAT, changes: "Sequence[MapChange]" = ()
) -> Map:
    """Return the message for a map; it leaves out walls that outline cells."""
    if line_map is None:
        return Map(None)
    lines = line_map.lines.round(3).tolist()
    return Map(
        Drawing(
            name=line_map.name,
            walls=tuple((x0, y0, x1, y1) for x0, y0, x1, y1 in lines),
            cells=tuple(map(_cells, line_map.grids)),
            objects=tuple(map(_object, line_map.objects)),
            wall_height=relief.wall_height,
            heights=heights_of_lines(line_map, relief),
            solids=solids_of(relief),
            changes=tuple(map(_change, changes)),
        )
    )


def _change(change: "MapChange") -> DrawnChange:
    thinned = change.cells[:: len(change.cells) // MOST_CHANGED + 1]
    cells = tuple((x, y) for x, y in thinned.round(3).tolist())
    return DrawnChange(str(change), change.gone, round(change.x, 3), round(change.y, 3), cells)


def _cells(grid: OccupancyGrid) -> MapCells:
    small = grid.coarser(MOST_CELLS)
    origin = small.origin
    png = b64encode(to_png(small.states * SHADE)).decode()
    return MapCells(png, small.resolution, (origin.x, origin.y, origin.theta))


def _object(item: NamedPlace) -> DrawnObject:
    return DrawnObject(
        role=item.role,
        kind=item.kind,
        name=item.name,
        x=round(item.pose.x, 3),
        y=round(item.pose.y, 3),
        theta=item.pose.theta,
        heads=item.heads,
        forbidden=item.forbidden,
        solid=item.solid,
        points=tuple((round(x, 3), round(y, 3)) for x, y in item.outline),
    )
