"""A simulated SCIP laser without its hosts: laser, motor, clock, identity. No I/O.

Facts: scip.md 4, 5.1.
"""

from math import inf
from typing import Final

from pioneer3.lasers.device import MirrorTurn
from pioneer3.lasers.scip.sweeps import codes_of
from pioneer3.lasers.scip.timing import WRAP
from pioneer3.models.lasers import LaserModel
from pioneer3.units import MS

WELL: Final = "Sensor works well."
STABLE: Final = "Stable 000 no error."
"""The two ways in which STAT of II says that nothing is wrong."""
OTHER_SPEEDS: Final = (250000, 500000, 750000)
"""That lasers with a serial line know, too [baud]."""
MULTI_ECHO: Final = {"utm-30lx"}
"""Models that send several echoes, over Ethernet as the UTM-30LX-EW."""


class ScipUnit:
    """The state that all hosts of a laser share.

    Args:
        model: Its type.
        serial: Its serial number.
        firmware: FIRM of VV.
        status: STAT of II.
        start_speed: Of its serial line after power-on [baud], or `None` without one.
        begins_in_scip1: Whether it speaks SCIP 1.1 after power-on.
        knows_scip2: Whether it knows SCIP 2.0 at all.
        boot_time: It is deaf for so long after power-on [s].

    Attributes:
        fault: Status in answer to BM and to measuring commands in place of success; empty: none.
        laser_on: Whether the laser shines.
        sensitive: Whether HS1 has made it more sensitive.
        slower: Percentage by which CR has made the motor slower.
        streams: Number of hosts that get scans without asking for each.
        boots: Number of restarts.
    """

    def __init__(
        self,
        model: LaserModel,
        *,
        serial: str,
        firmware: str,
        status: str,
        start_speed: int | None,
        begins_in_scip1: bool,
        knows_scip2: bool,
        boot_time: float,
    ) -> None:
        if model.steps is None:
            raise ValueError(f"{model.name} does not speak SCIP")
        self.model = model
        self.steps = model.steps
        self.codes = codes_of(model, model.steps)
        self.serial = serial
        self.firmware = firmware
        self.status = status
        self.start_speed = start_speed
        self.begins_in_scip1 = begins_in_scip1
        self.knows_scip2 = knows_scip2
        self.fault = ""
        self.laser_on = begins_in_scip1
        self.sensitive = False
        self.slower = 0
        self.streams = 0
        self.boots = 0
        self._boot_time = boot_time
        self._ready_at = -inf
        self._clock_began = 0.0

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
        self._ready_at = now + self._boot_time
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
