"""When the topics of the table are published."""

from dataclasses import replace

from pioneer3.ros.messages.update import MessageOptions
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.topic import Topic
from pioneer3.ros.node.topics import published
from pioneer3.state import Battery, Charging, Motors
from tests.unit.ros.fakes import FakeMiddleware
from tests.unit.ros.support import P3AT, seen, update

PROFILE = Profile.BOTH


def publishing() -> tuple[Publishing, FakeMiddleware]:
    """Return the publishers of a P3-AT, and where they publish."""
    middleware = FakeMiddleware()
    made = Publishing(published(P3AT, MessageOptions(), PROFILE), PROFILE, middleware)
    made.advertise(lambda topic: True)
    return made, middleware


def counts(middleware: FakeMiddleware) -> dict[str, int]:
    """Return the number of messages by topic, of topics that have any."""
    return {
        name: len(each.messages) for name, each in middleware.publishers.items() if each.messages
    }


def test_only_latched_topics_are_published_without_subscribers() -> None:
    made, middleware = publishing()
    made.publish(update(seen()))
    sent = set(counts(middleware))
    assert sent == {name for name, each in middleware.publishers.items() if each.latched}
    assert "/tf_static" in sent


def test_a_topic_is_published_with_each_snapshot_while_it_has_subscribers() -> None:
    made, middleware = publishing()
    odom = middleware.publishers["odom"]
    for odom.subscribed in (True, True, False):
        made.publish(update(seen()))
    assert len(odom.messages) == 2


def test_both_names_of_a_topic_get_the_same_message() -> None:
    made, middleware = publishing()
    middleware.publishers["odom"].subscribed = True
    made.publish(update(seen()))
    assert middleware.publishers["odom"].messages == middleware.publishers["~pose"].messages


def test_a_topic_that_is_sent_on_change_waits_for_one() -> None:
    made, middleware = publishing()
    for enabled in (False, False, True, True):
        made.publish(update(seen(motors=Motors(enabled=enabled))))
    told = [message.data for message in middleware.publishers["motors_state"].messages]
    assert told == [False, True]


def test_a_topic_with_a_period_comes_after_it_and_on_change() -> None:
    made, middleware = publishing()
    middleware.publishers["battery_state"].subscribed = True
    docked = Battery(voltage=12.0, charging=Charging.BULK)
    for stamp, battery in ((0.0, None), (0.5, None), (0.96, None), (1.1, docked), (1.2, docked)):
        now = seen(battery=battery) if battery else seen()
        made.publish(update(replace(now, stamp=stamp)))
    assert len(middleware.publishers["battery_state"].messages) == 3


def test_a_lost_robot_is_said_on_latched_topics_and_taken_back() -> None:
    """Again and again where every snapshot has the topic, for locks that expire; else once."""
    made, middleware = publishing()
    made.publish(update(seen()))
    made.lose_robot()
    made.lose_robot()
    made.publish(update(seen()))
    stops = middleware.publishers["emergency_stop"].messages
    assert [getattr(each, "data", each) for each in stops] == [False, True, True, False]
    assert len(middleware.publishers["motors_state"].messages) == 3
    assert len(middleware.publishers["/tf_static"].messages) == 1  # it stays true


def test_a_device_that_is_not_there_has_no_topic() -> None:
    middleware = FakeMiddleware()
    topics = published(P3AT, MessageOptions(), Profile.STANDARD)

    def available(topic: Topic) -> bool:
        return topic.standard != "scan"

    Publishing(topics, Profile.STANDARD, middleware).advertise(available)
    assert "scan" not in middleware.publishers
    assert "imu/data_raw" in middleware.publishers
