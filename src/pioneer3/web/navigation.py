"""Takes a robot of the page to places of its map, along planned ways.

Planning takes a moment, in a thread. Meanwhile the page goes on: a stop that comes before the way
is found ends the request.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Awaitable, Callable, Iterable, Sequence
from contextlib import AsyncExitStack, suppress
from importlib import import_module
from importlib.util import find_spec
from math import dist, inf
from typing import TYPE_CHECKING, Any

from pioneer3.behaviors.action import Stack
from pioneer3.errors import MotionError, PioneerError, how_to_get
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running
from pioneer3.web import messages, requests
from pioneer3.web.control import GOTO_TIME, Control, Operator
from pioneer3.web.errand import Errand, PlaceOn
from pioneer3.web.scene import Scene

if TYPE_CHECKING:
    from pioneer3.nav.estimate import Estimate
    from pioneer3.nav.places import Destination
    from pioneer3.nav.planner import NoWay, Way
    from pioneer3.navigation.navigator import Navigation as State
    from pioneer3.navigation.navigator import Navigator
    from pioneer3.navigation.traffic import Traffic

log = logging.getLogger(__name__)

Asked = requests.GotoPlace | requests.MapRequest | requests.PlanWay
Show = Callable[[Operator, messages.Message], None]
Publish = Callable[[messages.Navigation | None], None]

PERIOD = 0.5
"""Clients hear of the way and of the certainty so often [s]."""
CLICK, TURN_SPREAD, ANY_HEADING = 0.3, 0.3, 2.0
"""Standard deviations of a place and a heading that somebody clicked, and of no heading
[m, rad, rad]."""
SPARSE = 5
"""Step between drawn points of a way."""
SAME = 0.005
"""A goal so near to a place of the map is that place [m]: pages know it in whole millimetres."""
PATROL_TIME = 3600.0
"""Time limit of a patrol [s]."""
LOOK = 1.0
"""Whether navigation has become possible is looked at so often [s]."""
CRUISE = 0.7
"""Mean speed on a way, as a share of the highest."""


class RobotNavigation:
    """Plans ways for one robot, and starts it on them.

    Args:
        number: Of the robot on the page.
        robot: The robot.
        scene: Its map, and where it is if a simulator tells.
        control: Decides who drives it.
        tell: Called with an operator and a sentence.
        show: Called with an operator and a message.
        publish: Called with the state, and with `None` when there is none.
        traffic: The other robots of the page.
        name: Of the robot, for the drivers of the others.

    Attributes:
        in_thread: Runs what takes long.
    """

    def __init__(
        self,
        number: int,
        robot: Robot,
        scene: Scene,
        control: Control,
        *,
        tell: Callable[[Operator, str], None],
        show: Show,
        publish: Publish,
        traffic: "Traffic | None" = None,
        name: str = "another robot",
    ) -> None:
        self._number, self._robot = number, robot
        self._scene, self._control = scene, control
        self._tell, self._show, self._publish = tell, show, publish
        self._traffic, self._called = traffic, name
        self.in_thread: Callable[..., Awaitable[Any]] = asyncio.to_thread
        self._navigator: Navigator | None = None
        self._asked: tuple[Operator, Asked, int] | None = None
        self._errands: deque[Errand] = deque()
        self._news = asyncio.Event()

    @property
    def possible(self) -> bool:
        """Whether ways can be planned: there is a map, a laser or sonars, and the extra `nav`."""
        return not self.impossible

    @property
    def impossible(self) -> str:
        """The reason that no ways can be planned, or nothing."""
        known = self._scene.map_now
        if known is None or not len(known.walls):
            return "there is no map"
        info = self._robot.supervisor.info
        if not self._robot.laser.presence.there and not (info and info.model.sonars):
            return "the robot has neither a laser nor sonars"
        return "" if installed() else f"navigation is not installed: {how_to_get('nav')}"

    @property
    def forbids(self) -> str:
        """The reason that nothing drives to places of the map, or nothing.

        Without a map a robot drives straight; on one it would drive at the walls.
        """
        known = self._scene.map_now
        drawn = known is not None and (len(known.walls) or any(o.forbidden for o in known.objects))
        return self.impossible if drawn else ""

    def ask(self, operator: Operator, request: Asked) -> None:
        """Plan a way for `operator`, and drive along it or only show it; or find the robot.

        The newest request counts, but one that only asks does not displace another.
        """
        waiting = self._asked is not None and not isinstance(self._asked[1], requests.PlanWay)
        if isinstance(request, requests.PlanWay) and (waiting or not self.possible):
            return
        self._asked = operator, request, self._robot.arbiter.last_stop.number
        self._news.set()

    async def answer(
        self, operator: Operator, place: PlaceOn, speed: float, *, drives: bool
    ) -> messages.Way:
        """Plan a way for a script, and have the robot drive along it if it `drives`; return it.

        Raises:
            PioneerError: There is no way, or the robot may not drive; see the message.
        """
        answer: asyncio.Future[messages.Way] = asyncio.get_running_loop().create_future()
        after = self._robot.arbiter.last_stop.number
        self._errands.append(Errand(operator, place, speed, drives, after, answer))
        self._news.set()
        return await answer

    @property
    def state(self) -> messages.Navigation | None:
        """The robot's knowledge of its place, and the rest of its way; `None` at first."""
        latest = self._navigator.state.latest if self._navigator else None
        return self._message(latest) if latest else None

    async def run(self) -> None:
        """Carry out requests until cancelled."""
        async with AsyncExitStack() as ended, AsyncExitStack() as stack:
            ended.callback(self._refuse_errands)
            await self._find_real_robot(stack)
            while True:
                await self._news.wait()
                self._news.clear()
                while self._errands:
                    await self._run_errand(self._errands.popleft(), stack)
                asked, self._asked = self._asked, None
                if asked is None:
                    continue
                try:
                    await self._carry_out(*asked, stack)
                except PioneerError as error:
                    self._tell(asked[0], _sentence(str(error)))
                except Exception:
                    log.exception("planning failed")
                    self._tell(asked[0], "Planning a way failed; the log has the details.")

    async def _find_real_robot(self, stack: AsyncExitStack) -> None:
        """Localize a robot that no simulator tells the place of, as soon as that is possible."""
        if self._scene.simulated:
            return
        while not self._news.is_set():
            ready = self._robot.snapshot is not None and self.possible
            if ready and not self._scene.tells_truth:
                try:
                    await self._ready(stack)
                except PioneerError as error:
                    log.warning("the robot is not looked for: %s", error)
                return
            if ready:
                return
            with suppress(TimeoutError):
                await asyncio.wait_for(self._news.wait(), LOOK)

    async def _carry_out(
        self, operator: Operator, request: Asked, after: int, stack: AsyncExitStack
    ) -> None:
        navigator = await self._ready(stack)
        if not isinstance(request, requests.PlaceRobot):
            await navigator.find()  # planning says why not
        match request:
            case requests.PlanWay():
                goal = self._destination(request)
                way = await navigator.plan(goal)
                self._show(operator, self._shown(goal, way, request.speed))
            case requests.PlaceRobot(x=x, y=y, heading=heading):
                turn = TURN_SPREAD if heading is not None else ANY_HEADING
                navigator.place(Pose2(x, y, heading or 0.0), CLICK, turn)
            case requests.LookAround():
                self._start(operator, navigator.looking_around(), GOTO_TIME, after)
            case requests.GotoPlace(speed=speed):
                await self._drive(operator, navigator, [self._destination(request)], speed, after)
            case requests.Patrol(places=places, speed=speed):
                goals = [self._destination(each) for each in places]
                await self._drive(operator, navigator, goals, speed, after)

    def _refuse_errands(self) -> None:
        while self._errands:
            self._errands.popleft().refuse(MotionError("the robot has gone"))

    async def _run_errand(self, errand: Errand, stack: AsyncExitStack) -> None:
        """Answer a script, unless it has gone."""
        error: PioneerError = MotionError("the robot has gone")
        try:
            way = await self._way_of(errand, stack)
        except PioneerError as found:
            error = found
        except Exception:
            log.exception("planning failed")
            error = MotionError("planning a way failed; the log has the details")
        else:
            if not errand.answer.done():
                errand.answer.set_result(way)
        finally:
            errand.refuse(error)

    async def _way_of(self, errand: Errand, stack: AsyncExitStack) -> messages.Way:
        from pioneer3.navigation.ways import to_drive

        navigator = await self._ready(stack)
        goal = errand.place(navigator.line_map)
        await navigator.find()  # planning says why not
        found = await navigator.plan(goal)
        way = to_drive(found)
        if errand.drives and not errand.answer.done():
            last = self._robot.arbiter.last_stop
            if last.number != errand.after:
                raise MotionError(last.why)
            mode = navigator.mode(goal, way, errand.speed)
            refused = self._control.start(errand.operator, mode, GOTO_TIME, patience=inf)
            if refused:
                raise MotionError(refused.text)
        return self._shown(goal, found, errand.speed)

    async def _drive(
        self,
        operator: Operator,
        navigator: "Navigator",
        goals: "Sequence[Destination]",
        speed: float,
        after: int,
    ) -> None:
        """Drive to one place, or from place to place, unless the robot was stopped meanwhile."""
        from pioneer3.nav.planner import NoWay
        from pioneer3.navigation.ways import to_drive

        first, *rest = goals
        found = await navigator.plan(first)
        way = to_drive(found)
        if isinstance(found, NoWay):
            self._tell(operator, _sentence(f"{found.why}; it waits before it"))
        if rest:
            mode = navigator.mode(first, way, speed, after=rest, rounds=inf)
            self._start(operator, mode, PATROL_TIME, after)
        else:
            self._start(operator, navigator.mode(first, way, speed), GOTO_TIME, after)

    def _start(self, operator: Operator, mode: Stack, seconds: float, after: int) -> None:
        """Start a mode unless the robot was stopped since it was asked for."""
        stop = self._robot.arbiter.last_stop
        if stop.number != after:
            self._tell(operator, _sentence(f"it does not set out: {stop.why}"))
        elif refused := self._control.start(operator, mode, seconds):
            self._tell(operator, refused.text)

    def _destination(
        self, place: requests.GotoPlace | requests.PlanWay | requests.Stopover
    ) -> "Destination":
        from pioneer3.nav.places import Destination

        return Destination(x=place.x, y=place.y, heading=place.heading, name=self._name(place))

    def _name(self, request: requests.GotoPlace | requests.PlanWay | requests.Stopover) -> str:
        """Return the name of the place that is meant, or nothing."""
        known = self._scene.map_now
        named = known.objects if known else ()
        there = request.x, request.y
        near = (i.name for i in named if dist(there, (i.pose.x, i.pose.y)) < SAME)
        return next(near, "")

    def _shown(self, goal: "Destination", way: "Way | NoWay", speed: float) -> messages.Way:
        """Return the answer to a request that only asks for a way."""
        from pioneer3.nav.planner import NoWay
        from pioneer3.navigation.ways import to_drive

        why = way.why if isinstance(way, NoWay) else ""
        if isinstance(way, NoWay) and way.free is None:
            return messages.Way(self._number, goal.x, goal.y, refusal=why)
        driven = to_drive(way)
        return messages.Way(
            self._number,
            goal.x,
            goal.y,
            points=points_of(driven),
            length=round(driven.length, 2),
            seconds=_seconds(driven.length, min(speed, self._robot.info.limits.max_speed)),
            closed=why,
        )

    def _message(self, state: "State") -> messages.Navigation:
        """Return the message for the state of the navigator."""
        estimate, way = state.estimate, state.way
        pose = estimate.robot_in_map
        rest = None
        if way is not None and pose is not None:
            rest = way.rest_from(pose.x, pose.y)
        return messages.Navigation(
            self._number,
            sure=estimate.sure,
            reason=estimate.reason,
            agreement=round(estimate.agreement, 2),
            problem=state.problem,
            place=state.goal.name if state.goal else "",
            robot_in_map=Pose2(*_rounded((pose.x, pose.y, pose.theta))) if pose else None,
            ellipse=_rounded(estimate.ellipse) if estimate.ellipse else None,
            way=points_of(rest) if rest else (),
            left=round(rest.length, 1) if rest else None,
            seconds=_seconds(rest.length, state.top_speed) if rest else None,
        )

    async def _ready(self, stack: AsyncExitStack) -> "Navigator":
        """Return the navigator of the present map."""
        await self.in_thread(import_module, "pioneer3.navigation.navigator")  # takes up to seconds
        from pioneer3.navigation.navigator import Navigator, compile_kernels

        known = self._scene.map_now
        assert known is not None
        if self._navigator is None or self._navigator.line_map is not known:
            found = self._navigator.estimate if self._navigator else None
            await stack.aclose()
            await compile_kernels()
            start = self._begun(known, found)
            self._navigator = await Navigator.on(
                self._robot,
                known,
                start=start,
                in_thread=self.in_thread,
                traffic=self._traffic,
                name=self._called,
            )
            navigator = self._navigator
            self._scene.located.odom_in_map = lambda: navigator.estimate.odom_in_map
            self._scene.located.unsure = lambda: _unsure(navigator)
            await stack.enter_async_context(running(navigator.run(), self._tell_state()))
        return self._navigator

    def _begun(self, known: LineMap, found: "Estimate | None") -> Pose2 | None:
        """Return where the robot is now, or `None` to have it found.

        A simulator tells that, or it was `found` on the map before, or it began at the map's home.
        """
        from pioneer3.nav.places import home

        snapshot = self._robot.snapshot
        if snapshot is None:
            return None
        odom = snapshot.odometry.robot_in_odom
        if self._scene.tells_truth:
            return self._scene.robot_in_map(odom)
        if found is not None and found.sure and found.odom_in_map is not None:
            return found.odom_in_map @ odom
        begun = home(known)
        return begun @ odom if begun else None

    async def _tell_state(self) -> None:
        """Publish the state of the navigator now and then."""
        navigator = self._navigator
        assert navigator is not None
        try:
            while True:
                state = navigator.state.latest
                if state is not None:
                    self._publish(self._message(state))
                await asyncio.sleep(PERIOD)
        finally:
            self._publish(None)


def _unsure(navigator: "Navigator") -> str:
    estimate = navigator.estimate
    return "" if estimate.sure else f"it is not sure where it is on the map: {estimate.reason}"


def _rounded(values: Iterable[float]) -> tuple[float, float, float]:
    a, b, c = (round(value, 3) for value in values)
    return a, b, c


def points_of(way: "Way") -> tuple[tuple[float, float], ...]:
    """Return some of the points of a way [m], the last one among them."""
    points = [*way.points[:-1:SPARSE].tolist(), way.points[-1].tolist()]
    return tuple((round(x, 2), round(y, 2)) for x, y in points)


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:].removesuffix('.')}."


def _seconds(length: float, speed: float) -> int:
    """Return about how long a way [m] takes at a highest speed [m/s], in seconds."""
    return round(length / (CRUISE * speed))


def installed() -> bool:
    """Whether the extra `nav` is."""
    return all(find_spec(name) is not None for name in ("numba", "scipy"))
