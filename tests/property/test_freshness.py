"""No command counts after a stop but by the table of `pioneer3.stops`, whatever came before."""

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import STILL, Twist2
from pioneer3.robot.pilot import VelocityCommand
from pioneer3.stops import Freshness, Stop, leads_away
from tests.held import BACK, CAUSES, FORTH, LEFT, Driver

TWISTS = (FORTH, BACK, LEFT, Twist2(0.1, -1.0), Twist2(0.0, -0.3))
SENT = st.sampled_from(TWISTS)
LET_GO = "let go"
STOPS = [cause for cause in CAUSES if "silence" not in cause and "input" not in cause]
HAPPENS = st.sampled_from([cause for cause in CAUSES if "bumper" not in cause])
SILENT = st.just("silence of the page that drove")
EVENTS = st.lists(st.one_of(SENT, SENT, SENT, SILENT, st.just(LET_GO), HAPPENS), max_size=30)
"""Events for one driver; not a bumper, which counts as a stall, and sends by itself."""


def counts(log: Sequence[str]) -> bool:
    """Return whether the table obeys the command that `log` ends with, read from its end."""
    led_away = stopped = False
    for event in reversed(log):
        match event:
            case "begins":
                return True
            case "leads away":
                led_away = True
            case "overruled":
                return False
            case "silent" if not led_away:
                return False
            case "stop" if not stopped:
                return False
            case "stall" if not (stopped or led_away):
                return False
        stopped |= event in {"stop", "stall"}
    return False


class Observer:
    """Writes down what happens to the command of a driver."""

    def __init__(self, *, streams: bool) -> None:
        self.driver = Driver(streams=streams)
        self.log: list[str] = []
        self._held, self._streams, self._silent = STILL, streams, False

    def send(self, twist: Twist2) -> None:
        """Send for a moment; what the table obeys is obeyed."""
        if self._held.is_zero or (self._silent and not self._streams):
            self.log.append("begins")
        else:
            if self._silent:
                self.log.append("silent")
            if leads_away(twist, self._held):
                self.log.append("leads away")
        self._held, self._silent = twist, False
        assert (self.driver.send(twist, 0.2) == "obeyed") == counts(self.log)

    def let_go(self) -> None:
        """Send a zero."""
        self.driver.let_go()
        self._held, self._silent = STILL, False

    def happen(self, cause: str) -> None:
        """Let the robot be stopped while the command is held."""
        before = self.driver.pilot.last_stop
        CAUSES[cause](self.driver)
        if (last := self.driver.pilot.last_stop) != before:
            self.log.append("stop" if last.stalled is None else "stall")
        if cause == "an input that comes first" and not self._silent:
            self.log.append("overruled")
        self._silent |= "silence" in cause


@given(EVENTS, st.booleans())
def test_what_the_table_obeys_is_obeyed_and_nothing_else(
    events: list[Twist2 | str], streams: bool
) -> None:
    observer = Observer(streams=streams)
    for event in events:
        if isinstance(event, Twist2):
            observer.send(event)
        elif event == LET_GO:
            observer.let_go()
        else:
            observer.happen(event)


@given(st.lists(st.sampled_from(STOPS), min_size=1), st.data())
def test_the_pilot_refuses_what_was_decided_before_a_stop(
    causes: list[str], data: st.DataObject
) -> None:
    driver = Driver()
    driver.send(FORTH)
    for cause in causes:
        CAUSES[cause](driver)
    driver.see()
    last = driver.pilot.last_stop
    old = data.draw(st.integers(0, last.number - 1))
    assert driver.pilot.drive(VelocityCommand(BACK, after=old), driver.now) == last.told
    assert driver.pilot.asked(driver.now).is_zero
    assert driver.pilot.drive(VelocityCommand(BACK, after=last.number), driver.now) is None


@given(st.lists(st.tuples(st.booleans(), st.booleans())))
def test_a_mode_goes_on_only_after_stalls_that_it_answers(stops: list[tuple[bool, bool]]) -> None:
    last = Stop(7, "the session began")
    mode, goes_on = Freshness.new(last), True
    for stalled, answers in stops:
        last = Stop(last.number + 1, "it stopped", FORTH if stalled else None)
        if answers:
            mode.answer(last)
        goes_on = goes_on and stalled and answers
        if not goes_on:
            break
    assert (mode.ignored(last) is None) == goes_on


@given(SENT, SENT)
def test_a_way_that_leads_away_leads_back_too(twist: Twist2, before: Twist2) -> None:
    assert leads_away(twist, before) == leads_away(before, twist)
    assert not leads_away(twist, twist)
