"""The forms of modes, as data for the page: made from the modes' descriptions."""

import msgspec

from pioneer3.behaviors.modes import MODES
from pioneer3.behaviors.modes.group import GROUP_MODES
from pioneer3.behaviors.modes.mode import Choice, Described, ModeParameter


class FormField(msgspec.Struct, kw_only=True):
    """A parameter: a number in `unit`, `scale` of which are one in SI, or one of the choices."""

    name: str
    title: str
    help: str
    required: bool
    default: float | str | None
    unit: str
    scale: float
    low: float | None
    high: float | None
    choices: tuple[Choice, ...]


class ModeForm(msgspec.Struct, kw_only=True):
    """A mode; `goes_to_place` where x, y and heading are a place, which pages give in their map.

    Of a mode of several robots `led` says whether one of them is the leader.
    """

    name: str
    title: str
    summary: str
    advice: str
    start: str
    goes_to_place: bool
    led: bool
    fields: list[FormField]


def group_forms() -> list[ModeForm]:
    """Return the forms of all modes of groups, in their order."""
    return [_form(mode, goes_to_place=False, led=mode.led) for mode in GROUP_MODES]


def forms() -> list[ModeForm]:
    """Return the forms of all modes, in their order."""
    return [_form(mode, goes_to_place=mode.goes_to_place, led=False) for mode in MODES]


def _form(mode: type[Described], *, goes_to_place: bool, led: bool) -> ModeForm:
    return ModeForm(
        name=mode.name(),
        title=mode.title,
        summary=mode.summary(),
        advice=mode.advice(),
        start=mode.start,
        goes_to_place=goes_to_place,
        led=led,
        fields=[_field(parameter) for parameter in mode.parameters()],
    )


def _field(parameter: ModeParameter) -> FormField:
    quantity = parameter.quantity
    scale = quantity.units[quantity.bare] if quantity else 1.0

    def shown(value: float | None) -> float | None:
        return None if value is None else round(value / scale, 6)

    default = parameter.default
    return FormField(
        name=parameter.name,
        title=parameter.title,
        help=parameter.help,
        required=parameter.required,
        default=default if isinstance(default, str) else shown(default),
        unit=quantity.bare if quantity else "",
        scale=scale,
        low=0.0 if parameter.positive else shown(parameter.low),
        high=shown(parameter.high),
        choices=parameter.choices,
    )
