"""The words after `--ros-args`: remapping rules, parameters, files, and names."""

from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.arguments import parse
from pioneer3.ros.ros2.backend import NodeName
from pioneer3.ros.ros2.names import checked_topic, expanded, node_name
from pioneer3.ros.ros2.remapping import Resource, resolved

NODE = NodeName("pioneer3", "/robot1")


def remapped(name: str, *rules: str, resource: Resource = Resource.TOPIC) -> str:
    words = [word for rule in rules for word in ("-r", rule)]
    return resolved(name, NODE, parse(words, NODE).rules, resource)


@pytest.mark.parametrize(
    ("rule", "name", "full"),
    [
        ("cmd_vel:=mux_vel", "cmd_vel", "/robot1/mux_vel"),
        ("/robot1/cmd_vel:=/mux", "cmd_vel", "/mux"),
        ("~/state:=state", "~state", "/robot1/state"),
        ("cmd_vel:=~/cmd_vel", "cmd_vel", "/robot1/pioneer3/cmd_vel"),
        ("cmd_vel:={ns}/mux", "cmd_vel", "/robot1/mux"),
        ("pioneer3:cmd_vel:=mux_vel", "cmd_vel", "/robot1/mux_vel"),
        ("twist_mux:cmd_vel:=mux_vel", "cmd_vel", "/robot1/cmd_vel"),
        ("rostopic://cmd_vel:=mux_vel", "cmd_vel", "/robot1/mux_vel"),
        ("rosservice://cmd_vel:=mux_vel", "cmd_vel", "/robot1/cmd_vel"),
        ("pioneer3:rostopic://cmd_vel:=mux_vel", "cmd_vel", "/robot1/mux_vel"),
        (r"/foo/**:=/fizz/\1", "/foo/bar/baz", "/fizz/bar/baz"),
        (r"/foo/**:=/fizz/\1", "/foo", "/foo"),
        (r"/foo/bar/*:=/bar/foo/\1", "/foo/bar/baz", "/bar/foo/baz"),
        (r"/foo/bar/*:=/bar/foo/\1", "/foo/bar/fee/biz", "/foo/bar/fee/biz"),
        (r"**/foo:=\1/bar", "/foo", "/bar"),
        (r"**/foo:=\1/bar", "/biz/buz/foo", "/biz/buz/bar"),
        (r"**/bar:=/bar/\1", "/foo/bar", "/bar/foo"),
        (r"/bar/*:=\1/bar", "/bar/foo", "/robot1/foo/bar"),
    ],
)
def test_rules_have_the_syntax_of_ros(rule: str, name: str, full: str) -> None:
    assert remapped(name, rule) == full


def test_rules_for_services_change_no_topics() -> None:
    rule = "rosservice://reset:=restart"
    assert remapped("reset", rule, resource=Resource.SERVICE) == "/robot1/restart"
    assert remapped("reset", rule) == "/robot1/reset"


def test_the_first_rule_that_fits_counts() -> None:
    assert remapped("a", "a:=b", "a:=c", "b:=d") == "/robot1/b"
    found = parse(["-r", "__node:=one", "-r", "__node:=two", "-r", "one:__ns:=/there"], NODE)
    assert (found.name, found.namespace) == ("one", "/there")


def test_names_of_another_node_are_not_taken() -> None:
    found = parse(["-r", "other:__ns:=/x", "-r", "other:__node:=bob"], NODE)
    assert (found.name, found.namespace, found.rules) == (None, None, ())


@pytest.mark.parametrize(
    "words",
    [
        ("-r", "cmd_vel"),
        ("-r", "cmd_vel:="),
        ("-r", "__ns:="),
        ("-r", "rosservice:/x:=y"),
        ("-r", "a//b:=c"),
        ("-r", "a b:=c"),
        ("-r", "*bar:=c"),
        ("-r", "/robot1/pioneer3:cmd_vel:=c"),
        ("--params-file",),
        ("--log-level",),
        ("--log-colour", "red"),
    ],
)
def test_other_words_are_refused(words: tuple[str, ...]) -> None:
    with pytest.raises(ConfigError, match=words[0]):
        parse(words, NODE)


