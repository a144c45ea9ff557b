"""Settings of navigation that a lab may tune: each with its unit, its range and its meaning.

The command line (`--set planner.margin=5cm`), ROS parameters, files and the docs are made of these
classes. What nobody tunes is a constant beside the code that it belongs to.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from inspect import getdoc
from typing import Annotated, Any, Final, get_type_hints

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.units import ANGLE, DURATION, LENGTH, Quantity


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerSettings:
    """Settings of ways, and of the drives along them.

    Attributes:
        margin: Room on either side of the robot in narrow places.
        turning_margin: Room around a robot that turns.
        contact_margin: Distance to walls and echoes within which a robot only gets farther.
        comfort: Room beside the robot; more is worth no detour.
        narrow_cost: Metres of detour that a metre without room is worth.
        period: Time between two plans.
        held_up: Time without headway before another way is taken.
        blocked: Time before a way that is closed is given up.
        blocked_by_people: Time before it is given up while people are about.
        pause: Time that a patrol stands at each place.
    """

    margin: Annotated[float, Meta(ge=0.0, le=0.5), LENGTH] = 0.07
    turning_margin: Annotated[float, Meta(ge=0.0, le=0.5), LENGTH] = 0.03
    contact_margin: Annotated[float, Meta(ge=0.005, le=0.1), LENGTH] = 0.02
    comfort: Annotated[float, Meta(ge=0.05, le=2.0), LENGTH] = 0.35
    narrow_cost: Annotated[float, Meta(ge=0.0, le=50.0)] = 3.0
    period: Annotated[float, Meta(ge=0.2, le=60.0), DURATION] = 1.0
    held_up: Annotated[float, Meta(ge=1.0, le=600.0), DURATION] = 6.0
    blocked: Annotated[float, Meta(ge=1.0, le=3600.0), DURATION] = 15.0
    blocked_by_people: Annotated[float, Meta(ge=1.0, le=3600.0), DURATION] = 90.0
    pause: Annotated[float, Meta(ge=0.0, le=3600.0), DURATION] = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalizerSettings:
    """Settings of the search for the robot's place on a map.

    Attributes:
        particles: Particles that track the robot.
        way: Way after which readings count.
        turn: Turn after which readings count.
        way_error: Error of odometry by its way, sigma [m/m].
        turn_error: Error of odometry by its turn, sigma [rad/rad].
        agreement: Share of beams that fit the map at a place found.
        told_agreement: Share of beams that fit the map at a place told.
        contradiction: Share of beams that fit the map below which the robot is lost.
    """

    particles: Annotated[int, Meta(ge=50, le=5000)] = 500
    way: Annotated[float, Meta(ge=0.01, le=1.0), LENGTH] = 0.1
    turn: Annotated[float, Meta(ge=0.01, le=1.0), ANGLE] = 0.1
    way_error: Annotated[float, Meta(ge=0.0, le=0.5)] = 0.03
    turn_error: Annotated[float, Meta(ge=0.0, le=0.5)] = 0.06
    agreement: Annotated[float, Meta(ge=0.3, le=1.0)] = 0.9
    told_agreement: Annotated[float, Meta(ge=0.3, le=1.0)] = 0.75
    contradiction: Annotated[float, Meta(ge=0.0, le=0.95)] = 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class MapperSettings:
    """Settings of maps that are made, and of the exploration for them.

    Attributes:
        cell: Side of a cell.
        way: Way after which a scan is kept.
        turn: Turn after which a scan is kept.
        way_error: Error of odometry by its way, sigma [m/m].
        turn_error: Error of odometry by its turn, sigma [rad/rad].
        fit: Share of a scan that fits below which it may be elsewhere.
        period: Time between two drawings.
        patience: Time without new ground before an edge is given up.
    """

    cell: Annotated[float, Meta(ge=0.01, le=0.2), LENGTH] = 0.025
    way: Annotated[float, Meta(ge=0.05, le=2.0), LENGTH] = 0.25
    turn: Annotated[float, Meta(ge=0.05, le=1.5), ANGLE] = 0.25
    way_error: Annotated[float, Meta(ge=0.0, le=0.5)] = 0.03
    turn_error: Annotated[float, Meta(ge=0.0, le=0.5)] = 0.1
    fit: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.6
    period: Annotated[float, Meta(ge=0.2, le=60.0), DURATION] = 1.0
    patience: Annotated[float, Meta(ge=5.0, le=600.0), DURATION] = 45.0


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationSettings:
    """All settings of navigation."""

    planner: PlannerSettings = field(default_factory=PlannerSettings)
    localizer: LocalizerSettings = field(default_factory=LocalizerSettings)
    mapper: MapperSettings = field(default_factory=MapperSettings)

    def value(self, name: str) -> float:
        """Return the value of a setting by its name, such as `planner.margin`."""
        group, _, key = name.partition(".")
        number: float = getattr(getattr(self, group), key)
        return number

    def with_texts(self, texts: Iterable[str]) -> "NavigationSettings":
        """Return these settings with those of a command line, such as `planner.margin=5cm`.

        Raises:
            ConfigError: There is no such setting, or the value is out of range.
        """
        return self.with_values(
            {name: value for name, _, value in (t.partition("=") for t in texts)}
        )

    def with_values(self, values: Mapping[str, float | str]) -> "NavigationSettings":
        """Return these settings with others, by names such as `planner.margin`.

        Values are numbers [SI], or texts with a unit.

        Raises:
            ConfigError: There is no such setting, or the value is out of range.
        """
        settings = self
        for name, value in values.items():
            if name not in SETTINGS:
                close = get_close_matches(name, SETTINGS, 1)
                hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(SETTINGS)}"
                raise ConfigError(f"{name}: no such setting; {hint}")
            group, _, key = name.partition(".")
            changed = replace(getattr(settings, group), **{key: SETTINGS[name].read(value)})
            settings = replace(settings, **{group: changed})
        return settings


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One setting, as people meet it, with its group in the name and values [SI].

    Attributes:
        quantity: Kind of the number; `None` for a number without a unit.
        meaning: A few words, without a final stop.
    """

    name: str
    default: float
    low: float
    high: float
    quantity: Quantity | None
    meaning: str

    @property
    def is_whole(self) -> bool:
        """Whether it is a whole number."""
        return isinstance(self.default, int)

    @property
    def unit(self) -> str:
        """Its unit in SI; empty for none."""
        if self.quantity is None:
            return ""
        return next(unit for unit, size in self.quantity.units.items() if size == 1.0)

    def read(self, value: float | str) -> float:
        """Return a value: a number [SI], or a text that may carry a unit.

        Raises:
            ConfigError: It is none, or out of range.
        """
        try:
            if isinstance(value, str) and self.quantity is not None:
                number = self.quantity.read(value)
            else:
                number = type(self.default)(value)
        except (TypeError, ValueError) as error:
            kind = "a whole number" if self.is_whole else "a number"
            told = str(error) if self.quantity else f"expected {kind}, got {value!r}"
            raise ConfigError(f"{self.name}: {told}") from None
        if not self.low <= number <= self.high:
            limits = f"{self.written(self.low)} to {self.written(self.high)}"
            raise ConfigError(f"{self.name}: {value} is out of range, expected {limits}")
        return number

    def written(self, value: float) -> str:
        """Return a value [SI] in the unit of bare numbers."""
        return self.quantity.written(value) if self.quantity else f"{value:g}"


def _settings_of(group: str, kind: type) -> Iterable[Setting]:
    meanings = dict(re.findall(r"^    (\w+): (.*)\.$", getdoc(kind) or "", re.MULTILINE))
    for one in fields(kind):
        notes: tuple[Any, ...] = get_type_hints(kind, include_extras=True)[one.name].__metadata__
        (meta,) = (note for note in notes if isinstance(note, Meta))
        meaning = meanings.get(one.name, "")
        yield Setting(
            name=f"{group}.{one.name}",
            default=getattr(kind(), one.name),
            low=float(meta.ge or 0),
            high=float(meta.le or 0),
            quantity=next((note for note in notes if isinstance(note, Quantity)), None),
            meaning=meaning[:1].lower() + meaning[1:],
        )


SETTINGS: Final = {
    setting.name: setting
    for group, kind in get_type_hints(NavigationSettings).items()
    for setting in _settings_of(group, kind)
}
"""All settings by their names."""


AS_SHIPPED: Final = NavigationSettings()
"""The settings where nobody has tuned any."""
