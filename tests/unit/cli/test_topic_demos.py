"""Demos on topics: the graph that their options mean."""

from typing import Any

import pytest

from pioneer3.cli.motion import keyword
from pioneer3.cli.ros2_network import ANYWHERE, NetworkOptions
from pioneer3.cli.topic_demos import commands


class AskedError(Exception):
    """Carries what a graph was asked for."""


def test_a_demo_without_options_takes_the_network_of_this_computer() -> None:
    def graph_of(network: Any) -> Any:
        raise AskedError(network)

    names = {"ros": "ros2", "robot": "robot1", "another": "robot2"}
    robots, *_ = commands(graph_of, keyword("network", NetworkOptions, ANYWHERE), names)
    with pytest.raises(AskedError) as asked:
        robots()
    assert asked.value.args == (ANYWHERE,)