def test_options_of_logs_are_ignored() -> None:
    words = ("--log-level", "x:=debug", "--log-level=debug", "--disable-rosout-logs")
    assert parse((*words, "-p", "a:=1"), NODE).parameters == {"a": 1}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3e-1", 0.3),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("2.", 2.0),
        ("-.inf", float("-inf")),
        ("12", 12),
        ("0x10", 16),
        ("1:30", "1:30"),
        ("2001-01-01", "2001-01-01"),
        ("1_000", "1_000"),
        ("e3", "e3"),
        ("true", True),
        ("[1, 2e0]", [1, 2.0]),
    ],
)
def test_values_are_those_of_ros(text: str, value: object, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(f"/**:\n  ros__parameters:\n    a: {text}\n")
    for words in (("-p", f"a:={text}"), ("--params-file", str(file))):
        found = parse(words, NODE).parameters["a"]
        assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("name", "fits"),
    [
        ("/robot1/pioneer3", True),
        ("robot1/pioneer3", True),
        ("pioneer3", False),
        ("/**", True),
        ("/**/pioneer3", True),
        ("/*/pioneer3", True),
        ("/robot1/*", True),
        ("/robot1/**", True),
        ("/**/robot1/**", True),
        ("/robot1/**/pioneer3", True),
        ("/robot2/**", False),
        ("/*", False),
        ("/*/*/pioneer3", False),
    ],
)
def test_wildcards_in_files_are_those_of_ros(name: str, fits: bool, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(f"{name}:\n  ros__parameters: {{a: 1}}\n")
    assert parse(("--params-file", str(file)), NODE).parameters == ({"a": 1} if fits else {})


def test_a_null_is_no_value_as_a_dump_has_it_for_what_is_not_set(tmp_path: Path) -> None:
    file = tmp_path / "dump.yaml"
    file.write_text("/**: {ros__parameters: {baud: null, map: office}}\n")
    assert parse(("--params-file", str(file)), NODE).parameters == {"map": "office"}


def test_a_nodes_own_parameters_count_more_than_those_of_wildcards(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(
        "/robot1/pioneer3: {ros__parameters: {a: 1}}\n"
        "/robot1/**: {ros__parameters: {a: 2, b: 2}}\n"
        "/**: {ros__parameters: }\n"
    )
    assert parse(("--params-file", str(file)), NODE).parameters == {"a": 1, "b": 2}


BOMB = "a: &a [x, x]\n" + "".join(
    f"{new}: &{new} [*{old}, *{old}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    "text",
    [
        "/**:\n  ros__parameters: &a\n    b: *a\n",
        BOMB,
        "[" * 5_000,
        "a: \x00",
        "? [1]\n: 2",
        "5",
        "",
    ],
)
def test_a_file_that_is_none_is_refused_by_its_name(text: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError, match=r"robot\.yaml"):
        parse(("--params-file", str(file)), NODE)


@pytest.mark.parametrize("space", ["/", "", "robot1", "/lab/robot1", "/" + "a" * 244])
def test_namespaces_may_lack_their_first_slash(space: str) -> None:
    assert node_name("n", space).namespace == f"/{space.removeprefix('/')}"


@pytest.mark.parametrize(
    ("name", "space"),
    [
        ("n", "a//b"),
        ("n", "//a"),
        ("n", "/a/"),
        ("n", "/1"),
        ("n", "/a b"),
        ("n", "/" + "a" * 245),
        ("", "/"),
        ("a/b", "/"),
        ("n\n", "/"),
        ("n" * 256, "/"),
    ],
)
def test_names_that_ros_refuses_are_refused(name: str, space: str) -> None:
    with pytest.raises(ConfigError):
        node_name(name, space)


def test_names_of_topics_have_an_end() -> None:
    assert checked_topic("/" + "a" * 246)
    with pytest.raises(ConfigError, match="247"):
        checked_topic("/" + "a" * 247)
    for name in ("/a//b", "/a/", "a", "/a\n"):
        with pytest.raises(ConfigError):
            checked_topic(name)


def test_names_expand_as_in_ros() -> None:
    assert expanded("{node}/x", NODE) == "/robot1/pioneer3/x"
    assert expanded("{namespace}/x", NodeName("pioneer3")) == "/x"
    assert expanded("~", NODE) == "/robot1/pioneer3"


def test_parameters_with_a_point_in_their_names_come_in_parts() -> None:
    words = ["-p", "planner.margin:=0.05", "-p", "laser.skip:=2", "-p", "a.b:=1"]
    found = parse(words, NODE).raw
    assert found == {"planner": {"margin": 0.05}, "laser": {"skip": 2}, "a.b": 1}
