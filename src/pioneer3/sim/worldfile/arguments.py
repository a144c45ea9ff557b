"""Options of a command line about robots and starts, which override a world file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.equipment import NO_OPTIONS, EquipmentOptions
from pioneer3.sim.relief.shapes import FARTHEST
from pioneer3.sim.worldfile.spec import RobotSpec, Start, WorldFile
from pioneer3.sim.worldfile.toml import MODEL_FILES
from pioneer3.text import shown
from pioneer3.units import ANGLE, LENGTH

LONGEST_NAME = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldOverrides:
    """Options of a command line; they override the world file, except for its equipment.

    There is one start for all robots, or one for each. With `own_ports` robots keep those of the
    world file. `factory` is the model that every client of one port gets; empty for none.
    """

    robots: tuple[RobotSpec, ...] = ()
    starts: tuple[Start, ...] = ()
    equipment: EquipmentOptions = NO_OPTIONS
    seed: int | None = None
    keep_session: bool = False
    physics: bool = False
    own_ports: bool = True
    factory: str = ""

    def applied_to(self, world: WorldFile) -> WorldFile:
        """Return `world` with these options; without robots and factory it gets a robot.

        Raises:
            ConfigError: There are several starts, but not one for each robot.
        """
        robots = self.robots or world.robots
        if not robots and not self.factory:
            robots = (RobotSpec(),)
        starts = self._starts_of(robots)
        return replace(
            world,
            seed=world.seed if self.seed is None else self.seed,
            keep_session=world.keep_session or self.keep_session,
            physics="mujoco" if self.physics else world.physics,
            robots=tuple(
                replace(
                    robot,
                    start=start,
                    port=robot.port if self.own_ports else None,
                    host=robot.host if self.own_ports else "",
                    equipment=robot.equipment.overridden_by(self.equipment),
                )
                for robot, start in zip(robots, starts, strict=True)
            ),
        )

    @property
    def factory_robot(self) -> RobotSpec | None:
        """The robot that every client of the factory gets, or `None` without a factory."""
        if not self.factory:
            return None
        start = self.starts[0] if self.starts else "home"
        return RobotSpec(model=self.factory, start=start, port=0, equipment=self.equipment)

    def _starts_of(self, robots: Sequence[RobotSpec]) -> Sequence[Start]:
        if not self.starts:
            return [robot.start for robot in robots]
        if len(self.starts) == 1:
            return self.starts * len(robots)
        if len(self.starts) == len(robots):
            return self.starts
        raise ConfigError(
            f"--start: {len(self.starts)} given, but robots: {len(robots)}; "
            "give one for all, or one for each"
        )


NO_OVERRIDES = WorldOverrides()


def parse_robot(text: str) -> RobotSpec:
    """Read `MODEL[:NAME]`, such as `p3at`, `p3dx:bob` or `params/mine.p:eve`.

    The model is not looked up yet.

    Raises:
        ConfigError: It names no model, or the name cannot be printed.
    """
    model, colon, name = text.rpartition(":")
    if not colon or "/" in name or PurePath(name).suffix.lower() in MODEL_FILES:
        model, name = text, ""
    elif not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise _wrong("--robot", text, f"a name has 1 to {LONGEST_NAME} letters, as in p3dx:bob")
    if not model:
        raise _wrong("--robot", text, "expected a model, or MODEL:NAME such as p3dx:bob")
    return RobotSpec(model=model, name=name)


def parse_start(text: str) -> Start:
    """Read `x,y,th`, or `home`, `random`, `outside`.

    Numbers are in mm and degrees, as MobileSim takes them, unless they carry units: `1m,2m,90deg`.

    Raises:
        ConfigError: It is neither.
    """
    match text:
        case "random" | "outside" | "home":
            return text
    try:
        first, second, third = text.split(",")
        x, y, theta = LENGTH.read(first, "mm"), LENGTH.read(second, "mm"), ANGLE.read(third)
    except ValueError:
        hint = (
            "expected x,y,th such as 3000,3100,90 [mm, deg] or 3m,3.1m,90deg, "
            "or home, random, outside"
        )
        raise _wrong("--start", text, hint) from None
    if not abs(x) <= FARTHEST or not abs(y) <= FARTHEST:
        raise _wrong("--start", text, f"not within {FARTHEST / 1000:g} km of the map's origin")
    return Pose2(x, y, wrap(theta))


def _wrong(option: str, text: str, problem: str) -> ConfigError:
    return ConfigError(f"{option} {shown(text)}: {problem}")
