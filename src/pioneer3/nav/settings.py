"""Settings of navigation that a lab may tune: each with its unit, its range and its meaning.

The command line (`--set planner.margin=5cm`), ROS parameters, files and the docs are made of these
classes. What nobody tunes is a constant beside the code that it belongs to.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from typing import Annotated, Any, Final, get_type_hints

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.units import ANGLE, DURATION, LENGTH, Quantity


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerSettings:
    """Settings of ways, and of the drives along them."""

    margin: Annotated[
        float,
        Meta(ge=0.0, le=0.5, description="room on either side of the robot in narrow places"),
        LENGTH,
    ] = 0.07
    turning_margin: Annotated[
        float, Meta(ge=0.0, le=0.5, description="room around a robot that turns"), LENGTH
    ] = 0.03
    comfort: Annotated[
        float,
        Meta(ge=0.05, le=2.0, description="room beside the robot; more is worth no detour"),
        LENGTH,
    ] = 0.35
    narrow_cost: Annotated[
        float,
        Meta(ge=0.0, le=50.0, description="metres of detour that a metre without room is worth"),
    ] = 3.0
    period: Annotated[
        float, Meta(ge=0.2, le=60.0, description="time between two plans"), DURATION
    ] = 1.0
    held_up: Annotated[
        float,
        Meta(ge=1.0, le=600.0, description="time without headway before another way is taken"),
        DURATION,
    ] = 6.0
    blocked: Annotated[
        float,
        Meta(ge=1.0, le=3600.0, description="time before a way that is closed is given up"),
        DURATION,
    ] = 15.0
    blocked_by_people: Annotated[
        float,
        Meta(ge=1.0, le=3600.0, description="this time while people are about"),
        DURATION,
    ] = 90.0
    pause: Annotated[
        float,
        Meta(ge=0.0, le=3600.0, description="time that a patrol stands at each place"),
        DURATION,
    ] = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalizerSettings:
    """Settings of the search for the robot's place on a map."""

    particles: Annotated[
        int, Meta(ge=50, le=5000, description="particles that track the robot")
    ] = 500
    way: Annotated[
        float, Meta(ge=0.01, le=1.0, description="way after which readings count"), LENGTH
    ] = 0.1
    turn: Annotated[
        float, Meta(ge=0.01, le=1.0, description="turn after which readings count"), ANGLE
    ] = 0.1
    way_error: Annotated[
        float, Meta(ge=0.0, le=0.5, description="error of odometry by its way, sigma [m/m]")
    ] = 0.03
    turn_error: Annotated[
        float, Meta(ge=0.0, le=0.5, description="error of odometry by its turn, sigma [rad/rad]")
    ] = 0.06
    agreement: Annotated[
        float,
        Meta(ge=0.3, le=1.0, description="share of beams that fit the map at a place found"),
    ] = 0.9
    told_agreement: Annotated[
        float,
        Meta(ge=0.3, le=1.0, description="share of beams that fit the map at a place told"),
    ] = 0.75
    contradiction: Annotated[
        float, Meta(ge=0.0, le=0.95, description="share of beams that fit where it is lost")
    ] = 0.7


@dataclass(frozen=True, slots=True, kw_only=True)
class MapperSettings:
    """Settings of maps that are made, and of the exploration for them."""

    cell: Annotated[
        float,
        Meta(ge=0.01, le=0.2, description="side of a cell"),
        LENGTH,
    ] = 0.025
    way: Annotated[
        float, Meta(ge=0.05, le=2.0, description="way after which a scan is kept"), LENGTH
    ] = 0.25
    turn: Annotated[
        float, Meta(ge=0.05, le=1.5, description="turn after which a scan is kept"), ANGLE
    ] = 0.25
    way_error: Annotated[
        float, Meta(ge=0.0, le=0.5, description="error of odometry by its way, sigma [m/m]")
    ] = 0.03
    turn_error: Annotated[
        float, Meta(ge=0.0, le=0.5, description="error of odometry by its turn, sigma [rad/rad]")
    ] = 0.1
    period: Annotated[
        float, Meta(ge=0.2, le=60.0, description="time between two drawings"), DURATION
    ] = 1.0
    patience: Annotated[
        float,
        Meta(ge=5.0, le=600.0, description="time without new ground before an edge is given up"),
        DURATION,
    ] = 45.0


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationSettings:
    """All settings of navigation.

    Attributes:
        planner: Of ways, and of the drives along them.
        localizer: Of the search for the robot's place on a map.
        mapper: Of maps that are made.
    """

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
        """Return these settings with others.

        Args:
            values: By names such as `planner.margin`: numbers [SI], or texts with a unit.

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
    """One setting, as people meet it.

    Attributes:
        name: With its group, such as `planner.margin`.
        default: Used unless given [SI].
        low: Smallest value.
        high: Largest value.
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
    for one in fields(kind):
        notes: tuple[Any, ...] = get_type_hints(kind, include_extras=True)[one.name].__metadata__
        (meta,) = (note for note in notes if isinstance(note, Meta))
        yield Setting(
            name=f"{group}.{one.name}",
            default=getattr(kind(), one.name),
            low=float(meta.ge or 0),
            high=float(meta.le or 0),
            quantity=next((note for note in notes if isinstance(note, Quantity)), None),
            meaning=meta.description or "",
        )


SETTINGS: Final = {
    setting.name: setting
    for group, kind in get_type_hints(NavigationSettings).items()
    for setting in _settings_of(group, kind)
}
"""All settings by their names."""


AS_SHIPPED: Final = NavigationSettings()
"""The settings where nobody has tuned any."""
