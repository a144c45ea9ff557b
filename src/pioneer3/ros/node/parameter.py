"""A parameter of a node as one row: reader, declaration, docs and errors come from it.

Parameters are the fields of a dataclass. Name, type and default are those of the field; a
:class:`Parameter` makes it and has all the rest.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from difflib import get_close_matches
from enum import StrEnum
from math import inf, isfinite
from typing import Any, Final, TypeVar, get_args, get_type_hints

from pioneer3.errors import ConfigError
from pioneer3.ros.node.names import Profile

T = TypeVar("T")
ROS1: Final = frozenset(Profile) - {Profile.ROS2}
P2OS: Final = frozenset({Profile.P2OS})
ROS2: Final = frozenset({Profile.ROS2})
Scalar = bool | int | float | str
Value = Scalar | tuple[bool, ...] | tuple[int, ...] | tuple[float, ...] | tuple[str, ...]
READ_AT_START: Final = (
    "it is read when the node starts: set it with --ros-args -p, or in a parameter file"
)
ROW: Final = "parameter"
"""Key of a field's metadata."""
RawParameters = Mapping[str, object]
"""Parameters as somebody has written them below the node's name: anything may be there."""


class ParameterKind(StrEnum):
    """Kinds of values; the names are those of ROS 2."""

    BOOL = "bool"
    INTEGER = "integer"
    DOUBLE = "double"
    STRING = "string"
    BOOLS = "bool_array"
    INTEGERS = "integer_array"
    DOUBLES = "double_array"
    STRINGS = "string_array"

    @property
    def is_array(self) -> bool:
        """Whether a value has any number of parts."""
        return self.endswith("_array")

    @property
    def part(self) -> "ParameterKind":
        """The kind of each part of a value."""
        return ParameterKind(self.removesuffix("_array"))


TYPES: Final[Mapping[ParameterKind, type[Scalar]]] = {
    ParameterKind.BOOL: bool,
    ParameterKind.INTEGER: int,
    ParameterKind.DOUBLE: float,
    ParameterKind.STRING: str,
}
"""Types of values, and of parts of arrays."""
NOUNS: Final = {
    ParameterKind.BOOL: ("true or false", "booleans"),
    ParameterKind.INTEGER: ("a whole number", "whole numbers"),
    ParameterKind.DOUBLE: ("a number", "numbers"),
    ParameterKind.STRING: ("text", "names"),
}
"""Words for one value of a kind, and for several."""


class Effect(StrEnum):
    """Where a parameter acts."""

    AT_START = "when the node starts"
    AT_ONCE = "at once"
    ON_PORT = "where the laser is looked for"
    ON_SCANS = "on the scans of the first laser"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a node; name and kind are those of its field.

    Attributes:
        name: Today's, in ROS 1 without `~`. Its name in RosAria is `rosaria`, and `p2os` in p2os,
            which is read in that profile only, and told in the others. Its `aliases` in drivers of
            lasers are read, too.
        default: Its value unless given; `None` where the robot, the model or a search tells.
        otherwise: The default in words, where it is not `default`.
        low: Least number, also in an array; so is `high` the greatest.
        choices: All texts that it may be, if they can be listed.
        pattern: Regular expression of its texts, and `form` words for it.
        acts: Where it acts; only what acts at once can be set while the node runs.
        rosaria_default: Its default in RosAria, where another; of a whole number it stands for the
            robot's own.
    """

    meaning: str
    _: KW_ONLY
    name: str = ""
    kind: ParameterKind = ParameterKind.STRING
    default: Value | None = None
    otherwise: str = ""
    low: float = -inf
    high: float = inf
    unit: str = ""
    choices: tuple[str, ...] = ()
    pattern: str = ""
    form: str = ""
    profiles: frozenset[Profile] = ROS1 | ROS2
    acts: Effect = Effect.AT_START
    rosaria: str = ""
    rosaria_default: float | None = None
    aliases: tuple[str, ...] = ()
    p2os: str = ""

    def field(self, default: T) -> T:
        """Return the field of a dataclass that is this parameter."""
        row = replace(self, default=default)  # type: ignore[arg-type]
        return field(default=default, metadata={ROW: row})

    def names(self, profile: Profile) -> tuple[str, ...]:
        """Return the names that are read in `profile`; the first one that is given counts."""
        if profile not in self.profiles:
            return ()
        several = [self.p2os] if profile is Profile.P2OS else []
        if self.acts is Effect.AT_ONCE:
            several += [self.rosaria, self.name]
        elif self.rosaria and profile is Profile.COMPATIBILITY:
            several += [self.rosaria]
        else:
            several += [self.name, *self.aliases]
        return tuple(name for name in dict.fromkeys(several) if name)

    @property
    def today(self) -> str:
        """Its name; empty where today's packages have no such parameter."""
        return "" if self.name == self.rosaria else self.name

    @property
    def in_rosaria(self) -> "Parameter":
        """This parameter with the name, the default and the bounds that RosAria has."""
        default, low = self.rosaria_default, self.low
        if default is None:
            return replace(self, name=self.rosaria)
        return replace(self, name=self.rosaria, default=default, low=min(low, default))

    @property
    def bounded(self) -> bool:
        """Whether its numbers have bounds."""
        return isfinite(self.low) and isfinite(self.high)

    @property
    def whole(self) -> bool:
        """Whether it is a whole number."""
        return self.kind is ParameterKind.INTEGER

    @property
    def described(self) -> str:
        """The meaning, after the unit."""
        return f"[{self.unit}] {self.meaning}" if self.unit else self.meaning

    @property
    def range(self) -> str:
        """The bounds in words; empty for none."""
        return f"{self.low:.7g} to {self.high:.7g} {self.unit}".rstrip() if self.bounded else ""

    @property
    def constraints(self) -> str:
        """All that bounds its values besides a range of numbers, in words."""
        limits = (
            " or ".join(self.choices),
            f"not set means {self.otherwise}" if self.default is None and self.otherwise else "",
            "" if self.acts is Effect.AT_ONCE else READ_AT_START,
        )
        return "; ".join(filter(None, limits))

    @property
    def wanted(self) -> str:
        """Words for the values that it may have."""
        if self.choices:
            return " or ".join(self.choices)
        one, several = NOUNS[self.kind.part]
        if self.kind.is_array:
            count = f"{len(self.default)} " if isinstance(self.default, tuple) else ""
            one = f"a list of {count}{several}"
        return self.form or (f"{one} from {self.range}" if self.bounded else one)

    def checked(self, value: object, name: str = "") -> Value:
        """Return `value` in the type of this parameter; a whole number may stand for a double.

        Raises:
            ConfigError: it is of another kind, or out of bounds; the message has the name that it
                was written by, the value and the values that are wanted.
        """
        parts = value if isinstance(value, list | tuple) else (value,)
        size = len(self.default) if isinstance(self.default, tuple) else len(parts)
        is_array = isinstance(value, list | tuple)
        fits = is_array is self.kind.is_array and len(parts) == size
        if not fits or not all(map(self._fits, parts)):
            raise ConfigError(f"{name or self.name} must be {self.wanted}, not {value!r}")
        native: Any = tuple(TYPES[self.kind.part](each) for each in parts)
        return native if is_array else native[0]  # type: ignore[no-any-return]

    def _fits(self, value: object) -> bool:
        """Return whether `value` is a value of this parameter, or a part of one."""
        match value:
            case bool():
                return self.kind.part is ParameterKind.BOOL
            case str() if self.kind.part is ParameterKind.STRING:
                fits = not self.pattern or re.fullmatch(self.pattern, value) is not None
                return fits and (not self.choices or value in self.choices)
            case int() if self.kind.part is ParameterKind.INTEGER:
                return self.low <= value <= self.high
            case int() | float() if self.kind.part is ParameterKind.DOUBLE:
                return self.low <= value <= self.high and isfinite(value)
        return False


