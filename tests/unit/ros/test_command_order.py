"""A robot that is commanded on two topics, in whatever order the messages arrive."""

from math import inf

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import STILL, Twist2
from pioneer3.ros.node.command_order import LATE, WAIT, NewestCommand

AHEAD, BACK = Twist2(0.1), Twist2(-0.1)
KEYS, OTHER = "/rob_key", "/somebody"


class Robot:
    """Obeys it, punctually."""

    def __init__(self) -> None:
        self.newest = NewestCommand()
        self.did: list[Twist2] = []

    def hear(self, now: float, twist: Twist2, *, shared: bool = False, sender: str = KEYS) -> None:
        self.until(now)
        self._do(self.newest.take(twist, now, sender=sender, shared=shared))

    def until(self, now: float) -> None:
        self._do(self.newest.due(now))

    def _do(self, wanted: Twist2 | None) -> None:
        if wanted is not None:
            self.did.append(wanted)


def test_a_command_on_its_own_topic_is_obeyed_at_once() -> None:
    robot = Robot()
    robot.hear(0.0, AHEAD)
    robot.hear(0.001, STILL)
    robot.hear(0.002, BACK)
    assert robot.did == [AHEAD, STILL, BACK]


def test_a_zero_to_all_stops_it_a_moment_later() -> None:
    robot = Robot()
    robot.hear(0.0, AHEAD)
    robot.hear(1.0, STILL, shared=True)
    assert robot.newest.deadline == 1.0 + WAIT
    robot.until(1.0 + WAIT)
    assert robot.did == [AHEAD, STILL]
    assert robot.newest.deadline == inf


def test_zeros_to_all_without_a_pause_stop_it_too() -> None:
    robot = Robot()
    robot.hear(0.0, AHEAD)
    for number in range(10):
        robot.hear(1.0 + number * WAIT / 2, STILL, shared=True)
    assert STILL in robot.did


def test_a_pair_is_one_command_in_either_order() -> None:
    for zero, command in ((1.0, 1.0005), (1.0005, 1.0)):
        robot = Robot()
        robot.hear(0.0, BACK)
        for now, twist, shared in sorted([(zero, STILL, True), (command, AHEAD, False)]):
            robot.hear(now, twist, shared=shared)
        robot.until(2.0)
        assert robot.did == [BACK, AHEAD]


def test_a_zero_to_all_from_somebody_else_always_stops_it() -> None:
    robot = Robot()
    robot.hear(1.0, AHEAD)
    robot.hear(1.0005, STILL, shared=True, sender=OTHER)
    robot.until(2.0)
    assert robot.did == [AHEAD, STILL]


def test_only_one_zero_belongs_to_a_command() -> None:
    robot = Robot()
    robot.hear(1.0, AHEAD)
    robot.hear(1.0005, STILL, shared=True)
    robot.hear(1.0010, STILL, shared=True)
    robot.until(2.0)
    assert robot.did == [AHEAD, STILL]


def test_a_zero_for_the_next_robot_stops_this_one_however_fast_the_keys_are() -> None:
    robot = Robot()
    robot.hear(1.0000, STILL, shared=True)
    robot.hear(1.0001, AHEAD)
    robot.hear(1.0010, STILL, shared=True)  # with a command to another robot
    robot.until(2.0)
    assert robot.did == [AHEAD, STILL]


def test_a_zero_much_later_is_no_part_of_the_command() -> None:
    robot = Robot()
    robot.hear(1.0, AHEAD)
    robot.hear(1.0 + LATE, STILL, shared=True)
    robot.until(2.0)
    assert robot.did == [AHEAD, STILL]


def test_a_command_that_comes_late_still_counts() -> None:
    robot = Robot()
    robot.hear(1.0, STILL, shared=True)
    robot.hear(1.0 + 2 * WAIT, AHEAD)
    robot.hear(1.2, STILL, shared=True)
    robot.until(2.0)
    assert robot.did == [STILL, AHEAD, STILL]


def test_a_command_to_all_decides_at_once() -> None:
    robot = Robot()
    robot.hear(1.0, STILL, shared=True)
    robot.hear(1.001, BACK, shared=True)
    robot.hear(1.002, AHEAD)
    robot.hear(1.003, BACK, shared=True)
    robot.until(2.0)
    assert robot.did == [BACK, AHEAD, BACK]


PRESSES = st.lists(
    st.tuples(
        st.integers(0, 1),  # which robot
        st.sampled_from([AHEAD, BACK, Twist2(w=0.1), Twist2(w=-0.1)]),
        st.floats(-0.9 * LATE, 0.9 * WAIT),  # how long after the zero its command comes [s]
    ),
    min_size=1,
    max_size=30,
)


@given(PRESSES, st.floats(2 * LATE, 1.0))
def test_no_press_is_lost_or_reversed(
    presses: list[tuple[int, Twist2, float]], pause: float
) -> None:
    robots = [Robot(), Robot()]
    for number, robot in enumerate(robots):
        expected: list[Twist2] = []
        for count, (chosen, twist, after) in enumerate(presses):
            now = 1.0 + count * pause
            heard = [(now, STILL, True)]
            if chosen == number:
                heard.append((now + after, twist, False))
            for at, what, shared in sorted(heard, key=lambda each: each[0]):
                robot.hear(at, what, shared=shared)
            expected.append(twist if chosen == number else STILL)
        robot.until(1e9)
        assert robot.did == expected
