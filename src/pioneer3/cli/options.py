"""Options that several commands share: one name, one help, one default each."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group, Parameter
from cyclopts.validators import Number

if TYPE_CHECKING:
    from pioneer3.sim.worldfile.arguments import Wishes

DEFAULT_PORT = "tcp://localhost:8101"

Port = Annotated[str, Parameter(name=["--port", "-p"], env_var="PIONEER3_PORT")]
Baud = Annotated[int | None, Parameter(name=["--baud", "-b"], env_var="PIONEER3_BAUD")]
TcpPort = Annotated[int, Parameter(validator=Number(gte=0, lte=65535))]

WORLD = Group.create_ordered("The simulated world")


@Parameter(name="*", group=WORLD)
@dataclass(frozen=True, slots=True, kw_only=True)
class WorldOptions:
    """How the simulated world begins.

    Attributes:
        start: x,y,th [mm, deg], home, random or outside; once for all robots, or for each.
        fit: Accessories of all robots, such as gripper,bumpers,compass,gyro,camera=vcc4.
        seed: Whole number that makes everything random repeatable, such as 7.
    """

    start: Annotated[
        tuple[str, ...],
        Parameter(negative=(), allow_leading_hyphen=True, show_default=False),
    ] = ()
    fit: Annotated[str, Parameter(show_default=False)] = ""
    seed: Annotated[int | None, Parameter(validator=Number(gte=0, lt=2**63))] = None

    def wishes(
        self, robots: tuple[str, ...] = (), *, factory: str = "", own_ports: bool = True
    ) -> "Wishes":
        """Return what to lay over the world file.

        Args:
            robots: `MODEL[:NAME]` of each, empty for the world's.
            factory: Model of which every client gets a robot; empty for none.
            own_ports: Whether robots keep the ports that the world file gives them.

        Raises:
            ConfigError: A word is wrong.
        """
        from pioneer3.sim.worldfile.arguments import (  # noqa: PLC0415
            Wishes,
            parse_robot,
            parse_start,
        )
        from pioneer3.sim.worldfile.fitting import parse_fitting  # noqa: PLC0415

        return Wishes(
            robots=tuple(map(parse_robot, robots)),
            starts=tuple(map(parse_start, self.start)),
            equipment=parse_fitting(self.fit),
            seed=self.seed,
            own_ports=own_ports,
            factory=factory,
        )
