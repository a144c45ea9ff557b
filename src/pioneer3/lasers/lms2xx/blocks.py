"""The two blocks of settings that a unit sends: configuration and status (lms2xx.md 1.7, 1.12).

The annotation of a field says where in the block it stands, and as which `struct` format.
"""

from dataclasses import dataclass, fields
from functools import cache
from struct import Struct
from typing import Annotated, Final, Self, TypeVar, get_type_hints

from pioneer3.lasers.lms2xx.commands import OperatingMode
from pioneer3.lasers.lms2xx.measuring import MEASURING_MODES, Units, Variant

T = TypeVar("T")
REAL_TIME_INDICES: Final = 0x02
"""Bit of :attr:`UnitConfig.availability`: scans end with two indices."""
PARTIAL_SIZES: Final = frozenset({7, 8, 32})
"""Sizes of configurations that hosts write beside the whole one (lms2xx.md 1.7)."""


class At:
    """Place of a field in its block."""

    def __init__(self, offset: int, form: str) -> None:
        self.offset = offset
        self.struct = Struct(f"<{form}")
        self.end = offset + self.struct.size


def _u8(offset: int) -> At:
    return At(offset, "B")


def _u16(offset: int) -> At:
    return At(offset, "H")


def _places(cls: type) -> tuple[tuple[str, At], ...]:
    return _compiled(cls)


@cache
def _compiled(cls: type) -> tuple[tuple[str, At], ...]:
    hints = get_type_hints(cls, include_extras=True)
    return tuple((field.name, hints[field.name].__metadata__[0]) for field in fields(cls))


def _unpack(cls: type[T], data: bytes) -> T:
    """Return the block in `data`; fields behind its end keep their defaults."""
    values = {
        name: place.struct.unpack_from(data, place.offset)[0]
        for name, place in _places(cls)
        if place.end <= len(data)
    }
    return cls(**values)


def _pack(block: object, size: int) -> bytes:
    data = bytearray(size)
    for name, place in _places(type(block)):
        if place.end <= size:
            place.struct.pack_into(data, place.offset, getattr(block, name))
    return bytes(data)


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitConfig:
    """The configuration, which the unit keeps in its EEPROM; as delivered, unless told.

    Fields overlook objects nearer than `blanking_cm`. `stop_threshold` is of the LMS-200 [mV], 0 in
    an LMS-291; `sensitivity` its peak threshold, or the LMS-291's sensitivity. Bits of
    `availability`: 1 fog, 2 indices in scans, 4 dazzling does not switch outputs. `measuring_mode`
    is a key of :data:`MEASURING_MODES`. The `rest` is kept as it is: evaluations, restarts and
    contours of fields. Older units have no `dazzle_evaluations`.
    """

    SIZE = 34
    OLDER_SIZE = 32

    blanking_cm: Annotated[int, _u16(0)] = 0
    stop_threshold: Annotated[int, _u8(2)] = 70
    sensitivity: Annotated[int, _u8(3)] = 0
    availability: Annotated[int, _u8(4)] = 0
    measuring_mode: Annotated[int, _u8(5)] = 0
    units: Annotated[int, _u8(6)] = Units.CENTIMETRES
    rest: Annotated[bytes, At(7, "25s")] = bytes((0, 0, 2, 2)) + bytes(21)
    dazzle_evaluations: Annotated[int, _u16(32)] = 0

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Return the configuration in 34 or, from older units, 32 bytes; else ValueError."""
        if len(data) not in {cls.SIZE, cls.OLDER_SIZE}:
            raise ValueError(f"a configuration has 34 or 32 bytes, not {len(data)}")
        return _unpack(cls, data)

    def to_bytes(self, size: int = SIZE) -> bytes:
        """Return the block of `size` bytes."""
        return _pack(self, size)

    def overwritten(self, data: bytes) -> "UnitConfig | None":
        """Return this configuration with its first bytes replaced by `data`.

        `None` if the size is unusual or a unit cannot measure so.
        """
        if len(data) not in PARTIAL_SIZES | {self.SIZE}:
            return None
        changed = self.from_bytes(data + self.to_bytes()[len(data) :])
        mode = MEASURING_MODES.get(changed.measuring_mode)
        metric = changed.units in {Units.CENTIMETRES, Units.MILLIMETRES}
        return changed if mode is not None and mode.codes and metric else None


SPEED_CODES: Final = {9600: 0x8067, 19200: 0x8033, 38400: 0x8019, 500000: 0x8001}
"""Speeds [baud] as the status names them."""
_SPEED_OF_CODE: Final = {code: baud for baud, code in SPEED_CODES.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitStatus:
    """The answer to STATUS, as far as it is of use. Offsets count from the code of the answer.

    `version` is that of the unit's program, padded to seven letters; `defective` is not 0 if the
    unit is. `revolutions` are as the unit counts them; `measuring_mode` is a key of
    :data:`MEASURING_MODES`, `speed_code` a value of :data:`SPEED_CODES`; `keeps_speed`: it is that
    after power-on, too.
    """

    SIZE = 152
    """Bytes between code and status byte."""

    version: Annotated[bytes, At(1, "7s")]
    mode: Annotated[int, _u8(8)] = OperatingMode.ON_REQUEST
    defective: Annotated[int, _u8(9)] = 0
    revolutions: Annotated[int, _u16(67)] = 0
    measuring_mode: Annotated[int, _u8(102)]
    field_deg: Annotated[int, _u16(107)]
    step_cdeg: Annotated[int, _u16(109)]
    speed_code: Annotated[int, _u16(116)]
    keeps_speed: Annotated[int, _u8(119)] = 0
    address: Annotated[int, _u8(120)] = 0
    units: Annotated[int, _u8(122)]

    @property
    def variant(self) -> Variant:
        """The field that the unit scans."""
        return Variant(self.field_deg, self.step_cdeg)

    @property
    def speed(self) -> int | None:
        """Speed of the unit's line [baud], or `None` for an unknown code."""
        return _SPEED_OF_CODE.get(self.speed_code)

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Return the status in `data`, which begin behind the code; ValueError for another size."""
        if len(data) != cls.SIZE:
            raise ValueError(f"a status has 152 bytes, not {len(data)}")
        return _unpack(cls, b"\0" + data)

    def to_bytes(self) -> bytes:
        """Return the block without the code; all that is not known here is 0."""
        return _pack(self, 1 + self.SIZE)[1:]
