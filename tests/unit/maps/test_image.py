"""PNG pictures of every colour type, depth and filter; damaged ones are refused."""

import tracemalloc
import zlib
from io import BytesIO
from pathlib import Path
from struct import pack

import numpy as np
import pytest
from PIL import Image

from pioneer3.errors import ConfigError
from pioneer3.maps.image import PNG_SIGNATURE, parse_image, to_png

HERE = Path("m.png")
SIZES = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}


def chunk(name: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + name + data + pack(">I", zlib.crc32(name + data))


def png(
    header: tuple[int, int, int, int], rows: bytes, *, palette: bytes = b"", interlace: int = 0
) -> bytes:
    parts = [chunk(b"IHDR", pack(">IIBBBBB", *header, 0, 0, interlace))]
    parts += [chunk(b"PLTE", palette)] if palette else []
    half = len(packed := zlib.compress(rows)) // 2
    parts += [chunk(b"IDAT", packed[:half]), chunk(b"IDAT", packed[half:]), chunk(b"IEND", b"")]
    return PNG_SIGNATURE + b"".join(parts)


def filtered(rows: list[bytes], kinds: list[int], step: int) -> bytes:
    """Apply filters as the standard words them, byte by byte."""
    out, above = b"", bytes(len(rows[0]))
    for row, kind in zip(rows, kinds, strict=True):
        coded = bytearray([kind])
        for at, value in enumerate(row):
            a, c = (row[at - step], above[at - step]) if at >= step else (0, 0)
            b = above[at]
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            coded.append((value - (0, a, b, (a + b) // 2, nearest)[kind]) % 256)
        out, above = out + bytes(coded), row
    return out


@pytest.mark.parametrize("colour", [0, 2, 4, 6])
@pytest.mark.parametrize("kinds", [[0] * 5, [1] * 5, [2] * 5, [3] * 5, [4] * 5, [4, 1, 3, 2, 0]])
def test_all_filters_of_all_colours_are_undone(colour: int, kinds: list[int]) -> None:
    step = SIZES[colour]
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, step)).astype(np.uint8)
    rows = filtered([row.tobytes() for row in pixels], kinds, step)
    image = parse_image(HERE, png((7, 5, 8, colour), rows))
    colours = pixels[:, :, : 1 if colour in (0, 4) else 3]
    np.testing.assert_allclose(image.shades, colours.mean(axis=2), atol=0.5)
    if colour in (4, 6):
        assert image.alpha is not None
        np.testing.assert_array_equal(image.alpha, pixels[:, :, -1])
    else:
        assert image.alpha is None


@pytest.mark.parametrize(
    ("depth", "row", "shades"),
    [
        (1, [0b10100000], [255, 0, 255]),
        (2, [0b00011000], [0, 85, 170]),
        (4, [0x0F, 0x10], [0, 255, 17]),
        (16, [0, 9, 255, 9, 128, 9], [0, 255, 128]),
    ],
)
def test_other_depths_of_gray_are_scaled(depth: int, row: list[int], shades: list[int]) -> None:
    image = parse_image(HERE, png((3, 1, depth, 0), bytes([0, *row])))
    assert image.shades.tolist() == [shades]


def test_a_palette_gives_colours() -> None:
    palette = bytes([0, 0, 0, 255, 255, 255, 30, 60, 90])
    image = parse_image(HERE, png((4, 1, 2, 3), bytes([0, 0b00011000]), palette=palette))
    assert image.shades.tolist() == [[0, 255, 60, 0]]


def test_what_we_write_we_read() -> None:
    pixels = np.random.default_rng(2).integers(0, 256, (4, 6, 3)).astype(np.uint8)
    image = parse_image(HERE, to_png(pixels))
    np.testing.assert_allclose(image.shades, pixels.mean(axis=2), atol=0.5)


GRAY = png((2, 2, 8, 0), bytes(6))


DAMAGED = "picture: damaged or cut off: "


@pytest.mark.parametrize(
    ("raw", "complaint"),
    [
        (PNG_SIGNATURE, DAMAGED),
        (GRAY[:-12], DAMAGED),
        (GRAY[:-20] + b"x" + GRAY[-19:], DAMAGED),
        (PNG_SIGNATURE + chunk(b"IEND", b""), DAMAGED),
        (png((2, 2, 8, 5), bytes(6)), DAMAGED),
        (png((2, 2, 3, 0), bytes(6)), DAMAGED),
        (png((100000, 100000, 8, 0), b""), "size: 100000 x 100000 pixels are more than"),
        (png((5000, 5000, 8, 2), b""), "size: more than 64 MB unpacked; save it with 8 bit grey"),
        (png((0, 2, 8, 0), b""), DAMAGED),
        (png((2, 2, 8, 0), bytes(5)), DAMAGED),
        (png((2, 2, 8, 0), b"\x05\0\0\0\0\0"), DAMAGED),
        (
            PNG_SIGNATURE
            + chunk(b"IHDR", pack(">IIBBBBB", 2, 2, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", b"junk")
            + chunk(b"IEND", b""),
            DAMAGED,
        ),
    ],
)
def test_what_is_wrong_with_a_picture(raw: bytes, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_image(HERE, raw)
    assert complaint in str(caught.value)
    assert str(caught.value).isprintable()


def test_a_bomb_unpacks_no_further_than_the_size_it_claims() -> None:
    # 100 MB of zeros behind a picture of 2 x 2
    bomb = png((2, 2, 8, 0), bytes(100_000_000))
    assert len(bomb) < 120_000
    assert parse_image(HERE, bomb).shades.shape == (2, 2)


def test_what_is_unpacked_of_texts_in_a_picture_is_little() -> None:
    text = chunk(b"zTXt", b"Comment\0\0" + zlib.compress(bytes(100_000_000)))
    raw = PNG_SIGNATURE + GRAY[8:33] + text + GRAY[33:]
    parse_image(HERE, GRAY)
    tracemalloc.start()
    with pytest.raises(ConfigError, match=DAMAGED):
        parse_image(HERE, raw)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10_000_000


def test_a_picture_with_an_odd_animation_is_read_without_a_warning() -> None:
    raw = PNG_SIGNATURE + GRAY[8:33] + chunk(b"acTL", bytes(8)) + GRAY[33:]
    assert parse_image(HERE, raw).shades.shape == (2, 2)


def test_an_interlaced_picture_is_read() -> None:
    # one pixel of the first of the seven passes
    image = parse_image(HERE, png((1, 1, 8, 0), bytes([0, 200]), interlace=1))
    assert image.shades.tolist() == [[200]]


@pytest.mark.parametrize("kind", [np.float32, np.int32])
def test_a_picture_of_32_bit_for_each_pixel_is_named(kind: type[np.generic]) -> None:
    file = BytesIO()
    Image.fromarray(np.ones((2, 2), dtype=kind)).save(file, "TIFF")
    with pytest.raises(ConfigError, match="32 bit for each pixel; save it with 8 bit grey"):
        parse_image(HERE, file.getvalue())


def test_a_palette_takes_no_memory_for_three_colours_of_each_pixel() -> None:
    raw = png((2000, 2000, 8, 3), bytes(2001 * 2000), palette=bytes([30, 60, 90]))
    tracemalloc.start()
    image = parse_image(HERE, raw)
    assert tracemalloc.get_traced_memory()[1] < 3 * image.shades.size
    tracemalloc.stop()
    assert image.shades[0, 0] == 60


def test_three_colours_as_text_count_as_three_pixels() -> None:
    with pytest.raises(ConfigError, match="more than 4 million pixels"):
        parse_image(HERE, b"P3 1200 1200 255 ")


@pytest.mark.parametrize(
    ("head", "complaint"),
    [
        (b"\xff\xd8\xff" + b"\xff" * (8 << 20), "size: a JPEG of more than 8 MB"),
        (b"P5" + b"\n" * 100_000 + b"1 1 255 \0", "header: it does not tell the size"),
        (b"P6\n" + b"#\n" * 50_000 + b"1 1 255 \0\0\0", "header: it does not tell the size"),
    ],
)
def test_what_stands_before_a_picture_is_short(head: bytes, complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        parse_image(Path("m.jpg"), head)
