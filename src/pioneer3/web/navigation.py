"""Takes a robot of the page to places of its map, along planned ways.

It translates: :mod:`pioneer3.navigation.goals` decides how a goal begins and ends. The navigator of
a map is made when it is first needed, which may take a while: nothing is imported or compiled on
the server's loop meanwhile, and the page is told the reason to wait.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterable, Sequence
from functools import cache, partial
from importlib.util import find_spec
from math import inf
from typing import TYPE_CHECKING, Any

from pioneer3.distribution import how_to_get
from pioneer3.errors import MotionError, PioneerError, Refusal
from pioneer3.geometry import Pose2
from pioneer3.nav.places import Destination, home
from pioneer3.navigation.connect import prepare_navigation
from pioneer3.navigation.goals import GONE, GoalServer, GoalStatus, NavigationGoal
from pioneer3.navigation.recording import points_of
from pioneer3.navigation.traffic import Traffic
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import next_tick, running
from pioneer3.web import messages, requests
from pioneer3.web.control import GOTO_TIME, SILENCE, Control, Operator
from pioneer3.web.scene import RobotScene

if TYPE_CHECKING:
    from pioneer3.nav.estimate import Estimate
    from pioneer3.nav.planner import NoWay, Way
    from pioneer3.navigation.navigator import Navigator
    from pioneer3.navigation.navigator import NavigatorState as State

log = logging.getLogger(__name__)

Place = requests.GotoPlace | requests.PlanWay | requests.Stopover
Question = requests.PlanWay | requests.PlaceRobot
Show = Callable[[Operator, messages.Message], None]
Publish = Callable[[messages.Navigation | None], None]

PERIOD = 0.5
"""Clients hear of the way and of the certainty so often [s]."""
CLICK = 0.3
"""Standard deviation of a place that somebody clicked [m]."""
TURN_SPREAD = 0.3
"""Standard deviation of a heading that somebody clicked [rad]."""
ANY_HEADING = 2.0
"""Standard deviation of a heading that nobody told [rad]."""
PATROL_TIME = 3600.0
"""Time limit of a patrol [s]."""
CRUISE = 0.7
"""Mean speed on a way, as a share of the highest."""


class RobotNavigation:
    """Plans ways for one robot of the page, and starts it on them.

    `goals` outlives the navigators, one for each map; their own goal servers do nothing here.
    `publish` is called with the state, and with `None` when there is none. The drivers of other
    robots are told the name. What takes long runs `in_thread`.
    """

    def __init__(
        self,
        number: int,
        robot: Robot,
        scene: RobotScene,
        control: Control,
        *,
        show: Show,
        publish: Publish,
        traffic: "Traffic | None" = None,
        name: str = "another robot",
    ) -> None:
        self._number, self._robot = number, robot
        self._scene, self._control = scene, control
        self._show, self._publish = show, publish
        self._traffic, self._called = traffic, name
        self.in_thread: Callable[..., Awaitable[Any]] = asyncio.to_thread
        self.goals = GoalServer(robot, self._ready, patience=inf)
        self._navigator: Navigator | None = None
        self._coming: asyncio.Future[Navigator] | None = None
        self._wanted = asyncio.Event()
        self._questions: dict[tuple[Operator, type], Question] = {}
        self._asked = asyncio.Event()
        self._waits = ""
        self._sender: Operator | None = None

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

    def ask(
        self, operator: Operator, request: requests.GotoPlace | requests.MapRequest | Question
    ) -> None:
        """Begin to carry out a request of a page, or to answer it.

        Of the questions of one operator the newest of each kind counts.
        """
        match request:
            case requests.GotoPlace(speed=speed):
                self.goals.accept(self._goal(operator, [request], speed, GOTO_TIME))
            case requests.Patrol(places=places, speed=speed):
                self.goals.accept(self._goal(operator, places, speed, PATROL_TIME))
            case requests.LookAround():
                self.goals.accept(self._goal(operator, (), None, GOTO_TIME))
            case _:
                self._questions[operator, type(request)] = request
                self._asked.set()

    def _goal(
        self, operator: Operator, places: Sequence[Place], speed: float | None, seconds: float
    ) -> NavigationGoal:
        """Return the goal of a page: places, or without one to look around."""
        self._sender = operator
        there = [self._destination(each) for each in places]
        return NavigationGoal(
            places=(lambda: there) if there else None,
            speed=speed,
            rounds=inf if len(there) > 1 else 1,
            by=operator.name,
            begin=partial(self._control.start, operator, seconds=seconds, patience=SILENCE),
            told=lambda goal: self._show(
                operator, messages.GoalProgress(self._number, goal.status.value, goal.text)
            ),
        )

    def release(self, operator: Operator) -> None:
        """End the goal of an operator who lets go of control, also one that waits for its way."""
        if self._sender is operator:
            self.goals.end(GoalStatus.ABORTED, f"{operator.name} let go")

    async def whereabouts(self) -> Pose2:
        """Return where the robot is on the map [m, rad]; PioneerError if that is not sure."""
        navigator = await self._ready()
        await navigator.find()
        pose = navigator.estimate.robot_in_map
        if (unsure := _unsure(navigator)) or pose is None:
            raise MotionError(unsure)
        return pose

    async def plan(self, place: Destination, speed: float) -> messages.PlannedWay:
        """Return the way to a place from where the robot is; PioneerError if there is none."""
        navigator = await self._ready()
        await navigator.find()  # planning gives the reason if it is not sure
        return self._shown(place, await navigator.plan(place), speed)

    async def drive(
        self, operator: Operator, place: Destination, speed: float
    ) -> messages.PlannedWay:
        """Have the robot set out for a script; return the way; MotionError if it does not."""
        self._sender = operator
        begin = partial(self._control.start, operator, seconds=GOTO_TIME, patience=inf)
        goal = NavigationGoal(places=lambda: (place,), speed=speed, begin=begin, by=operator.name)
        await self.goals.set_out(goal)
        assert goal.found is not None
        return self._shown(place, goal.found, speed)

    @property
    def state(self) -> messages.Navigation | None:
        """The robot's knowledge of its place, and the rest of its way; `None` at first."""
        if self._waits:
            return messages.Navigation(self._number, sure=False, reason="", problem=self._waits)
        latest = self._navigator.state.latest if self._navigator else None
        return self._message(latest) if latest else None

    async def run(self) -> None:
        """Carry out requests until cancelled."""
        work = [self.goals.run(), self._answer_questions()]
        if not self._scene.simulated:
            work.append(self._find_real_robot())
        async with running(*work):
            try:
                await self._keep_navigator()
            finally:
                if self._coming is not None:
                    self._coming.set_exception(MotionError(GONE))

    async def _find_real_robot(self) -> None:
        """Localize a robot that no simulator tells the place of, as soon as that is possible."""
        async for _ in self._robot.supervisor.snapshots.values(latest_first=True):
            if self.possible:
                break
        if not self._scene.tells_truth:
            try:
                await self._ready()
            except PioneerError as error:
                log.warning("the robot is not looked for: %s", error)

    async def _answer_questions(self) -> None:
        while True:
            await self._asked.wait()
            self._asked.clear()
            while self._questions:
                operator, kind = next(iter(self._questions))
                question = self._questions.pop((operator, kind))
                why = self.impossible
                refused = Refusal(why) if why else await self._answer(operator, question)
                if refused is not None:
                    self._show(operator, self._refused(question, refused.text))

    async def _answer(self, operator: Operator, question: Question) -> Refusal | None:
        """Answer a question of a page, or return a refusal."""
        try:
            if isinstance(question, requests.PlanWay):
                place = self._destination(question)
                self._show(operator, await self.plan(place, question.speed))
            else:
                turn = TURN_SPREAD if question.heading is not None else ANY_HEADING
                pose = Pose2(question.x, question.y, question.heading or 0.0)
                (await self._ready()).place(pose, CLICK, turn)
        except PioneerError as error:
            return Refusal(str(error))
        except Exception:
            log.exception("planning failed")
            return Refusal("planning a way failed; the log has the details")
        return None

    def _refused(self, question: Question, why: str) -> messages.Message:
        if isinstance(question, requests.PlanWay):
            return messages.PlannedWay(self._number, question.x, question.y, refusal=why)
        return messages.Told(f"{why[0].upper()}{why[1:]}.")

    def _destination(self, place: Place) -> Destination:
        """Return the place that a page means, by its name where the map has that."""
        known = self._scene.map_now
        names = {each.name for each in known.objects} if known else set()
        name = place.name if place.name in names else ""
        return Destination(x=place.x, y=place.y, heading=place.heading, name=name)

    def _shown(self, place: Destination, way: "Way | NoWay", speed: float) -> messages.PlannedWay:
        """Return the answer to a request that only asks for a way."""
        from pioneer3.nav.planner import NoWay
        from pioneer3.navigation.ways import to_drive

        why = way.why if isinstance(way, NoWay) else ""
        if isinstance(way, NoWay) and way.free is None:
            return messages.PlannedWay(self._number, place.x, place.y, refusal=why)
        driven = to_drive(way)
        return messages.PlannedWay(
            self._number,
            place.x,
            place.y,
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
            remark=estimate.remark,
            place=state.goal.name if state.goal else "",
            robot_in_map=Pose2(*_rounded((pose.x, pose.y, pose.theta))) if pose else None,
            ellipse=_rounded(estimate.ellipse) if estimate.ellipse else None,
            way=points_of(rest) if rest else (),
            left=round(rest.length, 1) if rest else None,
            seconds=_seconds(rest.length, state.top_speed) if rest else None,
        )

    async def _ready(self) -> "Navigator":
        """Return the navigator of the present map, once it is there; PioneerError for none."""
        if self._navigator is not None and self._navigator.line_map is self._scene.map_now:
            return self._navigator
        if self._coming is None:
            self._coming = asyncio.get_running_loop().create_future()
            self._wanted.set()
        return await asyncio.shield(self._coming)

    async def _keep_navigator(self) -> None:
        """Make the navigator that is wanted, and have it work until another one is.

        This is the only task that makes one. :meth:`_ready` asks for it by `_wanted`, and all who
        ask meanwhile await the same future `_coming`.
        """
        while True:
            await self._wanted.wait()
            self._wanted.clear()
            coming = self._coming
            assert coming is not None
            try:
                navigator = await self._make()
            except Exception as error:
                self._coming = None
                coming.set_exception(error)
                continue
            finally:
                self._waits = ""
                self._publish(None)
            self._navigator, self._coming = navigator, None
            coming.set_result(navigator)
            async with running(navigator.run(), self._tell_state(navigator)):
                await self._wanted.wait()

    async def _make(self) -> "Navigator":
        """Return a navigator of the present map."""
        known, before = self._scene.map_now, self._navigator
        if known is None:
            raise MotionError(self.impossible)
        self._navigator = None
        await prepare_navigation(self.in_thread, self._tell_wait)
        from pioneer3.navigation.navigator import Navigator

        start = self._known_start(before.estimate if before else None)
        navigator = await Navigator.on(
            self._robot,
            known,
            start=start,
            in_thread=self.in_thread,
            traffic=self._traffic,
            name=self._called,
        )
        if start is None and (now := self._robot.snapshot) is not None:
            begun = home(known)
            navigator.place_as_remembered(begun and begun @ now.odometry.robot_in_odom)
        self._scene.located.odom_in_map = lambda: navigator.estimate.odom_in_map
        if (shadow := self._robot.shadow) is not None:
            shadow.odom_in_map = lambda: navigator.sure_odom_in_map
        self._scene.located.unsure = lambda: _unsure(navigator)
        return navigator

    def _tell_wait(self, why: str) -> None:
        log.warning(why)
        self._waits = why
        self._publish(self.state)

    def _known_start(self, found: "Estimate | None") -> Pose2 | None:
        """Return where the robot is now, if a simulator tells that, or it was `found` before."""
        snapshot = self._robot.snapshot
        if snapshot is None:
            return None
        odom = snapshot.odometry.robot_in_odom
        if self._scene.tells_truth:
            return self._scene.robot_in_map(odom)
        if found is not None and found.sure and found.odom_in_map is not None:
            return found.odom_in_map @ odom
        return None

    async def _tell_state(self, navigator: "Navigator") -> None:
        """Publish the state of the navigator now and then."""
        try:
            while True:
                state = navigator.state.latest
                if state is not None:
                    self._publish(self._message(state))
                await next_tick(PERIOD)
        finally:
            self._publish(None)


def _unsure(navigator: "Navigator") -> str:
    estimate = navigator.estimate
    return "" if estimate.sure else f"it is not sure where it is on the map: {estimate.reason}"


def _rounded(values: Iterable[float]) -> tuple[float, float, float]:
    a, b, c = (round(value, 3) for value in values)
    return a, b, c


def _seconds(length: float, speed: float) -> int:
    """Return about how long a way [m] takes at a highest speed [m/s], in seconds."""
    return round(length / (CRUISE * speed))


@cache
def installed() -> bool:
    """Whether the extra `nav` is."""
    return all(find_spec(name) is not None for name in ("numba", "scipy"))
