"""A simulated SCIP laser without its hosts: laser, motor, clock, identity. No I/O.

Facts: scip.md 4, 5.1.
"""

from dataclasses import dataclass, field
from math import inf
from typing import Final

from pioneer3.lasers.device import MirrorTurn
from pioneer3.lasers.scip.sweeps import Codes, codes_of
from pioneer3.lasers.scip.timing import WRAP
from pioneer3.models.lasers import LaserModel, Steps
from pioneer3.units import MS

WELL: Final = "Sensor works well."
"""STAT of II, by which nothing is wrong; others say `Stable 000 no error.`"""
OTHER_SPEEDS: Final = (250000, 500000, 750000)
"""That lasers with a serial line know, too [baud]."""
MULTI_ECHO: Final = {"utm-30lx"}
"""Models that send several echoes, over Ethernet as the UTM-30LX-EW."""


@dataclass(slots=True)
class ScipUnit:
    """The state that all hosts of a laser share, begun as :class:`ScipDevice` is asked for.

    `fault` is the status in answer to BM and to measuring commands in place of success, empty for
    none. HS1 has made the laser more `sensitive`, CR its motor `slower` by a percentage; so many
    hosts get scans without asking for each, `streams`; `boots` counts restarts.
    """

    model: LaserModel
    serial: str
    firmware: str
    status: str
    start_speed: int | None
    begins_in_scip1: bool
    knows_scip2: bool
    boot_time: float
    fault: str = field(default="", init=False)
    laser_on: bool = field(init=False)
    sensitive: bool = field(default=False, init=False)
    slower: int = field(default=0, init=False)
    streams: int = field(default=0, init=False)
    boots: int = field(default=0, init=False)
    steps: Steps = field(init=False)
    codes: Codes = field(init=False)
    _ready_at: float = field(default=-inf, init=False)
    _clock_began: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        if self.model.steps is None:
            raise ValueError(f"{self.model.name} does not speak SCIP")
        self.steps = self.model.steps
        self.codes = codes_of(self.model, self.steps)
        self.laser_on = self.begins_in_scip1

    @property
    def speeds(self) -> tuple[int, ...]:
        """Speeds that SS may choose [baud]; empty without a serial line."""
        if self.start_speed is None:
            return ()
        return (*self.model.speeds, self.start_speed, *OTHER_SPEEDS)

    @property
    def turn(self) -> MirrorTurn:
        """One turn of the mirror."""
        steps = self.steps
        rpm = steps.rpm * (1 - self.slower / 100)
        return MirrorTurn(
            first=self.model.first,
            step=self.model.step,
            count=steps.last - steps.first + 1,
            beam_time=60 / (rpm * steps.per_turn),
            period=60 / rpm,
        )

    def restart(self, now: float) -> None:
        """Begin as after a power cycle."""
        self.boots += 1
        self.streams = 0
        self._ready_at = now + self.boot_time
        self.reset(now)
        self.laser_on = self.begins_in_scip1

    def reset(self, now: float) -> None:
        """Take back the settings that were changed since power-on."""
        self.laser_on = False
        self.sensitive = False
        self.slower = 0
        self._clock_began = now

    def hears(self, now: float) -> bool:
        """Tell whether the unit has started up."""
        return now >= self._ready_at

    def stamp(self, moment: float) -> int:
        """Return the unit's clock at `moment` [ms]."""
        return int((moment - self._clock_began) / MS + 1e-6) % WRAP

    @property
    def identity(self) -> dict[str, object]:
        """The answer to VV."""
        return {
            "VEND": "Hokuyo Automatic Co.,Ltd.",
            "PROD": self.model.product,
            "FIRM": self.firmware,
            "PROT": "SCIP 2.0" if self.knows_scip2 else "SCIP 1.1",
            "SERI": self.serial,
        }

    @property
    def parameters(self) -> dict[str, object]:
        """The answer to PP."""
        steps = self.steps
        return {
            "MODL": self.model.product.removeprefix("SOKUIKI Sensor "),
            "DMIN": steps.shortest,
            "DMAX": steps.longest,
            "ARES": steps.per_turn,
            "AMIN": steps.first,
            "AMAX": steps.last,
            "AFRT": steps.front,
            "SCAN": steps.rpm,
        }

    def state(self, baud: int | None, now: float) -> dict[str, object]:
        """Return the answer to II."""
        rpm = self.steps.rpm * (100 - self.slower) // 100
        return {
            "MODL": self.parameters["MODL"],
            "LASR": "ON" if self.laser_on else "OFF",
            "SCSP": f"Initial({rpm}[rpm])<-Default setting by user",
            "MESM": "Measuring by Sensitive Mode" if self.sensitive else "IDLE",
            "SBPS": f"{baud}[bps]<-Default setting by user" if baud else "USB or Ethernet",
            "TIME": f"{self.stamp(now):06X}",
            "STAT": self.status,
        }
