"""Limits of the lasers that speak CoLa-A (cola.md 4)."""

from dataclasses import dataclass
from math import degrees
from typing import Final

from pioneer3.lasers.cola.configuration import ScanConfig, ScanConfigCode
from pioneer3.models.lasers import LASERS, LaserModel, LaserProtocol

FULL_TURN_TICK: Final = 3_600_000
FRONT_TICK: Final = 900_000
"""Straight ahead [1/10000 degree]."""
_EXACT_STEP: Final = {1667: 1e4 / 6, 3333: 1e4 / 3, 6667: 2e4 / 3}
"""Steps [1/10000 degree] that the wire rounds, by the number on the wire."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """One family of lasers, whose names begin with `prefix`; angles as in `ScanConfig`.

    It sends so many light `pulses` a second at most, and ranges in units of `scale` [mm].
    FREchoFilter chooses the echoes where there is an `echo_filter`; mLMPsetscancfg changes nothing
    where it is not `adjustable`. The variable `state_request` tells whether the laser measures.
    """

    prefix: str
    frequencies_chz: tuple[int, ...]
    steps_tick: tuple[int, ...]
    pulses: int
    first_tick: int
    last_tick: int
    echoes: int = 1
    scale: float = 1.0
    echo_filter: bool = False
    adjustable: bool = True
    state_request: str = "STlms"

    def fits(self, frequency_chz: int, step_tick: int) -> bool:
        """Tell whether the laser sends light pulses quickly enough for both."""
        pulses = frequency_chz / 100 * FULL_TURN_TICK / exact_step(step_tick)
        return round(pulses) <= self.pulses

    def holds(self, first_tick: int, last_tick: int) -> bool:
        """Tell whether the field has this part."""
        return self.first_tick <= first_tick < last_tick <= self.last_tick

    def check(self, wanted: ScanConfig) -> ScanConfigCode:
        """Return the laser's judgement of `wanted` (cola.md 2.3)."""
        bad_frequency = wanted.frequency_chz not in self.frequencies_chz
        bad_step = wanted.step_tick not in self.steps_tick
        if not bad_frequency and not bad_step:
            bad_step = not self.fits(wanted.frequency_chz, wanted.step_tick)
        if bad_frequency or bad_step:
            return ScanConfigCode(bad_frequency + 2 * bad_step)
        if wanted.sectors != 1:
            return ScanConfigCode.OTHER
        fits = self.holds(wanted.first_tick, wanted.last_tick)
        return ScanConfigCode.OK if fits else ScanConfigCode.AREA


LMS1XX: Final = Family(
    prefix="LMS1",
    frequencies_chz=(2500, 5000),
    steps_tick=(2500, 5000),
    pulses=36_000,
    first_tick=-450_000,
    last_tick=2_250_000,
    echoes=2,
)
LMS5XX: Final = Family(
    prefix="LMS5",
    frequencies_chz=(2500, 3500, 5000, 7500, 10_000),
    steps_tick=(1667, 2500, 3333, 5000, 6667, 10_000),
    pulses=54_000,
    first_tick=-50_000,
    last_tick=1_850_000,
    echoes=5,
    scale=2.0,
    echo_filter=True,
)
TIM: Final = Family(
    prefix="TiM",
    frequencies_chz=(1500,),
    steps_tick=(3333, 10_000),
    pulses=16_200,
    first_tick=-450_000,
    last_tick=2_250_000,
    adjustable=False,
    state_request="SCdevicestate",
)


def family_of(product: str) -> Family | None:
    """Return the family of the laser that calls itself `product`, `None` if it is not known."""
    for family in (LMS1XX, LMS5XX, TIM):
        if product.upper().startswith(family.prefix.upper()):
            return family
    return None


def limits_of(product: str) -> tuple[float, float]:
    """Return the shortest and the longest range of this product, or of one of its family [m]."""
    models = [model for model in LASERS.values() if model.protocol is LaserProtocol.COLA]
    for length in (6, 4, 3):  # the type, its series, its family
        for model in models:
            if model.product[:length].upper() == product[:length].upper():
                return model.near, model.far
    return 0.0, max(model.far for model in models)


def delivered(model: LaserModel, family: Family) -> ScanConfig:
    """Return the settings of `model` at delivery."""
    return ScanConfig(
        frequency_chz=round(100 / model.turn),
        step_tick=round(degrees(model.step) * 1e4),
        first_tick=family.first_tick,
        last_tick=family.last_tick,
    )


def exact_step(step_tick: int) -> float:
    """Return the step that the wire rounds to `step_tick` [1/10000 degree]."""
    return _EXACT_STEP.get(step_tick, step_tick)
