"""The description of a mode: its words, its parameters with their ranges and units, its stack."""

from dataclasses import dataclass
from inspect import cleandoc
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

import msgspec
from msgspec import Meta

from pioneer3.units import ANGLE, DURATION, LENGTH, SPEED, TURN_RATE, Quantity

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Stack
    from pioneer3.limits import Limits

Coordinate = Annotated[float, Meta(ge=-1e4, le=1e4), LENGTH]
Distance = Annotated[float, Meta(ge=0.1, le=3.0), LENGTH]
Angle = Annotated[float, Meta(ge=-100.0, le=100.0), ANGLE]
Speed = Annotated[float, Meta(gt=0.0, le=10.0), SPEED]
TurnRate = Annotated[float, Meta(gt=0.0, le=10.0), TURN_RATE]
Seconds = Annotated[float, Meta(gt=0.0, le=3600.0), DURATION]


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the words that a parameter may be, its label on the page, and a few words about it."""

    name: str
    title: str
    hint: str


@dataclass(frozen=True, slots=True)
class Choices:
    """Annotates a parameter whose type is a `Literal` of the same words."""

    choices: tuple[Choice, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The words."""
        return tuple(choice.name for choice in self.choices)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeParameter:
    """One parameter of a mode: a number of a quantity, or one of the words `choices`.

    Attributes:
        default: Used without it; `None` is none.
        low: Smallest value [SI], `high` the largest; a `positive` one must be more than zero.
    """

    name: str
    title: str
    help: str
    required: bool
    default: float | str | None
    quantity: Quantity | None
    low: float | None
    high: float | None
    positive: bool
    choices: tuple[Choice, ...]

    def check(self, value: float) -> float:
        """Return `value` [SI]; ValueError, which gives the range, if it is out of it."""
        assert self.quantity is not None
        written = self.quantity.written
        if self.positive and value <= 0:
            raise ValueError("it must be positive")
        if self.low is not None and value < self.low:
            raise ValueError(f"it must be at least {written(self.low)}")
        if self.high is not None and value > self.high:
            raise ValueError(f"it must be at most {written(self.high)}")
        return value


class Described(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="mode"
):
    """A behavior with its parameters, of one robot (:class:`Mode`) or of several.

    The first line of a subclass's docstring is its summary, the rest is advice before the start.
    Its `tag` is its name.

    Attributes:
        title: Its heading on the page.
        doing: Its effect, for a line about the robot: "wanders".
        start: On the button that starts it.
        example: Options of the command line, to copy.
        arguments: Parameters that the command line takes by their order, not as options.
    """

    title: ClassVar[str]
    doing: ClassVar[str]
    start: ClassVar[str]
    example: ClassVar[str] = ""
    arguments: ClassVar[tuple[str, ...]] = ()

    seconds: Annotated[Seconds, Meta(title="For at most", description="Stop after this time.")] = (
        60.0
    )

    @classmethod
    def name(cls) -> str:
        """Return its name, on the command line, in the HTTP API and in ROS."""
        tag = cls.__struct_config__.tag
        assert isinstance(tag, str)
        return tag

    @classmethod
    def summary(cls) -> str:
        """Return a sentence about it."""
        return cleandoc(cls.__doc__ or "").partition("\n")[0]

    @classmethod
    def advice(cls) -> str:
        """Return advice before the start, in one line; may be empty."""
        return " ".join(cleandoc(cls.__doc__ or "").partition("\n")[2].split())

    @classmethod
    def parameters(cls) -> tuple[ModeParameter, ...]:
        """Return its own parameters, in their order; not the time, which every mode has."""
        hints = get_type_hints(cls, include_extras=True)
        fields = [field for field in msgspec.structs.fields(cls) if field.name != "seconds"]
        return tuple(_parameter(field, hints[field.name]) for field in fields)


class Mode(Described, frozen=True):
    """A behavior of one robot that drives by itself.

    Attributes:
        finishes: Whether it comes to an end by itself, so that the end of its time is a failure.
        goes_to_place: Whether `x`, `y` and `heading` are a place, which the page gives in its map.
    """

    finishes: ClassVar[bool] = False
    goes_to_place: ClassVar[bool] = False

    def stack(self, limits: "Limits") -> "Stack":
        """Return a fresh stack that does this, no faster than `limits`."""
        raise NotImplementedError


def _parameter(field: msgspec.structs.FieldInfo, hint: Any) -> ModeParameter:
    notes = list(_annotations(hint))
    metas = [note for note in notes if isinstance(note, Meta)]
    lows = [meta.ge for meta in metas if meta.ge is not None]
    highs = [meta.le for meta in metas if meta.le is not None]
    return ModeParameter(
        name=field.name,
        title=next((meta.title for meta in metas if meta.title), field.name.capitalize()),
        help=next((meta.description for meta in metas if meta.description), ""),
        required=field.required,
        default=None if field.required else field.default,
        quantity=next((note for note in notes if isinstance(note, Quantity)), None),
        low=max(lows, default=None),
        high=min(highs, default=None),
        positive=any(meta.gt == 0 for meta in metas),
        choices=next((note.choices for note in notes if isinstance(note, Choices)), ()),
    )


def _annotations(hint: Any) -> list[Any]:
    """Return the annotations of a type and of its parts, the outermost first."""
    if get_origin(hint) is Annotated:
        inner, *notes = get_args(hint)
        return [*reversed(notes), *_annotations(inner)]
    return [note for part in get_args(hint) for note in _annotations(part)]
