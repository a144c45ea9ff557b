import pytest

from pioneer3.ros.ros2.backend import Unread


@pytest.mark.parametrize(("number", "lines"), [(0, 0), (1, 1), (2, 2), (1000, 2)])
def test_the_first_is_told_and_at_the_end_how_many_there_were(
    number: int, lines: int, caplog: pytest.LogCaptureFixture
) -> None:
    unread = Unread("requests of /x")
    for each in range(number):
        unread.add(ValueError(f"reason {each}"))
    unread.close()
    said = [record.getMessage() for record in caplog.records]
    assert len(said) == lines
    if number:
        assert said[0] == "requests of /x cannot be read: reason 0; others are only counted"
    if number > 1:
        assert said[1] == f"{number} requests of /x could not be read"
