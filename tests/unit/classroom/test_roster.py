"""Who has which robot, and who is paused."""

import pytest

from pioneer3.classroom.roster import ALL_PAUSED, ONE_PAUSED, Roster, Student
from pioneer3.errors import CommandError


def test_each_student_gets_the_first_free_robot() -> None:
    roster = Roster([1, 2, 3])
    assert [roster.join(session, session, session) for session in ("a", "b", "c")] == [1, 2, 3]
    roster.free(2)
    assert roster.join("d", "d", "10.0.0.d") == 2


def test_a_name_that_is_taken_gets_a_number() -> None:
    roster = Roster([1, 2, 3])
    for session in ("a", "b", "c"):
        roster.join(session, "  Anna\n", session)
    names = [student.name for n in (1, 2, 3) if (student := roster.student(n))]
    assert names == ["Anna", "Anna 2", "Anna 3"]


def test_who_joins_again_keeps_the_robot_and_changes_the_name() -> None:
    roster = Roster([1, 2])
    roster.join("a", "Anna", "10.0.0.a")
    roster.join("b", "Bob", "10.0.0.b")
    assert roster.join("a", "Anna", "10.0.0.a") == 1
    assert roster.student(1) == Student("a", "Anna", "10.0.0.a")
    roster.locked = True
    assert roster.join("b", "Robert", "10.0.0.b") == 2
    assert roster.robot_of("b") == 2


def test_a_client_without_a_cookie_takes_one_seat_and_no_more() -> None:
    roster = Roster([1, 2, 3])
    roster.join("a", "Anna", "10.0.0.7")
    for session in "bcd":
        with pytest.raises(CommandError, match=r"joined from your address, 10\.0\.0\.7"):
            roster.join(session, "Eve", "10.0.0.7")
    assert roster.join("a", "Anna B", "10.0.0.7") == 1
    assert roster.join("e", "Emil", "10.0.0.8") == 2
    roster.free(1)
    assert roster.join("b", "Bob", "10.0.0.7") == 1


def test_students_behind_one_router_join_once_the_teacher_lets_them() -> None:
    roster = Roster(range(1, 21))
    roster.shared = True
    assert [roster.join(str(n), "Anna", "10.0.0.1") for n in range(20)] == roster.robots


def test_a_full_class_says_how_many_there_are() -> None:
    roster = Roster([1])
    roster.join("a", "Anna", "10.0.0.a")
    with pytest.raises(CommandError, match="each of its 1 robots has a student"):
        roster.join("b", "Bob", "10.0.0.b")
    assert roster.robot_of("b") is None


def test_nobody_joins_a_locked_class() -> None:
    roster = Roster([1])
    roster.locked = True
    with pytest.raises(CommandError, match="nobody else can join"):
        roster.free_robot("10.0.0.9")


@pytest.mark.parametrize("name", ["", "  \t", "\x00\x1b"])
def test_a_name_is_needed(name: str) -> None:
    roster = Roster([1])
    with pytest.raises(CommandError, match="type your name"):
        roster.join("a", name, "10.0.0.a")
    assert roster.student(1) is None


def test_a_seat_that_is_freed_has_no_student() -> None:
    roster = Roster([1])
    roster.join("a", "Anna", "10.0.0.a")
    assert roster.free(1) == Student("a", "Anna", "10.0.0.a")
    assert roster.free(1) is None
    assert roster.robot_of("a") is None


def test_to_let_one_go_on_leaves_the_others_paused() -> None:
    roster = Roster([1, 2])
    roster.pause(paused=True)
    assert [roster.pause_of(n) for n in (1, 2)] == [ALL_PAUSED, ALL_PAUSED]
    roster.pause(1, paused=False)
    assert [roster.pause_of(n) for n in (1, 2)] == ["", ONE_PAUSED]
    assert not roster.all_paused
    roster.pause(paused=False)
    assert [roster.pause_of(n) for n in (1, 2)] == ["", ""]


def test_a_robot_that_is_not_there_is_an_error() -> None:
    roster = Roster([1])
    for act in (roster.student, roster.free, lambda n: roster.pause(n, paused=True)):
        with pytest.raises(CommandError, match="no robot 7"):
            act(7)
