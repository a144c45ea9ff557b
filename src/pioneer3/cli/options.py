"""Options that several commands share: one name, one help, one default, one way to read each.

Numbers are read in SI. Without a unit they are in metres, degrees and seconds.
"""

import os
from collections.abc import AsyncIterator, Callable, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, nullcontext
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Group, Parameter, Token
from cyclopts.validators import Number

from pioneer3.cli.process import busy_sign, write_error
from pioneer3.errors import ConfigError, MotionError
from pioneer3.units import ANGLE, DURATION, LENGTH, SPEED, TURN_RATE, Quantity

if TYPE_CHECKING:
    from pioneer3.fleet.spec import Fleet
    from pioneer3.geometry import Pose2
    from pioneer3.models import GivenModel
    from pioneer3.nav.settings import NavigationSettings
    from pioneer3.robot.lasers.spec import LaserSpec
    from pioneer3.ros.node.start import StartOptions
    from pioneer3.runtime.recording import Record
    from pioneer3.runtime.robot import Robot
    from pioneer3.sim.worldfile import RobotSpec
    from pioneer3.sim.worldfile.arguments import WorldOverrides
    from pioneer3.web.hosting import ConnectTarget

DEFAULT_PORT = "tcp://localhost:8101"
UNITS = (
    "Numbers are in m, deg, s, m/s and deg/s, or carry a unit: 50cm, 1.57rad, 2min,\n"
    "30cm/s, 0.8rad/s."
)
"""Under each help that has such numbers."""

Flag = Annotated[bool, Parameter(negative=(), show_default=False)]
"""Off unless given, without a `--no-` twin."""
Json = Annotated[Flag, Parameter(help="Print JSON for programs, nothing else.")]
PORT_VARIABLE = "PIONEER3_PORT"
PORT = Parameter(name=["--port", "-p"], env_var=PORT_VARIABLE, metavar="PORT")
MODEL_VARIABLE = "PIONEER3_MODEL"
Model = Annotated[
    str | None, Parameter(name="--model", metavar="NAME|FILE", env_var=MODEL_VARIABLE)
]
LogName = Annotated[str, Parameter(metavar="LOG", show_default=False)]
"""A file, or the newest log with such a part in its name; the newest of all if empty."""
RobotName = Annotated[str | None, Parameter(name="--robot", metavar="NAME")]
Baud = Annotated[
    int | None,
    Parameter(name=["--baud", "-b"], env_var="PIONEER3_BAUD", help="Serial speed to try first."),
]
FleetFile = Annotated[
    Path | None,
    Parameter(
        name="--fleet",
        metavar="FILE",
        env_var="PIONEER3_FLEET",
        help="The fleet file; else fleet.toml here or in ~/.config/pioneer3.",
    ),
]
TcpPort = Annotated[int, Parameter(validator=Number(gte=0, lte=65535))]
Robots = Annotated[
    tuple[str, ...], Parameter(name=["--robot", "-r"], negative=(), show_default=False)
]
USUAL = "p3at-sh"
"""Model of a simulated robot of which only the number is given."""
MOST_ROBOTS = 1000
"""Most robots that one option asks for."""
RobotNumber = Annotated[
    int | None, Parameter(name=["--number", "-n"], validator=Number(gte=1, lte=MOST_ROBOTS))
]


def repeated(robots: tuple[str, ...], number: int | None) -> tuple[str, ...]:
    """Return the words of `--robot`, or the usual one, `number` times over."""
    return robots if number is None else (robots or (USUAL,)) * number


def fleet_of(given: Path | None) -> "Fleet":
    """Return the fleet in the file of `--fleet`, else in the usual places; ConfigError for none."""
    from pioneer3.fleet.inventory import find_fleet, read_fleet

    return read_fleet(find_fleet(given, environment=os.environ, here=Path(), home=Path.home()))


def fleet_if_any(given: Path | None) -> "Fleet | None":
    """Return the fleet as :func:`fleet_of` does; `None` if there is no file yet."""
    from pioneer3.fleet.inventory import find_fleet, read_fleet

    try:
        path = find_fleet(given, environment=os.environ, here=Path(), home=Path.home())
    except ConfigError:
        return None
    return read_fleet(path)


