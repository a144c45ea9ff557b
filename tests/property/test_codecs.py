"""Whatever bytes come in, nothing raises and nothing is lost; what goes out comes back."""

from enum import IntFlag

from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import fields

from pioneer3.arcos import commands, lists, reports, wire
from pioneer3.arcos.commands.arguments import Argument, Bits, Latin1, Prefixed, String
from pioneer3.arcos.layout import layout
from pioneer3.arcos.reports.codec import EXACT
from tests.combinations import examples

LATIN1 = st.characters(max_codepoint=255)
SHORT = 8
REPORTS = [cls for cls in reports.ALL if cls is not reports.Sip]  # whose layout is by hand


def values(kind: wire.WireKind) -> st.SearchStrategy[object]:  # noqa: PLR0911
    """Return values of `kind` that lie on the wire's grid."""
    match kind:
        case wire.Integer() | Argument() | Bits():
            return st.integers(kind.low, kind.high)
        case wire.PacketId(choices):
            return st.sampled_from(choices)
        case wire.Scaled(inner, unit):
            return st.integers(inner.low, inner.high).map(unit.to_si)
        case wire.Enumerated(inner, choices):
            known = st.sampled_from(list(choices))
            bits = st.integers(inner.low, inner.high)
            return bits.map(choices) if issubclass(choices, IntFlag) else known
        case wire.Switch():
            return st.booleans()
        case wire.NulTerminated():
            return st.text(st.characters(min_codepoint=1, max_codepoint=255), max_size=SHORT)
        case Latin1() | lists.CountedText():
            return st.text(LATIN1, max_size=SHORT)
        case wire.AllThatIsLeft():
            return st.binary(max_size=SHORT)
        case String(inner) | Prefixed(inner):
            return values(inner)
        case _:
            return several(kind)


def several(kind: wire.WireKind) -> st.SearchStrategy[object]:
    """Return values of a kind that holds several values."""
    match kind:
        case lists.Record(cls):
            return messages(cls)
        case lists.CountedStructs(cls):
            return tuples(messages(cls))
        case lists.SizedRecords(cls):
            return tuples(messages(cls, extra=False))
        case lists.Repeated(item, length) if length is not None:
            return st.tuples(*[values(item)] * length)
        case lists.Repeated(item) | lists.Counted(_, item):
            return tuples(values(item))
    raise AssertionError(kind)


def tuples(items: st.SearchStrategy[object]) -> st.SearchStrategy[tuple[object, ...]]:
    return st.lists(items, max_size=SHORT).map(tuple)


@st.composite
def messages(draw: st.DrawFn, cls: type, *, extra: bool = True) -> object:
    """Return a `cls` that ends anywhere it may; `extra` bytes only where nothing is missing."""
    slots = layout(cls)
    ends = [index for index, slot in enumerate(slots) if slot.optional and slot.name != "extra"]
    end = draw(st.sampled_from([*ends, len(slots)]))
    chosen = slots if extra and end == len(slots) else [s for s in slots[:end] if s.name != "extra"]
    return cls(**{slot.name: draw(values(slot.kind)) for slot in chosen})


def test_every_field_of_every_message_can_be_generated() -> None:
    for cls in (*commands.every_command(), *REPORTS):
        for slot in layout(cls):
            assert isinstance(values(slot.kind), st.SearchStrategy)


@given(st.sampled_from(commands.every_command()).flatmap(messages))
@settings(max_examples=examples(600))
def test_every_command_comes_back(command: commands.Command) -> None:
    payload = commands.to_payload(command)
    is_old = commands.is_old(type(command))
    assert payload[0] == command.ID
    assert commands.from_payload(payload, simulator=is_old) == command


@given(st.binary(max_size=20), st.booleans())
@settings(max_examples=examples(300))
def test_no_bytes_make_reading_a_command_raise(payload: bytes, simulator: bool) -> None:
    command = commands.from_payload(payload, simulator=simulator)
    again = commands.to_payload(command)
    assert commands.from_payload(again, simulator=simulator) == command


COMMAND_LIKE = st.builds(
    lambda number, kind, rest: bytes([number, kind]) + rest,
    st.sampled_from([cls.ID for cls in commands.every_command()]),
    st.sampled_from([0x3B, 0x1B, 0x2B, 0x00]),
    st.binary(max_size=14),
)


@given(COMMAND_LIKE, st.booleans())
@settings(max_examples=examples(600))
def test_what_a_command_is_read_as_can_be_written(payload: bytes, simulator: bool) -> None:
    command = commands.from_payload(payload, simulator=simulator)
    again = commands.to_payload(command)
    assert commands.from_payload(again, simulator=simulator) == command
    if isinstance(command, commands.Unknown):
        assert again == payload


@given(st.sampled_from(REPORTS).flatmap(messages))
@settings(max_examples=examples(300))
def test_every_report_comes_back(report: reports.Report) -> None:
    assert reports.from_payload(reports.to_payload(report)) == report


@given(st.binary(max_size=60))
@settings(max_examples=examples(300))
def test_reading_a_report_loses_no_byte(payload: bytes) -> None:
    assert reports.to_payload(reports.from_payload(payload)) == payload


KNOWN_IDS = sorted({number for cls in reports.ALL for number in reports.numbers(cls)})


@given(st.sampled_from(KNOWN_IDS), st.binary(max_size=250))
@settings(max_examples=examples(600))
def test_reading_a_report_with_a_known_id_loses_no_byte(number: int, data: bytes) -> None:
    payload = bytes([number]) + data
    assert reports.to_payload(reports.from_payload(payload)) == payload
    assert reports.from_payload(payload) == reports.from_payload(payload)


@given(
    st.integers(0x30, 0x34),
    st.binary(min_size=18, max_size=18),
    st.lists(st.binary(min_size=3, max_size=3), max_size=40),
    st.binary(max_size=30),
)
def test_a_sip_of_any_length_loses_no_byte(
    number: int, head: bytes, sonar: list[bytes], tail: bytes
) -> None:
    payload = bytes([number]) + head + bytes([len(sonar)]) + b"".join(sonar) + tail
    sip = reports.from_payload(payload)
    assert isinstance(sip, reports.Sip)
    assert len(sip.sonar) == len(sonar)
    assert reports.to_payload(sip) == payload
    missing = [getattr(sip, field.name) is None for field in fields(sip)]
    assert missing[:-1] == sorted(missing[:-1])


@given(
    st.sampled_from([cls.ID for cls in EXACT]),
    st.sampled_from([b"", b"\0\0", b"a\0\xff\0"]),
    st.binary(max_size=250),
)
@settings(max_examples=examples(300))
def test_reports_that_are_not_written_again_lose_no_byte(
    number: int, texts: bytes, data: bytes
) -> None:
    payload = bytes([number]) + texts + data
    assert reports.to_payload(reports.from_payload(payload)) == payload
