"""Laser range finders as data: field, range, timing, errors, interfaces.

Facts: cola.md 4, lms2xx.md 1, scip.md 8, and the range finders in docs/explanation/realism.md.

Angles are counter-clockwise, seen from above, from straight ahead of the laser.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from enum import StrEnum
from math import inf, radians
from types import MappingProxyType

from pioneer3.errors import ConfigError
from pioneer3.geometry import TURN


class LaserProtocol(StrEnum):
    """The languages of lasers."""

    SCIP = "SCIP"
    LMS2XX = "LMS-2xx telegrams"
    COLA = "CoLa-A"


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeError:
    """Errors of ranges up to `up_to` [m].

    Attributes:
        systematic: Largest lasting error, the same for all readings of one unit [m].
        share: The same as a share of the range, in addition.
        sigma: Standard deviation of one reading [m].
    """

    up_to: float
    systematic: float
    share: float = 0.0
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """Geometry of a SCIP laser as its PP answer gives it (scip.md 4.1).

    Ranges from `shortest` (DMIN; smaller values are codes) to `longest` (DMAX) [mm], steps from
    `first` (AMIN) to `last` (AMAX) of `per_turn` (ARES), of which `front` (AFRT) looks straight
    ahead, and SCAN, the `rpm` [1/min].
    """

    shortest: int
    longest: int
    per_turn: int
    first: int
    last: int
    front: int
    rpm: int

    def angle(self, step: int) -> float:
        """Return the direction of `step` [rad]."""
        return (step - self.front) * TURN / self.per_turn


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserModel:
    """One type of laser range finder.

    Attributes:
        name: In files and options, such as `utm-30lx`.
        product: The product name that the unit sends.
        first: Direction of the first reading [rad].
        last: Direction of the last one [rad].
        step: From one reading to the next, as delivered [rad].
        near: Shortest range [m].
        far: Longest range [m].
        far_dark: Longest range to a surface of 10 % remission [m]; `None` where it is not known.
        turn: Time of one turn of the mirror [s].
        errors: By range.
        spot: Diameter of the light spot at the laser [m].
        divergence: Growth of that with the range [rad].
        speeds: Serial speeds [baud], the one at delivery first; empty without a serial line.
        usb: Whether it is a serial port on USB by itself, where the speed does not matter.
        tcp_ports: Empty without Ethernet.
        kinds: ARIA's names of the type.
    """

    name: str
    title: str
    protocol: LaserProtocol
    product: str
    first: float
    last: float
    step: float
    near: float
    far: float
    turn: float
    errors: tuple[RangeError, ...]
    spot: float = 0.01
    divergence: float = 0.004
    far_dark: float | None = None
    speeds: tuple[int, ...] = ()
    usb: bool = False
    tcp_ports: tuple[int, ...] = ()
    steps: Steps | None = None
    kinds: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Readings of a scan, as delivered."""
        return round((self.last - self.first) / self.step) + 1


def _scip(
    name: str,
    steps: Steps,
    *,
    far: float,
    errors: tuple[RangeError, ...],
    speeds: tuple[int, ...] = (),
    usb: bool = False,
    tcp_ports: tuple[int, ...] = (),
    kinds: tuple[str, ...] = ("urg2.0",),
) -> LaserModel:
    return LaserModel(
        name=name,
        title=f"Hokuyo {name.upper()}",
        protocol=LaserProtocol.SCIP,
        product=f"SOKUIKI Sensor {name.upper()}",
        first=steps.angle(steps.first),
        last=steps.angle(steps.last),
        step=TURN / steps.per_turn,
        near=steps.shortest / 1000,
        far=far,
        turn=60 / steps.rpm,
        errors=errors,
        speeds=speeds,
        usb=usb,
        tcp_ports=tcp_ports,
        steps=steps,
        kinds=kinds,
    )


