"""`pioneer3 sonar`: the numbers of the lab's p3_sonar."""

from io import StringIO
from math import inf, nan

from rich.console import Console

from pioneer3.cli.sonar import _view, hull_distances, line
from pioneer3.demo.drawing import ring
from tests.unit.cli.test_monitor import MODEL, ROBOT, WORST


def test_a_distance_counts_from_the_centre_less_the_body() -> None:
    ranges = (inf, inf, inf, 1.0, nan, inf, inf, 1.0)
    distances = hull_distances(MODEL, (*ranges, *(1.0,) * 8))
    # number 3 at (0.245, 0.027) looks to 10 degrees: 1 m on is (1.230, 0.201), 1.246 m away
    # number 7 at (0.147, -0.136) looks to the right: 1 m on is (0.147, -1.136), 1.145 m away
    assert distances == [None, None, None, 1246 - 240, None, None, None, 1145 - 160]


def test_a_line_has_a_column_for_each_front_sonar() -> None:
    assert line([1, None, 4999]) == "     1     -  4999"


def test_the_screen_fits_80_columns_and_24_rows() -> None:
    console = Console(file=StringIO(), width=80, height=24, record=True, highlight=False)
    picture = ring(MODEL, WORST.sonar.ranges, 80, 19)
    console.print(_view(ROBOT, WORST, picture))
    lines = console.export_text().splitlines()
    assert len(lines) == 23
    assert lines[-3].split() == ["sonar", *map(str, range(8))]
    assert lines[-2].split()[0] == "mm"
    assert all(len(text) <= 80 for text in lines)
