"""Pictures to scale, in braille."""

from math import hypot, inf, nan, pi

import pytest

from pioneer3.demo.drawing import Canvas, Ink, ring
from pioneer3.models import load_model
from pioneer3.navigation.picture import reach_for

BLANK = 0x2800
ROBOT = load_model("p3at-sh")


def lines_of(canvas: Canvas) -> list[str]:
    return canvas.text().plain.split("\n")


def dots(canvas: Canvas, ink: Ink) -> set[tuple[float, float]]:
    """Return the middles [m] of the characters that are in `ink`."""
    found = set()
    plain, text = lines_of(canvas), canvas.text()
    for row, line in enumerate(plain):
        for column, letter in enumerate(line):
            at = row * (canvas.columns + 1) + column
            styles = [span.style for span in text.spans if span.start <= at < span.end]
            if letter != " " and styles == [ink.value]:
                x = (canvas.rows / 2 - row - 0.5) * 4 * canvas.scale
                y = (canvas.columns / 2 - column - 0.5) * 2 * canvas.scale
                found.add((x, y))
    return found


def test_a_dot_lies_where_it_should_up_is_forward_and_left_is_left() -> None:
    canvas = Canvas(3, 3, 1.0)  # 6 x 12 dots, of 2 m / 6 each
    canvas.point(1.9, 0.9, Ink.FAR)
    assert lines_of(canvas) == ["⠁  ", "   ", "   "]
    canvas.point(-1.9, -0.9, Ink.FAR)
    assert lines_of(canvas) == ["⠁  ", "   ", "  ⢀"]


def test_what_lies_outside_is_left_out() -> None:
    canvas = Canvas(4, 2, 1.0)
    for x, y in ((5.0, 0.0), (0.0, 5.0), (-5.0, 0.0), (0.0, -5.0)):
        canvas.point(x, y, Ink.FAR)
    assert lines_of(canvas) == ["    ", "    "]


@pytest.mark.parametrize(("columns", "rows", "reach"), [(0, 5, 1.0), (5, 0, 1.0), (5, 5, nan)])
def test_a_picture_without_room_is_refused(columns: int, rows: int, reach: float) -> None:
    with pytest.raises(ValueError, match="no picture"):
        Canvas(columns, rows, reach)


@pytest.mark.parametrize(("columns", "rows"), [(34, 17), (20, 10), (60, 12), (1, 1)])
def test_a_ring_fills_just_the_room_it_is_given(columns: int, rows: int) -> None:
    lines = lines_of(ring(ROBOT, [1.0] * 16, columns, rows))
    assert [len(line) for line in lines] == [columns] * rows


@pytest.mark.parametrize("number", range(16))
def test_each_echo_is_drawn_where_it_came_from(number: int) -> None:
    ranges = [inf] * 16
    ranges[number] = 2.0
    canvas = ring(ROBOT, ranges, 60, 30)
    mount = ROBOT.sonars[number]
    arc = dots(canvas, Ink.FAR)
    # a character is 2 x 4 dots: its middle is at most hypot(1, 2) dots from what it shows
    slack = hypot(1, 2) * canvas.scale + canvas.scale
    assert arc
    assert all(abs(hypot(x - mount.x, y - mount.y) - 2.0) <= slack for x, y in arc)


def test_near_echoes_are_red_and_far_ones_are_not() -> None:
    ranges = [inf] * 16
    ranges[0], ranges[7], ranges[11] = 0.4, 0.9, 2.0
    canvas = ring(ROBOT, ranges, 60, 30)
    assert all(y > 0 for _, y in dots(canvas, Ink.NEAR))  # sonar 0 looks left
    assert all(y < 0 for _, y in dots(canvas, Ink.CLOSE))  # sonar 7 looks right
    assert all(x < 0 for x, _ in dots(canvas, Ink.FAR))  # sonar 11 looks back
    for ink in (Ink.NEAR, Ink.CLOSE, Ink.FAR):
        assert dots(canvas, ink)


def test_the_robot_is_as_large_as_it_is() -> None:
    canvas = ring(ROBOT, [], 80, 40, reach=1.0)
    body = dots(canvas, Ink.BODY)
    width = max(y for _, y in body) - min(y for _, y in body)
    assert width == pytest.approx(ROBOT.width, abs=4 * canvas.scale)


def test_laser_points_and_the_trail_are_drawn() -> None:
    canvas = ring(ROBOT, [], 40, 20, laser=[(2.0, 1.0)], trail=[(-2.0, 0.5)])
    ((x, y),) = dots(canvas, Ink.LASER)
    assert x == pytest.approx(2.0, abs=0.25)
    assert y == pytest.approx(1.0, abs=0.25)
    ((x, _),) = dots(canvas, Ink.TRAIL)
    assert x == pytest.approx(-2.0, abs=0.25)


def test_sonars_that_heard_nothing_are_not_drawn() -> None:
    assert lines_of(ring(ROBOT, [nan, inf] * 8, 40, 20)) == lines_of(ring(ROBOT, [], 40, 20))


@pytest.mark.parametrize(
    ("ranges", "before", "reach"),
    [
        ([4.0, 4.5, 4.9], 5.0, 5.0),
        ([2.1, 2.2, 0.3], 5.0, 3.0),
        ([0.3, 0.4, 3.0], 5.0, 1.0),
        ([2.9, 2.9, 2.9], 5.0, 5.0),  # 2.9 is more than 80 % of 3
        ([2.9, 2.9, 2.9], 3.0, 3.0),  # but it stays
        ([3.1, 3.1, 3.1], 3.0, 5.0),
        ([inf, nan], 2.0, 2.0),
    ],
)
def test_the_reach_shows_half_of_the_echoes_and_keeps_still(
    ranges: list[float], before: float, reach: float
) -> None:
    assert reach_for(ranges, before) == reach


def test_an_arc_and_a_circle_keep_their_radius() -> None:
    canvas = Canvas(40, 20, 1.0)
    canvas.arc(0.0, 0.0, 0.8, Ink.GRID)
    canvas.arc(0.0, 0.0, 0.5, Ink.FAR, end=pi / 4)
    assert all(abs(hypot(x, y) - 0.8) < 0.1 for x, y in dots(canvas, Ink.GRID))
    assert all(x > 0 and y > -0.05 for x, y in dots(canvas, Ink.FAR))
