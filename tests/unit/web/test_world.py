"""What pages are told of the simulated world."""

from typing import Any

import pytest

from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.models import model_names
from pioneer3.sim.worldfile import Box, Person
from pioneer3.web.world import MOST_GONE, WorldChannel, WorldView
from tests.unit.web.browser import simulated, strict

BOX = Box(pose=Pose2(3.0, 1.0, 0.5), size=(1.0, 0.4), name="crate")
WALKER = Person(path=((5.0, 0.0), (5.0, 4.0)), name="Ada")


def view_of(*poses: Pose2) -> WorldView:
    here = simulated(*poses)
    view = WorldView(here)
    view.driven[here.robots[0]] = 1
    return view


class News:
    """What one page hears that has nothing else to do."""

    def __init__(self, view: WorldView, shared: WorldChannel | None = None) -> None:
        self.shared = shared or WorldChannel(view)
        self._seen = 0

    def next(self) -> str | None:
        """Return the next message, `None` if there is none."""
        self.shared.update()
        texts, self._seen = self.shared.since(self._seen), self.shared.version
        return texts[0] if texts else None


def told(news: News) -> dict[str, Any]:
    """Return the next message as a browser gets it."""
    message = news.next()
    assert message is not None
    return strict(message)


def test_the_first_news_is_all_there_is() -> None:
    view = view_of(Pose2(1.0, 2.0, 0.5), Pose2(9.0, 9.0))
    view.simulation.add_box(BOX)
    view.simulation.add_person(WALKER)
    message = told(News(view))
    own, other, box, person = message["things"]
    assert (message["type"], message["all"], message["moved"], message["gone"]) == (
        "world",
        True,
        [],
        [],
    )
    assert own == {
        "id": 1,
        "kind": "robot",
        "name": "robot-1",
        "front": view.simulation.robots[0].model.length_front,
        "rear": view.simulation.robots[0].model.length_rear,
        "side": view.simulation.robots[0].model.width / 2,
        "model": "p3dx-sh",
        "title": "Pioneer 3-DX",
        "url": "memory:1",
        "own": 1,
        "connected": False,
        "stop_button": False,
        "plugged": True,
        "charge": 1.0,
        "thing_in_map": [1.0, 2.0, 0.5],
    }
    assert (other["id"], other["own"], other["url"]) == (2, None, "memory:2")
    assert box == {
        "id": 3,
        "kind": "box",
        "name": "crate",
        "front": 0.5,
        "rear": 0.5,
        "side": 0.2,
        "walks": False,
        "height": 0.5,
        "thing_in_map": [3.0, 1.0, 0.5],
    }
    assert (person["kind"], person["name"], person["walks"]) == ("person", "Ada", True)
    assert person["front"] == person["side"] == 0.25


def test_where_nothing_changes_there_is_no_news() -> None:
    view = view_of(Pose2())
    view.simulation.add_box(BOX)
    news = News(view)
    told(news)
    assert news.next() is None
    less_than_a_millimetre = Pose2(0.0001, 0.0, 0.0)
    view.simulation.robots[0].body.robot_in_world = less_than_a_millimetre
    assert news.next() is None


def test_what_moves_is_told_by_its_number_alone() -> None:
    view = view_of(Pose2())
    box = view.simulation.add_box(BOX)
    news = News(view)
    told(news)
    view.simulation.move(box, Pose2(4.0, 1.0, 0.25))
    message = told(news)
    assert (message["things"], message["moved"]) == ([], [[2, 4.0, 1.0, 0.25]])
    assert message["all"] is False


def test_who_walks_is_told_as_time_passes() -> None:
    view = view_of(Pose2())
    view.simulation.add_person(WALKER)
    news = News(view)
    told(news)
    view.simulation.world.step(0.5)
    ((number, x, y, _),) = told(news)["moved"]
    assert (number, x, y) == (2, 5.0, pytest.approx(0.5))


def test_what_is_gone_is_told_once_and_its_number_never_comes_back() -> None:
    view = view_of(Pose2())
    box = view.simulation.add_box(BOX)
    news = News(view)
    told(news)
    view.simulation.remove(box)
    assert told(news)["gone"] == [2]
    assert news.next() is None
    view.simulation.add_box(BOX)
    assert [thing["id"] for thing in told(news)["things"]] == [3]
    with pytest.raises(CommandError, match="not there any more"):
        view.find(2)


def test_a_pressed_button_and_a_pulled_cable_are_news() -> None:
    view = view_of(Pose2())
    news = News(view)
    told(news)
    view.simulation.robots[0].body.stop_button = True
    view.simulation.robots[0].port.faults.unplug()
    (thing,) = told(news)["things"]
    assert (thing["stop_button"], thing["plugged"]) == (True, False)


def test_two_pages_hear_the_same_whenever_they_come() -> None:
    view = view_of(Pose2())
    box = view.simulation.add_box(BOX)
    first = News(view)
    told(first)
    view.simulation.move(box, Pose2(4.0, 1.0))
    second = told(News(view, first.shared))["things"][1]
    assert second["id"] == told(first)["moved"][0][0] == 2
    assert second["thing_in_map"] == [4.0, 1.0, 0.0]


def test_the_time_is_told_while_it_stands_still() -> None:
    view = view_of(Pose2())
    news, pace = News(view), view.simulation.pace
    assert told(news)["clock"] == {"paused": False, "speed": 1.0, "factor": 0.0, "time": None}
    pace.pause()
    assert told(news)["clock"] == {"paused": True, "speed": 1.0, "factor": 0.0, "time": 0.0}
    pace.speed = float("inf")
    assert told(news)["clock"]["speed"] is None
    view.simulation.world.step(0.1)
    assert told(news)["clock"]["time"] == 0.1


def test_every_shipped_model_can_be_added() -> None:
    models = view_of(Pose2()).models
    assert tuple(model.name for model in models) == model_names()
    assert all(model.title for model in models)


def test_who_missed_some_hears_all_of_it_at_once_and_nothing_twice() -> None:
    view = view_of(Pose2())
    box, crate = view.simulation.add_box(BOX), view.simulation.add_box(BOX)
    quick = News(view)
    slow = News(view, quick.shared)
    told(quick), told(slow)
    view.simulation.move(box, Pose2(4.0, 1.0))
    told(quick)
    view.simulation.remove(crate)
    assert told(quick)["moved"] == []
    missed = told(slow)
    assert ([number for number, *_ in missed["moved"]], missed["gone"]) == ([2], [3])
    assert slow.next() is None


def test_who_missed_more_than_is_remembered_is_told_all_anew() -> None:
    view = view_of(Pose2())
    quick = News(view)
    slow = News(view, quick.shared)
    told(slow)
    for _ in range(MOST_GONE + 1):
        box = view.simulation.add_box(BOX)
        told(quick)
        view.simulation.remove(box)
        told(quick)
    missed = told(slow)
    assert (missed["all"], missed["gone"], len(missed["things"])) == (True, [], 1)