def robots_of(words: Sequence[str], given: Path | None) -> "tuple[ConnectTarget, ...]":
    """Return the robots of a fleet that the words of `--robot` name; empty if they are models.

    With `--fleet` they all are robots. Without it a fleet file need not be there.

    Raises:
        ConfigError: There is no such robot, or the file is wrong.
    """
    from pioneer3.fleet.inventory import VARIABLE, read_fleet
    from pioneer3.fleet.reach import camera_of, given_model, named, port_of
    from pioneer3.web.hosting import ConnectTarget

    if not words:
        return ()
    if given is not None and str(given) != os.environ.get(VARIABLE):
        fleet = read_fleet(given)
        robots = fleet.select(words)
    elif (found := fleet_if_any(None)) is None:
        return ()
    else:
        fleet, robots = found, named(words, found)
    return tuple(
        ConnectTarget(
            url=port_of(fleet, robot.name),
            name=robot.name,
            camera=camera_of(robot),
            model=given_model(fleet, robot),
            settings=robot.navigation,
        )
        for robot in robots
    )


def reads(
    quantity: Quantity, *, positive: bool = False, check: Callable[[float], float] = float
) -> Parameter:
    """Return how a number of this `quantity` is read and shown.

    It must be more than zero if it is to be `positive`; `check` returns the value [SI], or raises
    ValueError with the reason.
    """

    def convert(_: object, tokens: Sequence[Token]) -> float:
        text = tokens[0].value
        value = check(quantity.read(text))
        if positive and value <= 0:
            raise ValueError(f"{text}: it must be positive")
        return value

    def default(value: Any) -> Any:  # None shows nothing, though cyclopts says str
        return None if value in {None, "None"} else quantity.written(float(value))

    return Parameter(
        converter=convert,
        metavar=quantity.bare.upper(),
        show_default=default,
        allow_leading_hyphen=True,
    )


def shown_default(value: object) -> str | None:
    """Return how a help shows a default; nothing for one that is nothing."""
    if value in (None, "None", "", ()) or value is False:
        return None
    return " ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _patient(seconds: float) -> float:
    from pioneer3.teleop.keyboard import patient

    return patient(seconds)


Length = Annotated[float, reads(LENGTH)]
Angle = Annotated[float, reads(ANGLE)]
Distance = Annotated[float, reads(LENGTH, positive=True)]
Speed = Annotated[float, reads(SPEED, positive=True)]
MaxSpeed = Annotated[Speed, Parameter(help="Keep below this in any case.")]
TurnRate = Annotated[float, reads(TURN_RATE, positive=True)]
Seconds = Annotated[float, reads(DURATION, positive=True)]
Patience = Annotated[float, reads(DURATION, check=_patient)]


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class LogOptions:
    """The log of what the robot does.

    Attributes:
        record: New file for the log, in place of the next one among the user's; the port
            replay:FILE plays it.
        no_record: Write no log.
        csv: New folder for a table of each topic of the log (CSV), made when it ends.
    """

    record: Path | None = None
    no_record: Flag = False
    csv: Annotated[Path | None, Parameter(metavar="FOLDER")] = None

    def where(self, *, watches: bool = False) -> "Record":
        """Return where a robot is recorded; one that is only watched is not, unless asked for.

        Raises:
            ConfigError: Both options are given.
        """
        for name, path in (("record", self.record), ("csv", self.csv)):
            if self.no_record and path is not None:
                raise ConfigError(f"--{name} {path} and --no-record: give one of them")
        if self.csv is not None:
            from pioneer3.runtime.recording import WithTables

            return WithTables(self.csv, self.record or True, write_error)
        return False if self.no_record else self.record or (False if watches else None)


AS_SET = LogOptions()


LASERS = Group.create_ordered("Laser range finders")
SEVERAL = Parameter(negative=(), show_default=False)


@Parameter(name="*", group=LASERS)
@dataclass(frozen=True, slots=True, kw_only=True)
class LaserOptions:
    """The laser range finders at this computer.

    Attributes:
        laser: [MODEL@]PORT, such as /dev/ttyACM0, tcp://192.168.0.10:10940, lms-200@/dev/ttyUSB1;
            auto looks for one; once for each.
        laser_pose: x,y,heading[,upside-down] on the robot, such as 160mm,0,0; else as its model
            says; in the order of the lasers.
        laser_mask: Sectors to leave out, such as -135:-120,120:135; in the order of the lasers.
    """

    laser: Annotated[
        tuple[str, ...], Parameter(env_var="PIONEER3_LASER", metavar="PORT"), SEVERAL
    ] = ()
    laser_pose: Annotated[
        tuple[str, ...], Parameter(metavar="POSE", allow_leading_hyphen=True), SEVERAL
    ] = ()
    laser_mask: Annotated[
        tuple[str, ...], Parameter(metavar="SECTORS", allow_leading_hyphen=True), SEVERAL
    ] = ()

    async def specs(
        self, taken: Sequence[str] = (), otherwise: Sequence[str] = ()
    ) -> "tuple[LaserSpec, ...]":
        """Return the lasers, after looking for those that are `auto`.

        Ports that are `taken` are the robots'; those in `otherwise` are used if the options have
        none.

        Raises:
            ConfigError: An option is wrong.
            LinkError: There is no laser to be found.
        """
        found = list(self.laser or otherwise)
        if not (found or self.laser_pose or self.laser_mask):
            return ()
        from pioneer3.robot.lasers.spec import parse_lasers, refuse_robots

        if AUTO in found:
            from pioneer3.doctor.lasers import find_laser

            found[found.index(AUTO)] = await find_laser((*taken, *found))
        specs = parse_lasers(found, self.laser_pose, self.laser_mask)
        refuse_robots(specs, taken)
        return specs


