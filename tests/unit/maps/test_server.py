"""Maps of ROS's map_server: YAML and picture become the outline of the occupied cells."""

from io import BytesIO
from math import pi
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap, read_map

YAML = "image: m.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 0.0]\n"
# one occupied pixel, the upper left of 3 x 2; all else free
PGM = b"P5\n3 2\n255\n" + bytes([0, 254, 254, 254, 254, 254])


def read(folder: Path, yaml: str = YAML, image: bytes = PGM, name: str = "m.pgm") -> LineMap:
    (folder / name).write_bytes(image)
    path = folder / "lab.yaml"
    path.write_text(yaml)
    return read_map(path)


def test_a_black_pixel_is_four_walls_and_row_0_is_the_top(tmp_path: Path) -> None:
    lab = read(tmp_path)
    assert lab.name == "lab"
    assert len(lab.walls) == 4
    assert lab.bounds == pytest.approx((1.0, 2.5, 1.5, 3.0))


def test_the_origin_turns_the_picture_about_its_lower_left_corner(tmp_path: Path) -> None:
    lab = read(tmp_path, YAML.replace("0.0]", f"{pi / 2}]"))
    # (x, y) of the picture becomes (-y, x)
    assert lab.bounds == pytest.approx((0.0, 2.0, 0.5, 2.5))


@pytest.mark.parametrize(
    ("shade", "more", "walls"),
    [
        (89, "", 4),  # (255 - 89) / 255 = 0.651
        (90, "", 0),  # 0.647
        (205, "", 0),
        (165, "negate: 1", 0),  # 0.647
        (166, "negate: 1", 4),
        (89, "negate: false\nmode: scale", 4),
        (120, "occupied_thresh: 0.5\nfree_thresh: 0.25", 4),
        (100, "mode: raw", 4),
        (60, "mode: raw", 0),
        (101, "mode: raw", 0),
    ],
)
def test_what_counts_as_occupied(tmp_path: Path, shade: int, more: str, walls: int) -> None:
    around = 0 if "negate: 1" in more or "raw" in more else 255
    image = b"P5 3 3 255\n" + bytes([around] * 4 + [shade] + [around] * 4)
    assert len(read(tmp_path, f"{YAML}{more}\n", image).walls) == walls


@pytest.mark.parametrize(
    "image",
    [
        b"P2\n# by hand\n3 2\n255\n0 254 254\n254 254 254\n",
        b"P2 3 2 1 0 1 1 1 # last\n1 1",
        b"P5\n# map_saver 0.05 m/pix\n3 2\n255\n" + PGM[-6:],
        b"P5 3 2 65535\n" + b"\0\0" + b"\xff\xff" * 5,
    ],
)
def test_every_kind_of_pgm_is_read(tmp_path: Path, image: bytes) -> None:
    assert read(tmp_path, image=image).bounds == pytest.approx((1.0, 2.5, 1.5, 3.0))


@pytest.mark.parametrize(
    "yaml",
    [
        "---\n# saved\nresolution: 5e-1 # m\nimage: 'm.pgm'\norigin: [1, 2.,\n  0]\nn: {a: 1}\n",
        'origin:\n- 1.0\n- 2.0\n- 0.0\nimage: "m.pgm"\nresolution: .5\ncells:\n- a: 1\n- 2\n',
        YAML.replace("\n", "\r\n") + "free_thresh: 0.2\nlatitude: 42.8\n",
    ],
)
def test_the_ways_people_write_yaml(tmp_path: Path, yaml: str) -> None:
    assert read(tmp_path, yaml).bounds == pytest.approx((1.0, 2.5, 1.5, 3.0))


def test_content_counts_where_the_ending_says_nothing(tmp_path: Path) -> None:
    (tmp_path / "m.pgm").write_bytes(PGM)
    (tmp_path / "lab").write_text(YAML)
    (tmp_path / "aria.yaml").write_text("2D-Map\nLINES\n0 0 1000 0\n")
    assert len(read_map(tmp_path / "lab").walls) == 4
    assert len(read_map(tmp_path / "aria.yaml").walls) == 1


def test_a_bare_picture_asks_for_its_yaml(tmp_path: Path) -> None:
    read(tmp_path)
    with pytest.raises(ConfigError, match=r"m\.pgm: is a picture; give the YAML"):
        read_map(tmp_path / "m.pgm")


