"""The table of services, and their work. Requests come in other threads and wait for the loop."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import TimeoutError as NoAnswerError
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from pioneer3.arcos import commands
from pioneer3.errors import CommandError
from pioneer3.geometry import ORIGIN
from pioneer3.ros.messages.diagnostics import ENABLE, DiagnosticLevel, DiagnosticStatus
from pioneer3.ros.node.middleware import QUEUE, Middleware, Response, Sender
from pioneer3.ros.node.names import AS_STANDARD, Profile
from pioneer3.runtime.recording import AT_ORIGIN
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import hand_over

if TYPE_CHECKING:
    from pioneer3.ros.node.navigation import NodeNavigation

PATIENCE: Final = 2.0
"""Longest wait for the loop [s]."""
PLANNING: Final = 20.0
"""Longest wait for a way [s]."""
EMPTY: Final = "std_srvs/Empty"
TRIGGER: Final = "std_srvs/Trigger"
SET_BOOL: Final = "std_srvs/SetBool"


@dataclass(frozen=True, slots=True)
class NavigationResponse:
    """Response of nav_msgs: of GetMap with an OccupancyGrid, of GetPlan with a Path."""

    map: Any = None
    plan: Any = None


AnyResponse = Response | NavigationResponse


class Services:
    """The services of a connected robot.

    `sonar` tells whether the sonars are to ping at first; `moved` is called when odometry has been
    set, `warn` with a sentence when something is refused that has no response.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        sonar: bool,
        diagnose: Callable[[], Sequence[DiagnosticStatus]],
        moved: Callable[[], None],
        warn: Callable[[str], None],
        navigation: "NodeNavigation | None" = None,
    ) -> None:
        self._robot = robot
        self._navigation = navigation
        self._sonar = sonar
        self._diagnose = diagnose
        self._moved = moved
        self._warn = warn
        self._auto_enable = robot.supervisor.pilot.auto_enable
        self._loop = asyncio.get_running_loop()

    def advertise(self, profile: Profile, middleware: Middleware) -> None:
        """Offer the services of `profile`, in a thread."""
        for service in (*SERVICES, *(NAVIGATION_SERVICES if self._navigation else ())):
            for name in service.names(profile):
                if middleware.serves:
                    respond = partial(self._serve, service)
                    middleware.serve(name, service.type_in(profile), respond)
                elif service.topic_type is not None:
                    take = partial(self._take, service, name)
                    middleware.subscribe(name, service.topic_type, take, queue=QUEUE)
        if profile is Profile.P2OS:
            for order in P2OS_ORDERS:
                take = partial(self._take, order, order.name)
                middleware.subscribe(order.name, order.type_name, take, queue=QUEUE)

    def session_began(self) -> None:
        """Switch the sonars off where the parameters say so: every session begins with them on."""
        if not self._sonar:
            self.switch_sonar(on=False)

    def switch_motors(self, *, on: bool) -> Response:
        """Stop, then switch; motors that were switched off stay so until somebody asks again."""
        refused = self._robot.arbiter.set_motors(on=on)
        if refused is not None:
            return Response(False, refused.text)
        self._robot.supervisor.pilot.auto_enable = on and self._auto_enable
        return Response(True, f"the motors go {'on' if on else 'off'}")

    def switch_sonar(self, *, on: bool) -> Response:
        """Switch the sonars on or off."""
        self._sonar = on
        try:
            self._robot.send(commands.Sonar(on=on))
        except CommandError as error:
            return Response(False, str(error))
        return Response(True, f"the sonars go {'on' if on else 'off'}")

    def emergency_stop(self) -> Response:
        """Stop as hard as possible, motors off, latched."""
        self._robot.emergency_stop()
        return Response(True, "stopped; e_stop_reset releases it")

    def reset_emergency_stop(self) -> Response:
        """Release the latch; the motors stay off."""
        self._robot.reset_emergency_stop()
        snapshot = self._robot.snapshot
        if snapshot is not None and snapshot.motors.stop_button:
            return Response(False, "the stop button on the robot is pressed: pull it out")
        auto_enable = self._robot.supervisor.pilot.auto_enable
        until = "the next command" if auto_enable else f"{ENABLE} is called"
        return Response(True, f"released; the motors stay off until {until}")

    def reset_odometry(self) -> Response:
        """Stop, and call the present place 0, 0, 0; the robot itself does not know."""
        self._robot.stop()
        self._robot.supervisor.assembler.odometer.restart(ORIGIN)
        if self._robot.arbiter.log is not None:
            self._robot.arbiter.log.event(*AT_ORIGIN)
        self._moved()
        return Response(True, "this place is 0, 0, 0 now")

    def self_test(self) -> Response:
        """Return the faults of the robot in a sentence."""
        wrong = [each for each in self._diagnose() if each.level is not DiagnosticLevel.OK]
        broken = any(each.level is not DiagnosticLevel.WARN for each in wrong)
        return Response(not broken, "; ".join(str(each) for each in wrong) or "all is well")

    @property
    def navigation(self) -> "NodeNavigation":
        """The navigation of a node that has a map."""
        assert self._navigation is not None
        return self._navigation

    async def make_plan(self, request: Any) -> NavigationResponse:
        """Return the way that a request asks for."""
        return NavigationResponse(plan=await self.navigation.make_plan(request))

    def clear_costmaps(self) -> Response:
        """Forget what the robot has seen and the map does not show."""
        self.navigation.navigator.forget_obstacles()
        return Response(True, "all things that the map does not show are forgotten")

    def localize_globally(self) -> Response:
        """Have the whole map searched for the robot, as AMCL does."""
        self.navigation.navigator.lose()
        return Response(True, "looks for the robot on the whole map")

    def _take(self, service: "Service | Order", name: str, message: Any, _: Sender) -> None:
        """Act in the loop as a message on the topic of a service asks; in any thread."""

        def act() -> None:
            done = service.act(self, message)
            if isinstance(done, Response):
                outcome = "done" if done.success else "REFUSED"
                self._warn(f"{name}: {outcome}: {done.message}")

        hand_over(self._loop, act)

    def _serve(self, service: "Service", request: Any) -> AnyResponse:
        """Act in the loop; return the response. In a thread of the middleware."""
        if service is MAP:
            found = self.navigation.make_map()  # which takes long for large maps
            return NavigationResponse(map=found)

        given_up = False

        async def acting() -> AnyResponse:
            if given_up:
                raise asyncio.CancelledError
            done = service.act(self, request)
            return await done if isinstance(done, Awaitable) else done

        response: AnyResponse
        work = acting()
        try:
            call = asyncio.run_coroutine_threadsafe(work, self._loop)
        except RuntimeError:
            work.close()
            return self._not_served(service, "the node is ending")
        try:
            response = call.result(service.patience)
        except NoAnswerError:
            if not service.stops:
                given_up = True
                call.cancel()
            response = self._not_served(
                service, f"the node has not come to it within {service.patience:g} s"
            )
        except asyncio.CancelledError:
            response = self._not_served(service, "the node is ending")
        if isinstance(response, Response) and service.type_name == EMPTY and not response.success:
            self._warn(f"{service.standard} is refused: {response.message}")
        return response

    def _not_served(self, service: "Service", reason: str) -> AnyResponse:
        if service is PLAN:
            return NavigationResponse(plan=self.navigation.no_plan())
        return Response(False, reason)