NO_LASERS = LaserOptions()
AUTO = "auto"
CAMERA = Group.create_ordered("Camera")
CAMERA_VARIABLE = "PIONEER3_CAMERA"
CameraUrl = Annotated[
    str | None, Parameter(env_var=CAMERA_VARIABLE, metavar="URL", group=CAMERA, show_default=False)
]
"""URL of the MJPEG stream of a camera on the robot."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOptions:
    """Which robot.

    Attributes:
        port: The robot: /dev/ttyUSB0, localhost:8101, replay:FILE.
        robot: The robot by its name in the fleet file, in place of its port.
        model: What it really is, such as p3dx-sh, or a .toml or ARIA .p file; else what it says.
    """

    port: Annotated[str | None, PORT] = None
    robot: RobotName = None
    fleet: FleetFile = None
    model: Model = None

    @property
    def url(self) -> str:
        """The robot's port, as :attr:`url_or_none`, or that of a simulator."""
        return self.url_or_none or DEFAULT_PORT

    @property
    def url_or_none(self) -> str | None:
        """The robot's port; `None` if neither option is given.

        Raises:
            ConfigError: It is given twice, or the fleet file does not tell it.
        """
        if self.robot is None:
            return self.port
        from pioneer3.fleet.reach import port_of

        if self.port not in {None, os.environ.get(PORT_VARIABLE)}:
            raise ConfigError(f"--port {self.port} and --robot {self.robot}: give one of them")
        return port_of(fleet_of(self.fleet), self.robot)

    @property
    def given_model(self) -> "GivenModel":
        """The model that the option names, else the fleet file; `None` for the robot's own word."""
        if self.model is not None or self.robot is None:
            return self.model
        from pioneer3.fleet.reach import given_model

        fleet = fleet_of(self.fleet)
        return given_model(fleet, fleet.robot(self.robot))

    @property
    def fleet_lasers(self) -> tuple[str, ...]:
        """The laser that the fleet file gives the robot, if it is reached from here."""
        if self.robot is None:
            return ()
        from pioneer3.fleet.reach import laser_of

        laser = laser_of(fleet_of(self.fleet).robot(self.robot))
        return (laser,) if laser else ()

    @property
    def fleet_camera(self) -> str | None:
        """The URL of the camera that the fleet file gives the robot."""
        if self.robot is None:
            return None
        from pioneer3.fleet.reach import camera_of

        return camera_of(fleet_of(self.fleet).robot(self.robot))


WHICH = RobotOptions()


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions(RobotOptions):
    """The link to the robot.

    Attributes:
        camera: Its camera: http://HOST[:PORT]/PATH of an MJPEG stream.
    """

    baud: Baud = None
    log: LogOptions = AS_SET
    lasers: LaserOptions = NO_LASERS
    camera: CameraUrl = None

    @asynccontextmanager
    async def connect(
        self,
        *,
        max_speed: float | None = None,
        auto_enable: bool = True,
        line_map: str | Path | None = None,
        start: "Pose2 | str | None" = None,
        navigation: "NavigationOptions | None" = None,
        shown: bool = False,
    ) -> "AsyncIterator[Robot]":
        """Connect during the block; after it the connection is closed and the robot stands.

        A sign is `shown` on stderr until the robot is connected.
        """
        from pioneer3.navigation.connect import connect_async

        url = self.url
        async with AsyncExitStack() as stack:
            with busy_sign(f"Connecting to {url} ...") if shown else nullcontext():
                connection = connect_async(
                    url,
                    baud=self.baud,
                    model=self.given_model,
                    max_speed=max_speed,
                    auto_enable=auto_enable,
                    record=self.log.where(watches=not auto_enable),
                    lasers=await self.lasers.specs([url], self.fleet_lasers),
                    camera=self.camera or self.fleet_camera,
                    line_map=line_map,
                    start=start,
                    settings=(navigation or NAVIGATION).settings(self),
                )
                robot = await stack.enter_async_context(connection)
            yield robot

    def node(
        self, line_map: str | None, start: "Pose2 | str | None", arguments: Sequence[str] = ()
    ) -> "StartOptions":
        """Return the options of a node of ROS; without a port it looks for the robot."""
        from pioneer3.ros.node.start import StartOptions

        return StartOptions(
            port=self.url_or_none,
            model=self.given_model,
            baud=self.baud,
            record=self.log.where(),
            laser_ports=self.lasers.laser or self.fleet_lasers,
            lasers=lambda robot, otherwise: self.lasers.specs([robot], otherwise),
            camera=self.camera or self.fleet_camera,
            line_map=line_map,
            start=start,
            arguments=arguments,
        )