HOKUYO_PORT = 10940
SICK_PORTS = (2111, 2112)
_URG_SPEEDS = (19200, 57600, 115200, 38400)
_URG = Steps(shortest=20, longest=5600, per_turn=1024, first=44, last=725, front=384, rpm=600)
_UBG = Steps(shortest=20, longest=5600, per_turn=1024, first=44, last=725, front=384, rpm=2142)
_UTM = Steps(shortest=23, longest=60000, per_turn=1440, first=0, last=1080, front=540, rpm=2400)
_UST = Steps(shortest=20, longest=30000, per_turn=1440, first=0, last=1080, front=540, rpm=2400)
_METRE_AND_ON = (
    RangeError(up_to=1.0, systematic=0.01, sigma=0.003),
    RangeError(up_to=inf, systematic=0.0, share=0.01, sigma=0.01),
)
_UG01 = (
    RangeError(up_to=1.0, systematic=0.03, sigma=0.005),
    RangeError(up_to=inf, systematic=0.0, share=0.03, sigma=0.015),
)
_UTM_ERRORS = (
    RangeError(up_to=10.0, systematic=0.03, sigma=0.01),
    RangeError(up_to=inf, systematic=0.05, sigma=0.03),
)
_UST_ERRORS = (RangeError(up_to=inf, systematic=0.04, sigma=0.012),)
_LMS_200 = LaserModel(
    name="lms-200",
    title="SICK LMS-200",
    protocol=LaserProtocol.LMS2XX,
    product="LMS200;301061;V02.30 ",
    first=radians(-90),
    last=radians(90),
    step=radians(1),
    near=0.0,
    far=32.0,
    far_dark=10.0,
    turn=1 / 75,
    errors=(
        RangeError(up_to=8.0, systematic=0.015, sigma=0.005),
        RangeError(up_to=inf, systematic=0.04, sigma=0.01),
    ),
    spot=0.012,
    divergence=0.0044,
    speeds=(9600, 38400, 19200, 500000),
    kinds=("lms2xx",),
)
_LMS_291 = replace(
    _LMS_200,
    name="lms-291",
    title="SICK LMS-291",
    product="LMS291;S05   ;V02.30 ",
    far=80.0,
    far_dark=30.0,
    errors=(RangeError(up_to=inf, systematic=0.035, sigma=0.01),),
)
_LMS_111 = LaserModel(
    name="lms-111",
    title="SICK LMS-111",
    protocol=LaserProtocol.COLA,
    product="LMS111",
    first=radians(-135),
    last=radians(135),
    step=radians(0.5),
    near=0.05,
    far=20.0,
    far_dark=18.0,
    turn=0.02,
    errors=(RangeError(up_to=inf, systematic=0.03, sigma=0.012),),
    spot=0.008,
    divergence=0.015,
    tcp_ports=SICK_PORTS,
    kinds=("lms1xx",),
)
_LMS_511 = replace(
    _LMS_111,
    name="lms-511",
    title="SICK LMS-511",
    product="LMS511",
    first=radians(-95),
    last=radians(95),
    near=0.1,
    far=80.0,
    far_dark=26.0,
    errors=(
        RangeError(up_to=10.0, systematic=0.025, sigma=0.007),
        RangeError(up_to=20.0, systematic=0.035, sigma=0.009),
        RangeError(up_to=inf, systematic=0.05, sigma=0.014),
    ),
    spot=0.0136,
    divergence=0.0045,
    kinds=("lms5xx",),
)
_TIM_551 = replace(
    _LMS_111,
    name="tim551",
    title="SICK TiM551",
    product="TiM551",
    step=radians(1),
    far=10.0,
    far_dark=8.0,
    turn=1 / 15,
    errors=(RangeError(up_to=inf, systematic=0.06, sigma=0.02),),
    spot=0.007,
    divergence=0.0173,
    kinds=("tim551", "tim5xx"),
)
_TIM_561 = replace(
    _TIM_551,
    name="tim561",
    title="SICK TiM561",
    product="TiM561",
    step=radians(1 / 3),
    kinds=("tim561",),
)
_TIM_571 = replace(
    _TIM_561, name="tim571", title="SICK TiM571", product="TiM571", far=25.0, kinds=("tim571",)
)

LASERS: Mapping[str, LaserModel] = MappingProxyType(
    {
        model.name: model
        for model in (
            _scip(
                "urg-04lx",
                _URG,
                far=4.095,
                errors=_METRE_AND_ON,
                speeds=_URG_SPEEDS,
                kinds=("urg", "urg2.0"),
            ),
            _scip("urg-04lx-ug01", _URG, far=5.6, errors=_UG01, usb=True),
            _scip("ubg-04lx-f01", _UBG, far=5.6, errors=_METRE_AND_ON, speeds=_URG_SPEEDS),
            _scip(
                "utm-30lx", _UTM, far=30.0, errors=_UTM_ERRORS, usb=True, tcp_ports=(HOKUYO_PORT,)
            ),
            _scip("ust-10lx", _UST, far=10.0, errors=_UST_ERRORS, tcp_ports=(HOKUYO_PORT,)),
            _scip("ust-20lx", _UST, far=20.0, errors=_UST_ERRORS, tcp_ports=(HOKUYO_PORT,)),
            _LMS_200,
            _LMS_291,
            _LMS_111,
            _LMS_511,
            _TIM_551,
            _TIM_561,
            _TIM_571,
        )
    }
)
"""By name."""


def load_laser(name: str) -> LaserModel:
    """Return the laser of this name; the ConfigError for another names those that there are."""
    found = LASERS.get(name.strip().lower())
    if found is not None:
        return found
    close = get_close_matches(name.lower(), LASERS, n=1)
    hint = f", did you mean {close[0]}?" if close else f"; known are {', '.join(LASERS)}"
    raise ConfigError(f"{name!r}: no such laser{hint}")