@pytest.mark.parametrize(
    ("yaml", "complaint"),
    [
        ("", "image: missing"),
        ("image: m.pgm\nresolution: 1\n", "origin: missing"),
        (YAML + "image: n.pgm\n", "4: image: is on line 1 too"),
        (YAML.replace("0.5", "0"), "2: resolution: '0' is not in 0.001 to 10"),
        (YAML.replace("0.5", "nan"), "2: resolution: 'nan' is not a number"),
        (YAML.replace("0.5", "1_0"), "2: resolution: '1_0' is not a number"),
        (YAML.replace("1.0, 2.0,", "1.0,"), "3: origin: expected a list of 3 numbers"),
        (YAML.replace("1.0, 2.0", "1.0, 1e9"), "3: origin: '1e9' is not in -100000 to 100000"),
        (YAML.replace("m.pgm", "n.pgm"), "1: image: no such file: 'n.pgm'"),
        (YAML.replace("m.pgm", ""), "1: image: has no value"),
        (YAML + "negate: 2\n", "4: negate: expected 0 or 1, not '2'"),
        (YAML + "mode: gray\n", "4: mode: expected trinary, scale, raw, not 'gray'"),
        (YAML + "occupied_thresh: 65\n", "4: occupied_thresh: '65' is not in 0 to 1"),
        (YAML + "free_thresh: 0.7\n", "4: free_thresh: 0.7 is above occupied_thresh, 0.65"),
        (YAML + "hello\n", "5: not valid YAML: could not find expected ':'"),
        ("hello\n", "1: line: expected 'key: value'"),
        (YAML + "k: \0\n", "not valid YAML: unacceptable character #x0000"),
        (YAML + 'k: "\\UFFFFFFFF"\n', "not valid YAML: "),
        (YAML + "k: *a\n", "4: not valid YAML: found undefined alias"),
        (YAML + "--- \nk: 1\n", "4: not valid YAML: but found another document"),
    ],
)
def test_what_is_wrong_with_the_yaml(tmp_path: Path, yaml: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(tmp_path, yaml)
    assert str(caught.value).startswith(f"{tmp_path / 'lab.yaml'}:")
    assert complaint in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("image", "complaint"),
    [
        (b"", "header: no picture; PGM, PNG"),
        (b"P5\n3\n", "header: it does not tell the size"),
        (b"P5 100000 100000 255\n", "size: 100000 x 100000 pixels are more than"),
        (b"P2 100000 100000 255\n", "size: 100000 x 100000 pixels are more than"),
        (b"P5 0 3 255\n", "picture: damaged or cut off: "),
        (b"P5 3 2 0\n" + PGM[-6:], "maxval must be greater than 0 and less than 65536"),
        (PGM[:-1], "picture: damaged or cut off: image file is truncated"),
        (b"P2 2 1 255\n0 x", "picture: damaged or cut off: "),
        (b"P2 2 1 255\n0 256", "Channel value too large for this mode: 256"),
        (b"P2 2 1 255\n0 99999999999999999999", "Token too long"),
        (b"P2 2 1 255\n0", "picture: damaged or cut off: not enough image data"),
    ],
)
def test_what_is_wrong_with_the_picture(tmp_path: Path, image: bytes, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(tmp_path, image=image)
    assert str(caught.value).startswith(f"{tmp_path / 'm.pgm'}:")
    assert complaint in str(caught.value)
    assert str(caught.value).isprintable()


def test_noise_is_no_map(tmp_path: Path) -> None:
    dots = np.full((1500, 1500), 255, dtype=np.uint8)
    dots[::2, ::2] = 0
    image = b"P5 1500 1500 255\n" + dots.tobytes()
    with pytest.raises(ConfigError, match="more than 1 million edges"):
        read(tmp_path, image=image)


@pytest.mark.parametrize("kind", ["BMP", "JPEG", "TIFF", "PPM", "GIF", "PNG"])
@pytest.mark.parametrize("mode", ["L", "RGB", "1"])
def test_every_picture_that_map_server_reads_is_read(tmp_path: Path, kind: str, mode: str) -> None:
    shades = np.full((8, 16), 254, dtype=np.uint8)
    shades[:, 8:] = 0
    picture = Image.fromarray(shades).convert(mode if kind != "JPEG" or mode != "1" else "L")
    file = BytesIO()
    picture.save(file, kind)
    lab = read(tmp_path, YAML, file.getvalue())
    assert lab.bounds == pytest.approx((5.0, 2.0, 9.0, 6.0))
    with pytest.raises(ConfigError, match=r"m\.pgm.*: (damaged|header|size|no )"):
        read(tmp_path, YAML, file.getvalue()[: len(file.getvalue()) // 2])


@pytest.mark.parametrize("named", ["/home/anna/m.pgm", "C:\\\\maps\\\\m.pgm", "../other/m.pgm"])
def test_a_picture_of_another_computer_is_taken_from_beside_the_file(
    tmp_path: Path, named: str, caplog: pytest.LogCaptureFixture
) -> None:
    lab = read(tmp_path, YAML.replace("m.pgm", f'"{named}"'))
    assert len(lab.walls) == 4
    assert "m.pgm beside the file is taken" in caplog.text