LINK = LinkOptions()


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationOptions:
    """The settings of navigation.

    Attributes:
        set_: GROUP.NAME=VALUE of a setting of navigation, such as planner.margin=5cm; once for
            each.
    """

    set_: Annotated[tuple[str, ...], Parameter(name="--set", metavar="SETTING"), SEVERAL] = ()

    def settings(self, link: "RobotOptions") -> "NavigationSettings":
        """Return the settings for a robot: these options', those of the fleet file, the usual ones.

        Raises:
            ConfigError: There is no such setting, or the value is out of range.
        """
        from pioneer3.nav.settings import AS_SHIPPED

        fleet = fleet_of(link.fleet) if link.robot is not None else None
        known = fleet.robot(link.robot).navigation if fleet and link.robot else AS_SHIPPED
        return known.with_texts(self.set_)


NAVIGATION = NavigationOptions()


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class MotionOptions:
    """The bounds of a motion, and its output.

    Attributes:
        seconds: Stop after this time.
        json: One JSON object for each reading, a line each.
    """

    seconds: Seconds | None = None
    json: Flag = False

    @property
    def length(self) -> float:
        """How long a mode drives that goes on by itself [s]."""
        return inf if self.seconds is None else self.seconds

    async def bounded(self, motion: Coroutine[Any, Any, None]) -> None:
        """Carry `motion` out; MotionError as it has them, or if it took too long."""
        import asyncio

        try:
            async with asyncio.timeout(self.seconds) as limit:
                await motion
        except TimeoutError:
            if not limit.expired():
                raise
            raise MotionError(f"not there after {self.seconds:g} s: stopped") from None


MOTION = MotionOptions()

WORLD = Group.create_ordered("The simulated world")


@Parameter(name="*", group=WORLD)
@dataclass(frozen=True, slots=True, kw_only=True)
class WorldOptions:
    """How the simulated world begins.

    Attributes:
        start: x,y,th as 1m,2m,90deg, or in mm, deg; home, random, outside; one for all or for each.
        fit: Accessories of all robots, such as gripper,bumpers,gyro,camera=vcc4,laser=utm-30lx.
        seed: Whole number that makes everything random repeatable, such as 7.
        keep_session: A program that vanishes leaves its session behind, as on a serial line.
        physics: Robots and boxes have mass, wheels slip and stall, by MuJoCo.
    """

    start: Annotated[
        tuple[str, ...], Parameter(negative=(), allow_leading_hyphen=True, show_default=False)
    ] = ()
    fit: Annotated[str, Parameter(show_default=False)] = ""
    seed: Annotated[int | None, Parameter(validator=Number(gte=0, lt=2**63))] = None
    keep_session: Flag = False
    physics: Flag = False

    def overrides(
        self, robots: "Sequence[str | RobotSpec]" = (), *, factory: str = "", own_ports: bool = True
    ) -> "WorldOverrides":
        """Return the changes to the world file.

        A robot may be its `MODEL[:NAME]`; there are those of the world if none is given. Every
        client gets a robot of the model `factory`, unless it is empty. With `own_ports` robots keep
        the ports that the world file gives them.

        Raises:
            ConfigError: A word is wrong.
        """
        from pioneer3.sim.worldfile import parse_equipment
        from pioneer3.sim.worldfile.arguments import WorldOverrides, parse_robot, parse_start

        return WorldOverrides(
            robots=tuple(parse_robot(each) if isinstance(each, str) else each for each in robots),
            starts=tuple(map(parse_start, self.start)),
            equipment=parse_equipment(self.fit),
            seed=self.seed,
            keep_session=self.keep_session,
            physics=self.physics,
            own_ports=own_ports,
            factory=factory,
        )
