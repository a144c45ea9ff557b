"""The bytes of ACTS 1.2, as ARIA and Player read them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.acts import CHANNELS, HEADER_SIZE, Blob, PictureReader, encode

BLOB = Blob(area=1000, x=80, y=60, left=70, right=90, top=50, bottom=75)
# six bits a byte, plus one: 1000 = 15 * 64 + 40, 80 = 1 * 64 + 16, 70 = 1 * 64 + 6 and so on
ON_THE_WIRE = bytes([1, 1, 16, 41, 2, 17, 1, 61, 2, 7, 2, 27, 1, 51, 2, 12])

numbers = st.integers(0, 4095)
blobs = st.builds(
    Blob,
    area=st.integers(0, 64**4 - 1),
    x=numbers,
    y=numbers,
    left=numbers,
    right=numbers,
    top=numbers,
    bottom=numbers,
)


def test_one_blob_in_channel_two() -> None:
    data = encode({2: [BLOB]})
    # channel 1 has none, channel 2 begins at 0 with 1, all others would begin at 1
    assert data[:HEADER_SIZE] == bytes([1, 1, 1, 1, 1, 1, 1, 2]) + bytes([1, 2, 1, 1]) * 30
    assert data[HEADER_SIZE:] == ON_THE_WIRE
    (picture,) = PictureReader().feed(data)
    assert picture.channel(2) == (BLOB,)
    assert [n for n in range(1, CHANNELS + 1) if picture.channel(n)] == [2]


def test_the_largest_ten_are_shown_the_largest_first() -> None:
    many = [Blob(area=a, x=1, y=1, left=1, right=1, top=1, bottom=1) for a in range(12)]
    (picture,) = PictureReader().feed(encode({32: many}))
    assert [blob.area for blob in picture.channel(32)] == list(range(11, 1, -1))


@given(st.dictionaries(st.integers(1, 32), st.lists(blobs, max_size=3)), st.integers(1, 400))
def test_any_pictures_in_any_pieces_come_back(seen: dict[int, list[Blob]], size: int) -> None:
    data, reader, pictures = encode(seen) * 2, PictureReader(), []
    for at in range(0, len(data), size):
        pictures += reader.feed(data[at : at + size])
    assert len(pictures) == 2
    for picture in pictures:
        for channel in range(1, CHANNELS + 1):
            expected = sorted(seen.get(channel, []), key=lambda blob: -blob.area)
            assert list(picture.channel(channel)) == expected


@pytest.mark.parametrize(
    "data",
    [
        bytes(HEADER_SIZE),
        b"\xff" * HEADER_SIZE,
        bytes([64]) * HEADER_SIZE,
        bytes([1, 9, 1, 2]) + bytes([1, 1, 1, 1]) * 31 + ON_THE_WIRE,
    ],
)
def test_what_is_not_acts_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match=r"byte|longer|not there"):
        PictureReader().feed(data)