@dataclass(frozen=True, slots=True)
class Foreign:
    """A parameter of another node that has no effect here.

    In the words `instead` a name such as `~port` is one of ours, in ROS 2 without `~`.
    """

    node: str
    instead: str = ""

    def told(self, name: str, profile: Profile, below: str = "") -> str:
        """Return the sentence about it, of which `name` is the name, `below` another."""
        instead = re.sub(r"~(\w+)", lambda our: full_name(our[1], profile, below), self.instead)
        sentence = f"parameter {full_name(name, profile, below)} of {self.node} has no effect here"
        return f"{sentence}: {instead}" if instead else sentence


def rows_of(described: type) -> tuple[Parameter, ...]:
    """Return the parameters that are fields of a dataclass, in their order."""
    hints = get_type_hints(described)
    return tuple(
        replace(each.metadata[ROW], name=each.name, kind=_kind(hints[each.name]))
        for each in fields(described)
        if ROW in each.metadata
    )


def _kind(hint: Any) -> ParameterKind:
    """Return the kind of a parameter by the type of its field, which may be optional."""
    arguments = [each for each in get_args(hint) if each is not type(None)]
    if Ellipsis in arguments:
        return ParameterKind(f"{_kind(arguments[0])}_array")
    if arguments:
        return _kind(arguments[0])
    return next(kind for kind, type_ in TYPES.items() if issubclass(hint, type_))


def full_name(name: str, profile: Profile, below: str = "") -> str:
    """Return the name of a parameter `below` another name, as its ROS writes it."""
    if profile is Profile.ROS2:
        return f"{below}.{name}" if below else name
    return f"~{below}/{name}" if below else f"~{name}"


def read(described: type[T], raw: RawParameters, profile: Profile, below: str = "") -> T:
    """Return the dataclass of values in `raw`, `below` a name; ConfigError for wrong ones."""
    values: dict[str, object] = {}
    for row in rows_of(described):
        name = next((each for each in row.names(profile) if each in raw), None)
        if name is not None:
            form = row.in_rosaria if name == row.rosaria else row
            values[row.name] = form.checked(raw[name], full_name(name, profile, below))
    return described(**values)


def unused(
    raw: Collection[str],
    rows: Collection[Parameter],
    profile: Profile,
    *,
    below: str = "",
    foreign: Mapping[str, Foreign],
) -> list[str]:
    """Return a sentence for each name in `raw`, which lies `below` another, that is none of `rows`.

    Those of other nodes are `foreign`.
    """
    known = {name for row in rows for name in row.names(profile)}
    of_p2os = {
        row.p2os: Foreign("p2os", f"write ~{row.names(profile)[0]}") for row in rows if row.p2os
    }
    sentences = []
    for name in sorted(set(raw) - known):
        other = foreign.get(name) or of_p2os.get(name)
        if other is not None:
            sentences.append(other.told(name, profile, below))
            continue
        close = get_close_matches(name, known, 1)
        hint = f"; did you mean {full_name(close[0], profile, below)}?" if close else ""
        sentences.append(f"parameter {full_name(name, profile, below)} is unknown{hint}")
    return sentences
