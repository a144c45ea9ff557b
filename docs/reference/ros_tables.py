"""Write the tables of docs/how-to/ros1.md and laser.md: topics, services, the laser's parameters.

    uv run python -m docs.reference.ros_tables

A line `<!-- made: what -->` begins a table; whatever follows it up to `<!-- end -->` is replaced.
"""

import re
from pathlib import Path

from docs.reference.protocol_tables import BLOCK, table
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate
from pioneer3.ros.messages.goals import FeedbackUpdate, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.messages.update import PictureUpdate, ScanUpdate, SensorUpdate, StateUpdate
from pioneer3.ros.node.goals import STATUS_EVERY
from pioneer3.ros.node.laser_parameters import IGNORED, PARAMETERS
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.services import NAVIGATION_SERVICES, SERVICES
from pioneer3.ros.node.topics import TOPICS, Direction, Topic, laser_topic, transducer_topic

PAGE = Path(__file__).parents[1] / "how-to" / "ros1.md"
LASER_PAGE = PAGE.with_name("laser.md")
EVERY = {
    StateUpdate: "with every snapshot",
    ScanUpdate: "with every scan",
    SensorUpdate: "with every sample",
    PictureUpdate: "with every picture",
    DiagnosticsUpdate: "",
    MapUpdate: "once",
    NavigationUpdate: "with every snapshot",
    GoalsUpdate: f"every {STATUS_EVERY:g} s, on change",
    FeedbackUpdate: "with every snapshot on the way",
    ResultUpdate: "at the end of a goal",
}


def code(name: str | None) -> str:
    """Return a name in code."""
    return f"`{name}`" if name else ""


def when(topic: Topic) -> str:
    """Return when messages of a topic come."""
    if topic.direction is Direction.SUBSCRIBED:
        return "subscribed to"
    period = f"every {topic.period:g} s" if topic.period else ""
    each = "on change" if topic.changes else EVERY[topic.source]
    latched = "latched" if topic.latched else ""
    return ", ".join(filter(None, (latched, period, each)))


def topics() -> str:
    """Return the table of topics."""
    first = transducer_topic(0)
    rows = [
        (
            code(topic.compatibility),
            f"{code(topic.standard)} …" if topic is first else code(topic.standard),
            topic.type_name,
            when(topic),
            topic.note,
        )
        for topic in (*TOPICS, laser_topic("laser"), first)
    ]
    return table(("`compatibility`", "`standard`", "type", "when", ""), rows)


def navigation_topics() -> str:
    """Return the table of topics of a node that has a map."""
    rows = [
        (code(each.standard), each.type_name, when(each), each.note) for each in NAVIGATION_TOPICS
    ]
    return table(("topic", "type", "when", ""), rows)


def services() -> str:
    """Return the table of services."""
    rows = [
        (code(each.compatibility), code(each.standard), each.type_name, each.note)
        for each in SERVICES
    ]
    return table(("`compatibility`", "`standard`", "type", ""), rows)


def navigation_services() -> str:
    """Return the table of services of a node that has a map."""
    rows = [(code(each.standard), each.type_name, each.note) for each in NAVIGATION_SERVICES]
    return table(("service", "type", ""), rows)


def laser_parameters() -> str:
    """Return the table of parameters of lasers, and those without effect."""
    rows = [(code(each.name), code(each.hokuyo), each.note) for each in PARAMETERS]
    ignored = ", ".join(code(name) for name in IGNORED)
    return (
        table(("name", "in hokuyo_node, if another", ""), rows)
        + f"\n\nWithout effect, which the log says: {ignored}."
    )


def filled(text: str) -> str:
    """Return the page with its tables made anew."""
    makers = {
        "topics": topics,
        "services": services,
        "navigation topics": navigation_topics,
        "navigation services": navigation_services,
        "laser parameters": laser_parameters,
    }

    def made(block: re.Match[str]) -> str:
        return f"<!-- made: {block[1]} -->\n\n{makers[block[1]]()}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


if __name__ == "__main__":
    for page in (PAGE, LASER_PAGE):
        page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
