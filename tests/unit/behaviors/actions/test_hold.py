"""When a command that somebody holds begins, and when it counts again after a stop."""

from dataclasses import dataclass, replace

import pytest

from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import STILL, Twist2
from pioneer3.stops import NO_STOP, Stop, leads_away
from tests.unit.behaviors.support import seen

FORTH, BACK, LEFT = Twist2(0.3, 0.1), Twist2(-0.2, 0.0), Twist2(0.0, 0.5)
STALL = Stop(1, "the wheels stalled", stalled=FORTH)
BUTTON = Stop(1, "the stop button on the robot is pressed")


@dataclass
class Sender:
    """Sends a command ten times a second."""

    hold: Hold
    last: Stop = NO_STOP
    now: float = 0.0

    def send(self, twist: Twist2, seconds: float = 1.0) -> bool:
        """Return whether the robot obeys in the end."""
        for _ in range(round(seconds * 10)):
            self.now += 0.1
            self.hold.set(twist, self.now, 0.5, self.last)
        return self.hold.decide(replace(seen(self.now), last_stop=self.last)) is not None

    def wait(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture(params=[False, True], ids=["presses", "stream"])
def sender(request: pytest.FixtureRequest) -> Sender:
    return Sender(Hold("stick", streams=request.param))


@pytest.mark.parametrize("stop", [STALL, BUTTON], ids=["stall", "button"])
def test_what_is_held_through_a_stop_counts_no_more_however_long(
    sender: Sender, stop: Stop
) -> None:
    assert sender.send(FORTH)
    sender.last = stop
    assert not sender.send(FORTH, 60.0)
    assert sender.hold.ignored(stop) == stop.told


@pytest.mark.parametrize("stop", [STALL, BUTTON], ids=["stall", "button"])
def test_who_lets_go_and_asks_again_is_obeyed(sender: Sender, stop: Stop) -> None:
    sender.send(FORTH)
    sender.last = stop
    sender.send(FORTH, 0.2)
    sender.hold.release()
    assert sender.send(FORTH, 0.1)


def test_a_zero_lets_go(sender: Sender) -> None:
    sender.send(FORTH)
    sender.last = BUTTON
    sender.send(FORTH, 0.2)
    sender.hold.set(STILL, sender.now, 0.5, sender.last)
    assert sender.send(FORTH, 0.1)


@pytest.mark.parametrize("away", [BACK, LEFT], ids=["back", "turn"])
def test_what_leads_away_from_a_stall_is_obeyed_at_once_and_so_is_the_way_back(
    sender: Sender, away: Twist2
) -> None:
    sender.send(FORTH)
    sender.last = STALL
    assert not sender.send(FORTH, 0.2)
    assert sender.send(away, 0.1)
    assert sender.send(FORTH, 0.1)


def test_what_leads_away_is_no_answer_to_other_stops(sender: Sender) -> None:
    sender.send(FORTH)
    sender.last = BUTTON
    assert not sender.send(BACK, 0.1)
    assert not sender.send(LEFT, 0.1)


def test_a_curve_that_goes_on_forwards_does_not_lead_away(sender: Sender) -> None:
    sender.send(FORTH)
    sender.last = STALL
    assert not sender.send(Twist2(0.1, -0.5), 0.1)


AWAY = [
    (FORTH, BACK, True),
    (FORTH, LEFT, True),
    (FORTH, Twist2(0.1, -2.0), False),
    (FORTH, STILL, False),
    (BACK, FORTH, True),
    (BACK, Twist2(-0.1, 1.0), False),
    (LEFT, Twist2(0.0, -0.1), True),
    (LEFT, Twist2(0.0, 0.1), False),
    (LEFT, FORTH, True),
    (LEFT, BACK, True),
]


@pytest.mark.parametrize(("before", "twist", "away"), AWAY)
def test_the_directions_that_lead_away(before: Twist2, twist: Twist2, away: bool) -> None:
    assert leads_away(twist, before) is away


def test_presses_are_let_go_by_silence() -> None:
    sender = Sender(Hold("keyboard"))
    sender.send(FORTH)
    sender.wait(4.0)
    assert sender.send(FORTH, 0.1)
    sender.last = BUTTON
    sender.wait(0.5)
    assert sender.send(FORTH, 0.1)


def test_a_stream_that_falls_silent_is_not_let_go_and_does_not_go_on() -> None:
    sender = Sender(Hold("page", streams=True))
    sender.send(FORTH)
    sender.wait(4.0)
    assert not sender.send(FORTH, 10.0)
    assert "fell silent" in str(sender.hold.ignored(NO_STOP))
    sender.hold.set(STILL, sender.now, 0.5, NO_STOP)
    assert sender.send(FORTH, 0.1)


def test_a_stream_that_fell_silent_may_lead_away() -> None:
    sender = Sender(Hold("page", streams=True))
    sender.send(FORTH)
    sender.wait(4.0)
    assert not sender.send(FORTH, 1.0)
    assert sender.send(BACK, 0.1)


def test_single_commands_are_no_stream() -> None:
    sender = Sender(Hold("script", streams=True))
    for _ in range(5):
        assert sender.send(FORTH, 0.1)
        sender.wait(2.0)


def test_what_is_overruled_has_to_be_let_go(sender: Sender) -> None:
    sender.send(FORTH)
    sender.hold.overrule("the gamepad drives", sender.now)
    assert not sender.send(FORTH, 2.0)
    assert str(sender.hold.ignored(NO_STOP)) == "the gamepad drives; let go, then ask again"
    sender.hold.release()
    assert sender.send(FORTH, 0.1)


def test_what_nobody_holds_cannot_be_overruled(sender: Sender) -> None:
    sender.hold.overrule("the gamepad drives", 1.0)
    assert sender.send(FORTH, 0.1)
