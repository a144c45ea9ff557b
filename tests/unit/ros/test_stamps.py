"""Times in messages of ROS 1 and ROS 2."""

from types import SimpleNamespace

from pioneer3.ros.messages.update import nanoseconds
from tests.unit.ros.fakes import Moment


def test_times_of_both_are_exact() -> None:
    assert nanoseconds(SimpleNamespace(sec=1_700_000_000, nanosec=1)) == 1_700_000_000_000_000_001
    assert nanoseconds(Moment(2.5)) == 2_500_000_000
