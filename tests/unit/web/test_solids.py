"""Solids of a world as pages are told of them."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pioneer3.geometry import ORIGIN
from pioneer3.sim.relief import Relief
from pioneer3.sim.relief.solids import HeightField
from pioneer3.web.solids import MOST_ROWS, solids_of


@pytest.mark.parametrize(
    ("columns", "rows"), [(500, 5), (5, 500), (2, 2), (100, 101), (500, 2), (150, 40)]
)
def test_a_height_field_keeps_its_ends_and_its_rows_however_narrow(
    columns: int, rows: int, tmp_path: Path
) -> None:
    slope = np.add.outer(np.linspace(0, 100, rows), np.linspace(0, 155, columns))
    Image.fromarray(slope.astype(np.uint8)[::-1]).save(tmp_path / "slope.png")
    field = HeightField(file=tmp_path / "slope.png", pose=ORIGIN, size=(5.0, 2.0), height=1.0)
    (solid,) = solids_of(Relief(solids={"slope": field}))
    (shape,) = solid.shapes
    heights = np.array(shape.numbers).reshape(-1, shape.columns or 0)
    assert heights.shape == (min(rows, MOST_ROWS), min(columns, MOST_ROWS))
    assert heights[0, 0] == 0.0
    assert heights[-1, -1] == 1.0
    assert heights[0, -1] == pytest.approx(155 / 255, abs=0.001)
    assert heights[-1, 0] == pytest.approx(100 / 255, abs=0.001)
    assert (np.diff(heights, axis=0) >= 0).all()
    assert (np.diff(heights, axis=1) >= 0).all()
