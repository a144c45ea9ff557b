"""Whatever a map file holds: a finite map or one line that says why not."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.maps import read_map
from pioneer3.maps.grid import outline
from tests.combinations import examples

HEADERS = st.sampled_from(["2D-Map\n", "2D-Map-Ex\n", "2D-Map-Ex2\r\n"])
WORDS = st.one_of(
    st.floats(width=32).map(str),
    st.integers(-10000, 10000).map(str),
    st.text(max_size=6),
    st.sampled_from(['""', "ICON", '"a b"', '"', "nan", "1e400", "Goal", "Sim.BoxObstacle"]),
)
STARTS = st.sampled_from(
    ["", "LINES", "DATA", "a_LINES", "Cairn:", "MapInfo:", "Resolution:", "Cairn: Goal 1 2 3", "#"]
)
ROWS = st.lists(st.builds(lambda a, w: " ".join([a, *w]), STARTS, st.lists(WORDS, max_size=8)))
TEXTS = st.builds(lambda head, rows: head + "\n".join(rows), HEADERS, ROWS)


def check(content: bytes) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "m.map"
        path.write_bytes(content)
        complaint, walls = f"{path}:", np.empty(0)
        try:
            walls = read_map(path).walls
        except ConfigError as error:
            complaint = str(error)
    assert complaint.startswith(f"{path}:")
    assert complaint.isprintable()
    assert np.isfinite(walls).all()


@given(st.binary())
def test_any_bytes_give_a_map_or_one_line(content: bytes) -> None:
    check(b"2D-Map\nLINES\n" + content)
    check(content)


@given(TEXTS)
@settings(max_examples=examples(200))
def test_nearly_right_text_gives_a_map_or_one_line(text: str) -> None:
    check(text.encode("utf-8", "surrogatepass"))


CELLS = st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1)


@given(CELLS)
def test_the_outline_is_every_edge_between_occupied_and_free_once(
    cells: set[tuple[int, int]],
) -> None:
    walls = outline(np.array(sorted(cells), dtype=float), 1.0)
    # unit edges, by twice their middle, so that all numbers are whole
    drawn = [
        (round(2 * x0) + dx, round(2 * y0) + dy)
        for x0, y0, x1, y1 in walls
        for dx, dy in (
            [(k, 0) for k in range(1, round(2 * (x1 - x0)), 2)]
            or [(0, k) for k in range(1, round(2 * (y1 - y0)), 2)]
        )
    ]
    expected = [
        (2 * x + dx, 2 * y + dy)
        for x, y in cells
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))
        if (x + dx, y + dy) not in cells
    ]
    assert sorted(drawn) == sorted(set(expected)) == sorted(expected)


@given(CELLS)
def test_no_two_walls_on_one_line_touch(cells: set[tuple[int, int]]) -> None:
    walls = outline(np.array(sorted(cells), dtype=float), 1.0)
    level = walls[walls[:, 1] == walls[:, 3]]
    starts = {(x0, y0) for x0, y0, _, _ in level}
    ends = {(x1, y1) for _, _, x1, y1 in level}
    assert not starts & ends
