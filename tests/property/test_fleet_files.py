"""Whatever a fleet file holds: a fleet that reads back the same, or one line with its place."""

from collections.abc import Sequence

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.fleet.inventory import parse_fleet, to_toml
from pioneer3.fleet.spec import Fleet
from tests.property.fleets import PATH, fleets

COMMENTS = st.lists(
    st.sampled_from(["", "# the lab's", "  # [[robot]] name = 1", "\t"]), max_size=3
)
WRONG = {
    "name": ["1", '""', '"p3at_1"', '"-a"', '"all"', '"a b"', "[]", '"p3at-1."', f'"{"a" * 64}"'],
    "address": ['"192.168.1"', '"host"', "5", '"0.0.0.0"', '"224.0.0.1"', '"::1%"', '"0::1"'],
    "host": ['"p3at_1"', '"a..b"', '"$(reboot)"', "false"],
    "port": ['""', '"ttyUSB0"', '"tcp://"', '"tcp://a:0"', '"replay:x.log"', "8101"],
    "user": ['"-oProxyCommand=x"', '"a b"', '""', "1"],
    "model": ['"p3xx"', '"no/such.toml"', "3"],
    "laser": ['"lms"', '"sick@/dev/ttyUSB1"', "true"],
    "ros": ["1", '"3"', "{}"],
    "node": ['"p3at-1"', '"1a"', '"a//b"', '""', "1.5"],
    "note": ["1", "[]", '"a\\nb"', '"\\u001b[2J"'],
}


def scattered(text: str, gaps: Sequence[Sequence[str]]) -> str:
    """Return `text` with comments and empty lines between its lines."""
    lines = text.split("\n")
    filled = (
        line for number, line in enumerate(lines) for line in (*gaps[number % len(gaps)], line)
    )
    return "\n".join(filled)


@given(fleets(), st.lists(COMMENTS, min_size=1, max_size=5))
def test_what_is_written_reads_the_same(fleet: Fleet, gaps: list[list[str]]) -> None:
    text = to_toml(fleet)
    assert parse_fleet(PATH, text) == fleet
    assert parse_fleet(PATH, scattered(text, gaps)) == fleet
    assert to_toml(parse_fleet(PATH, text)) == text


@given(fleets(at_least=1), st.lists(COMMENTS, min_size=1, max_size=5))
def test_every_robot_knows_its_line(fleet: Fleet, gaps: list[list[str]]) -> None:
    text = scattered(to_toml(fleet), gaps)
    lines = text.split("\n")
    assert [lines[robot.line - 1] for robot in parse_fleet(PATH, text).robots] == (
        ["[[robot]]"] * len(fleet.robots)
    )


@given(st.data(), fleets(at_least=1), st.lists(COMMENTS, min_size=1, max_size=5))
def test_every_wrong_value_is_told_with_its_line(
    data: st.DataObject, fleet: Fleet, gaps: list[list[str]]
) -> None:
    lines = scattered(to_toml(fleet), gaps).split("\n")
    index = data.draw(st.integers(0, len(fleet.robots) - 1))
    heads = [number for number, line in enumerate(lines) if line == "[[robot]]"]
    head = heads[index]
    key = data.draw(st.sampled_from(sorted(WRONG)))
    entry = f"{key} = {data.draw(st.sampled_from(WRONG[key]))}"
    end = next((n for n in range(head + 1, len(lines)) if lines[n].startswith("[")), len(lines))
    old = [n for n in range(head, end) if lines[n].startswith(f"{key} = ")]
    at = old[0] if old else head + 1
    lines[at : at + bool(old)] = [entry]
    complaint = refusal("\n".join(lines))
    assert complaint.startswith(f"{PATH}:{at + 1}: robot[{index}].{key}: "), complaint


