"""Attachments whose fields have names, as Jazzy had them before rmw_zenoh_cpp 0.2.4."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.ros.zenoh.keys import Attachment, parse_attachment

NUMBERS = st.integers(-(2**63), 2**63 - 1)
PACKED = (
    "0f73657175656e63655f6e756d6265720100000000000000"
    "10736f757263655f74696d657374616d700200000000000000"
    "0a736f757263655f67696410000102030405060708090a0b0c0d0e0f"
)


@given(NUMBERS, NUMBERS, st.binary(min_size=16, max_size=16))
def test_a_named_attachment_reads_as_it_was_written(sequence: int, stamp: int, gid: bytes) -> None:
    attachment = Attachment(sequence, stamp, gid, named=True)
    assert parse_attachment(attachment.pack()) == attachment


def test_a_named_attachment_is_as_zenoh_serializes_it() -> None:
    attachment = Attachment(1, 2, bytes(range(16)), named=True)
    assert attachment.pack().hex() == PACKED
    assert len(attachment.pack()) == 77


@pytest.mark.parametrize("position", [1, 25, 50, 60])
def test_other_names_are_refused(position: int) -> None:
    data = bytearray(bytes.fromhex(PACKED))
    data[position] ^= 1
    with pytest.raises(ValueError, match="attachment"):
        parse_attachment(bytes(data))
