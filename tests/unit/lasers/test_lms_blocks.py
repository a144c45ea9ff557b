"""Values, scans, configuration and status of the LMS-2xx (lms2xx.md 1.7 to 1.9, 1.12)."""

from dataclasses import replace
from math import inf, isnan, nan, radians

import pytest

from pioneer3.lasers.client import ScanSettings
from pioneer3.lasers.lms2xx.blocks import UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.measuring import (
    MEASURING_MODES,
    VARIANTS,
    MeasuringMode,
    Units,
    Variant,
)
from pioneer3.lasers.lms2xx.scans import (
    MEAN_SUBRANGE_VALUES,
    MEAN_VALUES,
    SUBRANGE_VALUES,
    VALUES,
    Measurement,
)
from pioneer3.lasers.lms2xx.setup import wanted_variant

MM, CM = Units.MILLIMETRES, Units.CENTIMETRES
CODES = {
    13: (8191, 8190, 8189, 8187, 8186, 8183),
    14: (16383, 16382, 16381, 16379, 16378, 16375),
    15: (32767, 32766, 32765, 32763, 32762, 32759),
}
RANGED = [mode for mode in MEASURING_MODES.values() if mode.codes]
STATUS = UnitStatus(
    version=b"V02.30 ",
    mode=0x24,
    measuring_mode=5,
    field_deg=180,
    step_cdeg=50,
    speed_code=0x8019,
    units=1,
)


@pytest.mark.parametrize("mode", RANGED)
def test_the_highest_distances_are_codes(mode: MeasuringMode) -> None:
    *invalid, beyond = CODES[mode.bits]
    assert all(isnan(metres) for metres in mode.ranges(invalid, MM))
    assert mode.ranges([beyond, beyond - 1, 0], MM) == (inf, (beyond - 1) * 0.001, 0.0)


@pytest.mark.parametrize(
    ("number", "far_mm", "far_cm"),
    [(0, 8.182, 81.82), (1, 8.182, 81.82), (3, 16.374, 163.74), (5, 32.758, 327.58)],
)
def test_the_farthest_distance(number: int, far_mm: float, far_cm: float) -> None:
    assert MEASURING_MODES[number].far(MM) == pytest.approx(far_mm)
    assert MEASURING_MODES[number].far(CM) == pytest.approx(far_cm)


def test_flags_and_reflectivity_are_no_distance() -> None:
    for mode in RANGED:
        flags = 0xFFFF & ~mode.mask
        assert mode.ranges([1000 | flags], MM) == (1.0,)
    assert MEASURING_MODES[1].reflectivities([7 << 13 | 5, 1 << 13, 8000]) == (7, 1, 0)
    assert MEASURING_MODES[3].reflectivities([3 << 14 | 5, 8000]) == (3, 0)
    assert MEASURING_MODES[5].reflectivities([1 << 15 | 5, 32000]) == (1, 0)
    assert MEASURING_MODES[0].reflectivities([0xFFFF]) == ()


def test_immediate_values_have_no_codes() -> None:
    assert MEASURING_MODES[0x0F].ranges([65535, 32767, 8183], MM) == (65.535, 32.767, 8.183)


def test_readings_become_values() -> None:
    mode = MEASURING_MODES[3]
    values = mode.values([1.0, inf, nan, 0.0, 99.0], [0.5, 0.0, 0.0, 2.0, 90.0], MM)
    assert values == [1000, 16375, 16383, 1 | 1 << 14, 16375 | 3 << 14]
    assert MEASURING_MODES[0].values([1.234, 81.9], [9.0, 9.0], CM) == [123, 8183]


@pytest.mark.parametrize(
    ("variant", "count", "turns"),
    [*zip(VARIANTS, (181, 361, 101, 201, 401), (1, 2, 1, 2, 4), strict=True)],
)
def test_variants_have_their_readings(variant: Variant, count: int, turns: int) -> None:
    assert (variant.count, variant.turns) == (count, turns)
    assert variant.first + (count - 1) * variant.step == pytest.approx(-variant.first)
    assert 2 * count + 10 in (372, 732, 212, 412, 812)


@pytest.mark.parametrize(
    ("first", "last", "step", "variant"),
    [
        (None, None, None, (180, 100)),
        (None, None, 0.5, (180, 50)),
        (None, None, 0.25, (180, 50)),
        (-90, 90, 1.0, (180, 100)),
        (-50, 50, 0.25, (100, 25)),
        (-30, 40, 0.3, (100, 25)),
        (-51, 50, 0.5, (180, 50)),
        (-20, 20, 5.0, (100, 100)),
    ],
)
def test_the_nearest_variant_is_wanted(
    first: float | None, last: float | None, step: float | None, variant: tuple[int, int]
) -> None:
    settings = ScanSettings(
        first=None if first is None else radians(first),
        last=None if last is None else radians(last),
        step=None if step is None else radians(step),
    )
    assert wanted_variant(settings) == Variant(*variant)