@given(st.data(), fleets(at_least=1), st.sampled_from(["nme", "addr", "x", "a.b", "Name"]))
def test_every_unknown_key_is_told_with_its_line(
    data: st.DataObject, fleet: Fleet, key: str
) -> None:
    lines = to_toml(fleet).split("\n")
    heads = [n for n, line in enumerate(lines) if line in {"[[robot]]", "[defaults]", "[operator]"}]
    at = data.draw(st.sampled_from(heads)) + 1
    lines.insert(at, f"{key} = 1")
    complaint = refusal("\n".join(lines))
    assert complaint.startswith(f"{PATH}:{at + 1}: ")
    assert f".{key.split('.', maxsplit=1)[0]}: unknown key, " in complaint


@given(fleets(at_least=2), st.data())
def test_whatever_two_robots_share_is_told_with_the_second(
    fleet: Fleet, data: st.DataObject
) -> None:
    first, second = data.draw(
        st.lists(st.integers(0, len(fleet.robots) - 1), min_size=2, max_size=2, unique=True).map(
            sorted
        )
    )
    key = data.draw(st.sampled_from(["name", "address"]))
    lines = to_toml(fleet).split("\n")
    entries = [n for n, line in enumerate(lines) if line.startswith(f"{key} = ")]
    entries = [n for n in entries if n > lines.index("[[robot]]")]
    lines[entries[second]] = lines[entries[first]]
    groups = lines.index("[groups]")
    complaint = refusal("\n".join(lines[:groups]))
    assert complaint.startswith(f"{PATH}:{entries[second] + 1}: robot[{second}].{key}: ")
    assert f" is robot[{first}]'s already" in complaint


@given(fleets(), st.sampled_from(["= 1", "a", "[", '"', "x = ", "[[robot]", "A = 1\nA = 2"]))
def test_what_is_no_toml_is_told_with_its_line(fleet: Fleet, broken: str) -> None:
    text = to_toml(fleet)
    last = text.count("\n") + 1 + broken.count("\n")
    assert refusal(text + broken + "\n").startswith(f"{PATH}:{last}: not valid TOML: ")


PIECES = st.one_of(
    st.text(max_size=6),
    st.sampled_from(
        ["[[robot]]\n", "[operator]\n", "[groups]\n", 'name = "a"\n', 'address = "10.0.0.1"\n']
    ),
    st.sampled_from(
        ["[", "]", "{", "}", "=", '"', "\n", "robot", "groups", "ros = 1\n", "a = []\n"]
    ),
)


@given(st.lists(PIECES, max_size=20).map("".join))
def test_any_text_is_a_fleet_or_a_complaint_in_one_line(text: str) -> None:
    try:
        fleet = parse_fleet(PATH, text)
    except ConfigError:
        assert refusal(text).startswith(f"{PATH}:")
    else:
        assert parse_fleet(PATH, to_toml(fleet)) == fleet


@given(fleets(), st.data())
def test_a_selection_has_each_robot_once_in_the_order_of_the_file(
    fleet: Fleet, data: st.DataObject
) -> None:
    names = [robot.name for robot in fleet.robots]
    known = [*names, *fleet.groups, "all"]
    chosen = data.draw(st.lists(st.sampled_from(known)))
    selected = [robot.name for robot in fleet.select(chosen)]
    meant = set(chosen) & set(names)
    meant.update(*(fleet.groups[name] for name in chosen if name in fleet.groups))
    assert selected == [name for name in names if name in meant or "all" in chosen]


@given(fleets(), st.text(max_size=12))
def test_an_unknown_name_is_refused(fleet: Fleet, name: str) -> None:
    assume(name not in {*(robot.name for robot in fleet.robots), *fleet.groups, "all"})
    with pytest.raises(ConfigError) as caught:
        fleet.select([name])
    assert repr(name) in str(caught.value) or not (fleet.robots or fleet.groups)


def refusal(text: str) -> str:
    """Return the one-line error about a fleet file."""
    with pytest.raises(ConfigError) as caught:
        parse_fleet(PATH, text)
    assert str(caught.value).isprintable()
    return str(caught.value)
