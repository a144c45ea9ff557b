"""Write the tables of ros1-node.md and ros2-node.md, and of how-to/laser.md and navigate.md.

    uv run python -m docs.reference.ros_tables

A line `<!-- made: what -->` begins a table; whatever follows it up to `<!-- end -->` is replaced.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from docs.reference.protocol_tables import BLOCK, table
from pioneer3.nav.settings import SETTINGS
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate
from pioneer3.ros.messages.goals import FeedbackUpdate, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.messages.update import (
    DescriptionUpdate,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
    StateUpdate,
)
from pioneer3.ros.node.driving_parameters import PARAMETERS as DRIVING
from pioneer3.ros.node.goals import STATUS_EVERY
from pioneer3.ros.node.laser_parameters import FOREIGN as OF_LASERS
from pioneer3.ros.node.laser_parameters import LaserParameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.parameter import Foreign, Parameter, Value, rows_of
from pioneer3.ros.node.parameter_reading import FOREIGN, read_parameters
from pioneer3.ros.node.parameters import parameters_in
from pioneer3.ros.node.services import NAVIGATION_SERVICES, P2OS_ORDERS, SERVICES
from pioneer3.ros.node.topic import Direction, Topic
from pioneer3.ros.node.topics import TOPICS, aria_topics, laser_topic, transducer_topic

PAGE = Path(__file__).with_name("ros1-node.md")
ROS2_PAGE = PAGE.with_name("ros2-node.md")
MAP_PAGE = PAGE.parents[1] / "how-to" / "navigate.md"
PAGES = (PAGE, ROS2_PAGE, MAP_PAGE)
EVERY = {
    StateUpdate: "with every snapshot",
    ScanUpdate: "with every scan",
    SensorUpdate: "with every sample",
    PictureUpdate: "with every picture",
    DescriptionUpdate: "once",
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
    each = "on change" if topic.changes and topic.period != 0 else EVERY[topic.source]
    latched = "latched" if topic.latched else ""
    return ", ".join(filter(None, (latched, period, each)))


def rows_in(table_of: tuple[Topic, ...], *profiles: Profile) -> list[Topic]:
    """Return the topics that have a name in one of `profiles`."""
    return [each for each in table_of if any(each.names(profile) for profile in profiles)]


def topics() -> str:
    """Return the table of topics in ROS 1."""
    first = transducer_topic(0)
    rows = [
        (
            code(topic.compatibility),
            f"{code(topic.standard)} …" if topic is first else code(topic.standard),
            topic.type_name,
            when(topic),
            topic.note,
        )
        for topic in (
            *rows_in(TOPICS, Profile.BOTH),
            laser_topic("laser"),
            *aria_topics("laser", "sim_lms2xx_1"),
            first,
        )
    ]
    return table(("`compatibility`", "`standard`", "type", "when", ""), rows)


def topics_of_p2os() -> str:
    """Return the table of topics that have other names or types in p2os."""
    commands = [
        (code(each.name), each.type_name, "subscribed to", each.note) for each in P2OS_ORDERS
    ]
    rows = [
        (code(each.p2os), each.type_name, when(each), each.note) for each in TOPICS if each.p2os
    ]
    return table(("topic", "type", "when", ""), (*commands, *rows))


def topics_of_ros2() -> str:
    """Return the table of topics in ROS 2."""
    first = transducer_topic(0)
    shown = (*TOPICS, laser_topic("laser"), first, *NAVIGATION_TOPICS)
    rows = [
        (
            f"{code(name)} …" if topic is first else code(name),
            topic.type_name.replace("/", "/msg/"),
            when(topic),
            topic.note,
        )
        for topic in rows_in(shown, Profile.ROS2)
        for name in topic.names(Profile.ROS2)
    ]
    return table(("topic", "type", "when", ""), rows)


def services_of_ros2() -> str:
    """Return the table of services in ROS 2."""
    rows = [
        (
            code(name),
            each.type_in(Profile.ROS2).replace("/", "/srv/"),
            (each.topic_type or "").replace("/", "/msg/"),
            each.note,
        )
        for each in (*SERVICES, *NAVIGATION_SERVICES)
        for name in each.names(Profile.ROS2)
    ]
    return table(("service", "type", "over DDS a topic of", ""), rows)


def parameters(rows: Iterable[Parameter], mark: str = "") -> str:
    """Return the table of parameters; `mark` comes before each name."""
    shown = [
        (
            code(f"{mark}{each.name}"),
            each.otherwise or _default(each.default),
            values(each),
            f"{_meaning(each)}; {code(f'~{each.rosaria}')} in `compatibility`"
            if mark and each.rosaria
            else _meaning(each),
        )
        for each in rows
    ]
    return table(("name", "default", "values", ""), shown)


def driving_parameters() -> str:
    """Return the table of parameters of driving in ROS 1."""
    rows = [
        (
            code(f"~{each.rosaria}"),
            code(each.today and f"~{each.today}"),
            values(each.in_rosaria),
            _meaning(each),
        )
        for each in DRIVING
    ]
    return table(("in RosAria", "today", "values", ""), rows)


def driving_parameters_of_ros2() -> str:
    """Return the table of parameters of driving in ROS 2."""
    rows = [
        (code(each.name), each.kind, values(each), _meaning(each))
        for each in DRIVING
        if Profile.ROS2 in each.profiles
    ]
    return table(("name", "type", "values", ""), rows)


def values(row: Parameter) -> str:
    """Return the values that a parameter may have, as far as they are bounded."""
    return " or ".join(map(code, row.choices)) or row.range


def _meaning(row: Parameter) -> str:
    return f"{row.meaning}; {code(row.p2os)} in p2os" if row.p2os else row.meaning


def _default(value: Value | None) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(_default, value))}]"
    return f"{value:g}" if isinstance(value, float | int) else code(value) or "none"


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
    rows = [
        (
            code(each.name),
            ", ".join(map(code, each.aliases)),
            each.otherwise or _default(each.default),
            values(each),
            each.meaning,
        )
        for each in rows_of(LaserParameters)
    ]
    return (
        table(("name", "in other drivers", "default", "values", ""), rows)
        + "\n\nThese have no effect, which the log says:\n\n"
        + foreign_parameters(OF_LASERS)
    )


def foreign_parameters(others: Mapping[str, Foreign]) -> str:
    """Return the table of parameters of other nodes that have no effect here."""
    alike: dict[Foreign, list[str]] = {}
    for name, other in others.items():
        alike.setdefault(other, []).append(code(name))
    rows = [
        (", ".join(names), each.node, re.sub(r"~\w+", lambda our: code(our[0]), each.instead))
        for each, names in alike.items()
    ]
    return table(("name", "of", "in its place"), rows)


def settings() -> str:
    """Return the table of settings of navigation."""
    rows = [
        (
            code(one.name),
            one.written(one.default),
            f"{one.written(one.low)} to {one.written(one.high)}",
            one.meaning,
        )
        for one in SETTINGS.values()
    ]
    return table(("setting", "default", "range", ""), rows)


def filled(text: str) -> str:
    """Return the page with its tables made anew."""
    makers: dict[str, Callable[[], str]] = {
        "settings": settings,
        "topics": topics,
        "services": services,
        "navigation topics": navigation_topics,
        "navigation services": navigation_services,
        "laser parameters": laser_parameters,
        "parameters": lambda: parameters(parameters_in(Profile.BOTH), "~"),
        "topics of p2os": topics_of_p2os,
        "foreign parameters": lambda: foreign_parameters(FOREIGN),
        "driving parameters": driving_parameters,
        "topics of ROS 2": topics_of_ros2,
        "services of ROS 2": services_of_ros2,
        "driving parameters of ROS 2": driving_parameters_of_ros2,
        "parameters of ROS 2": lambda: parameters(read_parameters({}, Profile.ROS2).values),
    }

    def made(block: re.Match[str]) -> str:
        return f"<!-- made: {block[1]} -->\n\n{makers[block[1]]()}\n\n<!-- end -->\n"

    return BLOCK.sub(made, text)


if __name__ == "__main__":
    for page in PAGES:
        page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
