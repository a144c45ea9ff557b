"""The forms of modes, as data for the page: made from the modes' descriptions."""

import msgspec

from pioneer3.behaviors.modes import MODES
from pioneer3.behaviors.modes.group import GROUP_MODES
from pioneer3.behaviors.modes.mode import Described, Mode, Parameter


class FormChoice(msgspec.Struct):
    """A word to choose."""

    name: str
    title: str
    hint: str


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
    choices: list[FormChoice]


class ModeForm(msgspec.Struct, kw_only=True):
    """A mode; `goes_to_place` where x, y and heading are a place, which pages give in their map."""

    name: str
    title: str
    summary: str
    advice: str
    start: str
    goes_to_place: bool
    fields: list[FormField]


class GroupModeForm(msgspec.Struct, kw_only=True):
    """A mode of several robots; `led` where one of them is the leader."""

    name: str
    title: str
    summary: str
    advice: str
    start: str
    led: bool
    fields: list[FormField]


def group_forms() -> list[GroupModeForm]:
    """Return the forms of all modes of groups, in their order."""
    return [
        GroupModeForm(
            name=mode.name(),
            title=mode.title,
            summary=mode.summary(),
            advice=mode.advice(),
            start=mode.start,
            led=mode.led,
            fields=_fields(mode),
        )
        for mode in GROUP_MODES
    ]


def forms() -> list[ModeForm]:
    """Return the forms of all modes, in their order."""
    return [_form(mode) for mode in MODES]


def _form(mode: type[Mode]) -> ModeForm:
    return ModeForm(
        name=mode.name(),
        title=mode.title,
        summary=mode.summary(),
        advice=mode.advice(),
        start=mode.start,
        goes_to_place=mode.goes_to_place,
        fields=_fields(mode),
    )


def _fields(mode: type[Described]) -> list[FormField]:
    return [_field(parameter) for parameter in mode.parameters()]


def _field(parameter: Parameter) -> FormField:
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
        choices=[FormChoice(one.name, one.title, one.hint) for one in parameter.choices],
    )