def scan(values: int, **more: int | bool) -> bytes:
    telegram = Measurement(code=VALUES, values=(0,) * values, units=MM)
    return replace(telegram, **more).to_body()[:2]  # type: ignore[arg-type]


def test_headers_are_as_published() -> None:
    assert [scan(count) for count in (181, 361, 401)] == [
        b"\xb5\x40",
        b"\x69\x41",
        b"\x91\x41",
    ]
    assert Measurement(code=VALUES, values=(0,) * 181, units=CM).to_body()[:2] == b"\xb5\x00"
    assert scan(181, partial=True) == b"\xb5\x60"
    assert scan(180, partial=True, offset_cdeg=25) == b"\xb4\x68"
    assert scan(180, partial=True, offset_cdeg=50) == b"\xb4\x70"
    assert scan(180, partial=True, offset_cdeg=75) == b"\xb4\x78"


def test_the_published_scan() -> None:
    body = bytes.fromhex("03 40 E8 03 E9 03 FF 1F")
    telegram = Measurement.from_body(VALUES, body)
    assert (telegram.values, telegram.units, telegram.partial) == ((1000, 1001, 8191), MM, False)
    assert telegram.to_body() == body


@pytest.mark.parametrize(
    ("telegram", "body"),
    [
        (
            Measurement(code=SUBRANGE_VALUES, values=(7, 8), units=MM, first=2, last=3),
            "02 00 03 00 02 40 07 00 08 00",
        ),
        (Measurement(code=MEAN_VALUES, values=(7,), units=CM, sample=10), "0A 01 00 07 00"),
        (
            Measurement(
                code=MEAN_SUBRANGE_VALUES, values=(7,), units=CM, sample=3, first=5, last=5
            ),
            "03 05 00 05 00 01 00 07 00",
        ),
        (
            Measurement(code=VALUES, values=(7,), units=MM, indices=b"\x11\x22"),
            "01 40 07 00 11 22",
        ),
    ],
)
def test_other_telegrams_of_measurements(telegram: Measurement, body: str) -> None:
    assert telegram.to_body() == bytes.fromhex(body)
    assert Measurement.from_body(telegram.code, bytes.fromhex(body)) == telegram


@pytest.mark.parametrize(
    ("code", "body"),
    [
        (VALUES, "02 40 07 00"),
        (VALUES, "01 40 07 00 01 02 03"),
        (VALUES, "01 C0 07 00"),
        (VALUES, "01"),
        (SUBRANGE_VALUES, "01 00 01 00"),
        (0xB1, "00 40"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(code: int, body: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        Measurement.from_body(code, bytes.fromhex(body))


def test_a_configuration_is_34_bytes_or_32() -> None:
    block = bytes(range(1, 35))
    config = UnitConfig.from_bytes(block)
    assert config.to_bytes() == block
    assert (config.blanking_cm, config.stop_threshold, config.sensitivity) == (0x0201, 3, 4)
    assert (config.availability, config.measuring_mode, config.units) == (5, 6, 7)
    assert config.rest == bytes(range(8, 33))
    assert config.dazzle_evaluations == 0x2221
    older = UnitConfig.from_bytes(block[:32])
    assert older == replace(config, dazzle_evaluations=0)
    assert older.to_bytes(32) == block[:32]
    with pytest.raises(ValueError, match="34 or 32 bytes, not 33"):
        UnitConfig.from_bytes(block[:33])


@pytest.mark.parametrize("size", [7, 8, 32, 34])
def test_the_first_bytes_of_a_configuration_can_be_written(size: int) -> None:
    before = UnitConfig(rest=bytes(range(25)), dazzle_evaluations=7)
    block = replace(before, measuring_mode=5, units=MM, stop_threshold=70).to_bytes()
    after = before.overwritten(block[:size])
    assert after == UnitConfig.from_bytes(block)


@pytest.mark.parametrize("block", [b"", bytes(6), bytes(33), bytes(35)])
def test_other_sizes_cannot(block: bytes) -> None:
    assert UnitConfig().overwritten(block) is None


@pytest.mark.parametrize(("mode", "units"), [(0x07, 1), (0x0F, 1), (0x3F, 1), (0x05, 2)])
def test_impossible_settings_cannot(mode: int, units: int) -> None:
    assert UnitConfig().overwritten(bytes((0, 0, 70, 0, 0, mode, units))) is None


def test_the_status_has_its_fields_at_their_offsets() -> None:
    block = b"\xb1" + STATUS.to_bytes()
    assert len(block) == 153
    assert block[1:8] == b"V02.30 "
    assert (block[8], block[102], block[122]) == (0x24, 5, 1)
    assert block[107:111] == bytes.fromhex("B4 00 32 00")
    assert block[116:118] == bytes.fromhex("19 80")
    assert UnitStatus.from_bytes(block[1:]) == STATUS
    assert (STATUS.variant, STATUS.speed) == (Variant(180, 50), 38400)
    assert replace(STATUS, speed_code=1).speed is None
    with pytest.raises(ValueError, match="152 bytes, not 146"):
        UnitStatus.from_bytes(block[1:147])
