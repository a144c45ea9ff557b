"""Whatever events come, in whatever pieces: nothing drives without a fresh press of the deadman."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.teleop.evdev import (
    AXES,
    BUTTONS,
    EV_ABS,
    EV_KEY,
    EV_SYN,
    EVENT,
    SYN_DROPPED,
    SYN_REPORT,
    Decoder,
    Range,
)
from pioneer3.teleop.gamepad import SCHEME, Gamepad

Event = tuple[int, int, int]
CODE = {number: code for code, number in BUTTONS.items()}
DEADMAN = CODE[SCHEME.deadman]
RANGES = {0: Range(-32768, 32767), 1: Range(0, 255)}

buttons = st.tuples(
    st.just(EV_KEY), st.sampled_from([*BUTTONS, 0x133, 0x110]), st.sampled_from([0, 1, 2])
)
axes = st.tuples(st.just(EV_ABS), st.sampled_from([*AXES, 2, 16]), st.integers(-(2**31), 2**31 - 1))
syncs = st.tuples(st.just(EV_SYN), st.sampled_from([SYN_REPORT, SYN_DROPPED]), st.just(0))
events = st.lists(st.one_of(buttons, axes, syncs, st.tuples(st.just(4), st.just(4), st.just(9))))


def packed(told: list[Event]) -> bytes:
    """Return events as the kernel writes them."""
    return b"".join(EVENT.pack(7, 9, *event) for event in told)


def new() -> Decoder:
    return Decoder(Gamepad(), RANGES)


@given(events)
def test_speeds_stay_within_the_scheme(told: list[Event]) -> None:
    decoder = new()
    for event in told:
        decoder.feed(packed([event]))
        assert abs(decoder.gamepad.wanted.v) <= SCHEME.turbo_speed
        assert abs(decoder.gamepad.wanted.w) <= SCHEME.turbo_turn_rate


@given(events, st.lists(st.integers(0, 2000)))
def test_any_pieces_mean_the_same(told: list[Event], cuts: list[int]) -> None:
    data = packed(told)
    whole, parts = new(), new()
    whole.feed(data)
    ends = sorted({0, len(data), *(min(cut, len(data)) for cut in cuts)})
    for start, end in pairwise(ends):
        parts.feed(data[start:end])
    assert parts.gamepad == whole.gamepad
    assert parts.pressed == whole.pressed


@given(events)
def test_the_deadman_counts_only_since_it_was_pressed_afresh(told: list[Event]) -> None:
    """Against a plain reading of the events, one after the other."""
    decoder = new()
    decoder.feed(packed(told))
    down = held = lost = False
    for kind, code, value in told:
        if (kind, code) == (EV_SYN, SYN_DROPPED):
            held, lost = False, True
        elif lost:
            lost = (kind, code) != (EV_SYN, SYN_REPORT)
        elif (kind, code) == (EV_KEY, DEADMAN):
            held = (held or not down) if value else False
            down = bool(value)
    assert decoder.gamepad.held == held
    if not held:
        assert decoder.gamepad.wanted.is_zero


@given(st.integers(-(2**31), 2**31 - 1), st.integers(-40000, 40000), st.integers(-40000, 40000))
def test_an_axis_is_never_further_out_than_all_the_way(value: int, low: int, high: int) -> None:
    assert -1.0 <= Range(low, high).part(value) <= 1.0
    assert Range(low, low).part(value) == 0.0
