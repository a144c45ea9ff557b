"""Files that would cost much to read: refused, or read at little cost."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.maps import read_map
from pioneer3.maps.aria import BLOCK, MOST_ENTRIES, MOST_LINES, MOST_SECTIONS, parse_aria
from pioneer3.maps.image import MOST_SLOW_PIXELS, to_png
from pioneer3.maps.map_server import LARGEST_YAML
from pioneer3.models import load_model
from pioneer3.sim.map_check import MOST_ERRORS, check_aria
from pioneer3.sim.worldfile import load_map

HEAD = "2D-Map\n"


def written(folder: Path, name: str, content: str) -> Path:
    path = folder / name
    path.write_text(content)
    return path


LONG_KEYS = [
    "a" + ".a" * 50_000 + " = 1\n",
    "[a" + " . 'a'" * 20_000 + "]\n",
    'x = 1\n"a"' + '\t."b"' * 16 + " = 1\n",
]


@pytest.mark.parametrize("text", LONG_KEYS, ids=["bare", "heading", "quoted"])
def test_a_key_of_many_parts_is_refused_before_it_takes_memory(tmp_path: Path, text: str) -> None:
    path = written(tmp_path, "a.toml", text)
    for read in (load_map, load_model):
        tracemalloc.start()
        with pytest.raises(ConfigError, match="a key of more than 16 parts"):
            read(path)
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()


def test_dots_in_numbers_and_texts_make_no_key(tmp_path: Path) -> None:
    points = ", ".join(f"[{n}.5, {n}.25]" for n in range(100))
    text = f'[world]\nname = "v1.2 ... and on"\n[[wall]]\npoints = [{points}]\n'
    assert len(load_map(written(tmp_path, "a.toml", text)).walls) == 99


def test_what_is_nested_too_deeply_is_refused(tmp_path: Path) -> None:
    for text in ("a=" + "[" * 500_000, "a=" + "{a=" * 200_000):
        with pytest.raises(ConfigError, match="nested too deeply"):
            load_map(written(tmp_path, "a.toml", text))


REFUSED = {
    "entries": (HEAD + "a: b\n" * (MOST_ENTRIES + 1), "more than 50000 entries"),
    "cairns": (HEAD + 'Cairn: Goal 1 2 3 "" ICON "x"\n' * (MOST_ENTRIES + 1), "50000 entries"),
    "headings": (HEAD + "DATA\n" * (MOST_SECTIONS + 1), "100 headings"),
    "lines": (HEAD + "DATA\n" + "\n" * MOST_LINES, "more than 2 million lines"),
    "one long line": (HEAD + "DATA\n" + "1 " * BLOCK * 2, "3: DATA: expected numbers x y"),
}


@pytest.mark.parametrize(("text", "says"), REFUSED.values(), ids=REFUSED)
def test_a_map_of_more_than_maps_have_is_refused(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(ConfigError, match=says) as caught:
        read_map(written(tmp_path, "a.map", text))
    assert len(str(caught.value)) < 250


def test_of_many_errors_the_first_are_told(tmp_path: Path) -> None:
    text = HEAD + "DATA\n" + "1 2 3\n" * (MOST_ERRORS + 10)
    assert 0 < len(list(check_aria(tmp_path / "a.map", text))) < 100


def test_pictures_and_their_descriptions_have_limits(tmp_path: Path) -> None:
    text = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"
    yaml = written(tmp_path, "m.yaml", text)
    picture = tmp_path / "m.pgm"
    for kind in (b"P2 4096 4096 255\n", b"P5 4096 4096 100\n"):
        picture.write_bytes(kind + b"0 " * (MOST_SLOW_PIXELS // 2))
        with pytest.raises(ConfigError, match="more than 4 million pixels in this kind of PGM"):
            read_map(yaml)
    colours = np.zeros((5000, 5000, 3), dtype=np.uint8)
    picture.write_bytes(to_png(colours))
    with pytest.raises(ConfigError, match="more than 64 MB unpacked"):
        read_map(yaml)
    yaml.write_text(text + "#" * LARGEST_YAML)
    with pytest.raises(ConfigError, match="larger than 64 KB"):
        read_map(yaml)


def test_comments_in_a_text_picture_cost_little(tmp_path: Path) -> None:
    yaml = written(tmp_path, "m.yaml", "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    (tmp_path / "m.pgm").write_bytes(b"P2 2 1 255\n" + b"#\n" * 2_000_000 + b"0 255\n")
    assert len(read_map(yaml).walls) == 4


NESTED = ["[" * 30_000, "{a: " * 15_000, "- " * 30_000, "? " * 30_000]


@pytest.mark.parametrize("value", NESTED, ids=["lists", "tables", "items", "keys"])
def test_yaml_that_is_nested_too_deeply_is_refused(tmp_path: Path, value: str) -> None:
    with pytest.raises(ConfigError, match="not valid YAML"):
        read_map(written(tmp_path, "m.yaml", f"image: m.pgm\na:\n  {value}\n"))


def test_aliases_of_yaml_are_not_unfolded(tmp_path: Path) -> None:
    text = "image: none.pgm\nresolution: 0.05\norigin: [0, 0, 0]\na0: &a0 [1, 2]\n"
    for n in range(40):
        text += f"a{n + 1}: &a{n + 1} [*a{n}, *a{n}, *a{n}, *a{n}]\n"
    path = written(tmp_path, "m.yaml", text)
    for _ in range(2):  # the first time imports the parser
        tracemalloc.start()
        with pytest.raises(ConfigError, match="no such file"):
            read_map(path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 20_000_000  # most of it to read any file


def rows_one_by_one(text: str) -> tuple[list[list[float]], list[int]]:
    """Return rows and their lines as they are read where nothing is quick."""
    rows = [(n, line.split()) for n, line in enumerate(text.split("\n"), 1)]
    there = [(n, words) for n, words in rows[2:] if words and words[0][0] not in "#;"]
    return [[float(word) for word in words] for _, words in there], [n for n, _ in there]


def test_blocks_give_the_rows_and_lines_that_single_lines_give(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    lines = [f"{x} {y}" for x, y in rng.integers(-9999, 9999, (BLOCK // 4, 2)).tolist()]
    for at in rng.integers(0, len(lines), 300).tolist():
        lines[at] = ["", "# 1 2", "  ; 3", "\t7.5   -8e1  ", "+1 .5"][at % 5]
    text = HEAD + "DATA\n" + "\n".join(lines)
    (section,) = parse_aria(tmp_path / "a.map", text).sections
    rows, numbers = rows_one_by_one(text)
    assert section.rows.tolist() == rows
    assert section.at.tolist() == numbers


@pytest.mark.parametrize("bad", ["1", "1 2 3", "1 x", "nan 1", "1e9 0", "1 2 # 3"])
@pytest.mark.parametrize("before", [0, BLOCK // 4])
def test_a_wrong_row_is_named_with_its_line(tmp_path: Path, bad: str, before: int) -> None:
    text = HEAD + "DATA\n" + "1 2\n" * before + f"{bad}\n" + "3 4\n" * 10
    with pytest.raises(ConfigError, match=rf"a\.map:{before + 3}: DATA: "):
        read_map(written(tmp_path, "a.map", text))


def test_points_take_little_memory(tmp_path: Path) -> None:
    side = np.arange(25_000) * 20
    points = np.concatenate([np.stack([side, side * 0 + 100 * n], axis=1) for n in range(4)])
    text = HEAD + "DATA\n" + "".join(f"{x} {y}\n" for x, y in points.tolist())
    path = written(tmp_path, "a.map", text)
    read_map(path)
    tracemalloc.start()
    walls = read_map(path).walls
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(walls) == 4 * 4
    assert peak < 200 * len(points)  # so 200 MB for a million