@dataclass(frozen=True, slots=True)
class Order:
    """A topic of p2os whose messages do what a service does; `act` is given each one."""

    name: str
    type_name: str
    act: Callable[[Services, Any], Response]
    note: str = ""


P2OS_ORDERS: Final = (
    Order(
        "cmd_motor_state",
        "p2os_msgs/MotorState",
        lambda services, message: services.switch_motors(on=bool(message.state)),
        "1 brings the motors on, 0 stops the robot and takes them off, as `enable_motors` and"
        " `disable_motors` do",
    ),
)
"""Topics that the profile `p2os` listens to besides `cmd_vel`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """One row of the table.

    Attributes:
        compatibility: As of a :class:`~pioneer3.ros.node.topic.Topic`, and so are the other names.
        type_name: Type of the service in ROS 1; in ROS 2 a Trigger tells more than an Empty.
        act: Does the work in the loop, given the request.
        optional: Part of a robot that it takes, where robots may be without; empty for all others.
        patience: Longest wait for the response [s].
        stops: Whether it stops the robot: done even if that is too late for the response.
    """

    compatibility: str | None = None
    standard: str
    ros2: str | None = AS_STANDARD
    type_name: str
    act: Callable[[Services, Any], AnyResponse | Awaitable[AnyResponse]]
    optional: str = ""
    note: str = ""
    patience: float = PATIENCE
    stops: bool = False

    def names(self, profile: Profile) -> tuple[str, ...]:
        """Return its names in `profile`."""
        return profile.choose(self.compatibility, self.standard, self.ros2)

    def type_in(self, profile: Profile) -> str:
        """Return its type in `profile`."""
        return TRIGGER if profile is Profile.ROS2 and self.type_name == EMPTY else self.type_name

    @property
    def topic_type(self) -> str | None:
        """Type of the topic that stands in for it where no services are; `None` if none can."""
        return {EMPTY: "std_msgs/Empty", TRIGGER: "std_msgs/Empty", SET_BOOL: "std_msgs/Bool"}.get(
            self.type_name
        )


SERVICES: Final = (
    Service(
        compatibility=f"~{ENABLE}",
        standard=ENABLE,
        type_name=EMPTY,
        act=lambda services, _: services.switch_motors(on=True),
    ),
    Service(
        compatibility="~disable_motors",
        standard="disable_motors",
        type_name=EMPTY,
        act=lambda services, _: services.switch_motors(on=False),
        stops=True,
        note=f"the robot stops first; only `{ENABLE}` brings the motors back",
    ),
    Service(
        standard="e_stop_trigger",
        type_name=TRIGGER,
        act=lambda services, _: services.emergency_stop(),
        stops=True,
        note="latched",
    ),
    Service(
        standard="e_stop_reset",
        type_name=TRIGGER,
        act=lambda services, _: services.reset_emergency_stop(),
        note=f"the motors stay off until the next command; after `disable_motors` until `{ENABLE}`",
    ),
    Service(
        standard="reset_odometry",
        type_name=TRIGGER,
        act=lambda services, _: services.reset_odometry(),
        note="stops; this place is 0, 0, 0. The robot's own counters go on",
    ),
    Service(
        standard="sonar/enable",
        type_name=SET_BOOL,
        act=lambda services, request: services.switch_sonar(on=bool(request.data)),
        optional="sonars",
    ),
    Service(
        standard="self_test",
        type_name=TRIGGER,
        act=lambda services, _: services.self_test(),
        optional="a test of its own",
        note="the faults in `/diagnostics`, in a sentence",
    ),
)
MAP: Final = Service(
    compatibility="static_map",
    standard="static_map",
    ros2="map_server/map",
    type_name="nav_msgs/GetMap",
    act=lambda services, _: NavigationResponse(map=services.navigation.make_map()),
    optional="a map",
    note="as on `map`",
)
PLAN: Final = Service(
    compatibility="move_base/make_plan",
    standard="move_base/make_plan",
    ros2="make_plan",
    type_name="nav_msgs/GetPlan",
    act=lambda services, request: services.make_plan(request),
    optional="a map",
    note="nothing drives; a start without a frame is the robot's place, the tolerance counts as 0;"
    " empty without a way, and the log says why",
    patience=PLANNING,
)
NAVIGATION_SERVICES: Final = (
    MAP,
    PLAN,
    Service(
        compatibility="move_base/clear_costmaps",
        standard="move_base/clear_costmaps",
        ros2="clear_costmaps",
        type_name=EMPTY,
        act=lambda services, _: services.clear_costmaps(),
        optional="a map",
        note="forgets all things that the map does not show; the robot sees them again",
    ),
    Service(
        compatibility="global_localization",
        standard="global_localization",
        ros2="reinitialize_global_localization",
        type_name=EMPTY,
        act=lambda services, _: services.localize_globally(),
        optional="a map",
        note="searches the whole map for the robot, which must then be driven a metre",
    ),
)
"""Those of map_server, AMCL and move_base; of nodes that have a map."""
