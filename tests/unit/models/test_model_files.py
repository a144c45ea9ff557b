"""TOML model files: what is wrong is named by file and key."""

import re
from dataclasses import replace
from math import pi, radians
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel, load_model
from pioneer3.models.catalog import parse_model

SHIPPED = Path(__file__).with_name("full.toml").read_text(encoding="utf-8")
MINIMAL = """
name = "lab"
title = "Lab robot"
radius = 1
width = 0.5
length_front = 0.3
length_rear = 0.3
max_speed = 1.0
max_turn_rate_deg = 90
wheel_base = 0.4
distance_factor = 0.001
"""


def test_a_file_is_read_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "mine.TOML"
    path.write_text(SHIPPED)
    assert load_model(path) == load_model(str(path)) == load_model("p3at-sh")


def test_what_every_modern_robot_shares_may_be_left_out() -> None:
    model = parse_model(MINIMAL, "lab.toml")
    assert (model.radius, model.max_turn_rate) == (1.0, radians(90))
    assert (model.heading_factor, model.vel2_unit) == (2 * pi / 4096, 0.02)
    assert (model.sonars, model.laser, model.drive) == ((), None, "differential")


def test_a_file_that_is_like_a_shipped_model_says_what_differs() -> None:
    model = parse_model(
        'like = "p2at"\nmax_speed = 0.5\n[laser]\nkind = "tim5XX"\nx = 0.2\ny = 0\ntheta_deg = 0',
        "my.toml",
    )
    assert model.laser is not None
    assert (model.max_speed, model.laser.x) == (0.5, 0.2)
    assert replace(model, max_speed=1.2, laser=None) == load_model("p2at")


@pytest.mark.parametrize("kin", ['"p2att"', "7", '"../p2at"'])
def test_a_file_that_is_like_nothing_known_is_refused(kin: str) -> None:
    told = str(outcome(f"width = 0.5\nlike = {kin}"))
    assert told.startswith("my.toml:2: like: ")
    assert "no such robot model" in told


def test_a_backward_sonar_is_wrapped_like_every_angle() -> None:
    text = MINIMAL + "sonars = [{ x = 0, y = 0, theta_deg = -180 }]"
    assert parse_model(text, "lab.toml").sonars[0].theta == pi


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius = 0.5", "radius = 500", "radius: 500 is out of range, expected 0.01 to 10"),
        ("radius = 0.5", "radius = -0.5", "radius: -0.5 is out of range, expected 0.01 to 10"),
        ("radius = 0.5", "radius = nan", "radius: nan is out of range, expected 0.01 to 10"),
        ("radius = 0.5", 'radius = "5"', "radius: expected a number, got '5'"),
        ("radius = 0.5", "raduis = 0.5", "raduis: unknown key, did you mean radius?"),
        ("radius = 0.5", "", "radius: missing, add it"),
        ("max_turn_rate_deg = 300", "max_turn_rate_deg = 1e9", "max_turn_rate_deg: 1e+09 is out"),
        (
            "max_turn_rate_deg = 300",
            "max_turn_rate_deg = true",
            "max_turn_rate_deg: expected a number, got True",
        ),
        (
            "max_turn_rate_deg = 300",
            "max_turn_rate = 5",
            "max_turn_rate: unknown key, did you mean max_turn_rate_deg?",
        ),
        ("max_turn_rate_deg = 300", "", "max_turn_rate_deg: missing, add it"),
        ("heading_units = 4096", "heading_units = 0", "heading_units: 0 is out of range"),
        (
            "heading_units = 4096",
            "heading_factor = 0.0015",
            "heading_factor: unknown key, did you mean heading_units?",
        ),
        ('"skid"', '"tank"', "drive: 'tank' is not one of skid, differential"),
        ('"p3at-sh"', '""', "name: expected a text that is not empty, got ''"),
        ("= 38400", "= 4800", "switch_speed: 4800 is not one of 0, 9600"),
        ("front_bumpers = 0", "front_bumpers = 8", "front_bumpers: 8 is out of range"),
        (
            "front_bumpers = 0",
            "front_bumpers = 2.5",
            "front_bumpers: expected a whole number, got 2.5",
        ),
        ("request_io = false", "request_io = 0", "request_io: expected true or false, got 0"),
        ("x = 0.147,", "", "sonars[0].x: missing, add it"),
        ("x = 0.147,", "z = 0.147,", "sonars[0].z: unknown key, known are x, y, theta_deg"),
        ("x = 0.193,", "x = 193,", "sonars[1].x: 193 is out of range, expected -10 to 10"),
        ("theta_deg = 50", "theta_deg = 500", "sonars[1].theta_deg: 500 is out of range"),
        ("sonars = [", "sonars = [7,", "sonars[0]: expected a table, got 7"),
        ("sonars = [", "sonars = 7\nsonar = [", "sonar: unknown key, did you mean sonars?"),
        ("front_bumpers = 0", "table_irs = [[1]]", "table_irs[0]: expected two numbers"),
        ("front_bumpers = 0", "table_irs = [[1, 20]]", "table_irs[0][1]: 20 is out of range"),
        ("kind =", "type =", "laser.type: unknown key, known are kind, x, y, theta_deg"),
        ('"lms2xx"', '""', "laser.kind: expected a text that is not empty, got ''"),
        ("family =", '"\\u001b" =', r"'\x1b': unknown key"),
        ("radius = 0.5", "radius =", "not valid TOML: Invalid value (column "),
        ("radius = 0.5", "radius = " + "[" * 5000, "not valid TOML: "),
        ("radius = 0.5", "radius = 1" + "0" * 400, "radius: "),
        ("_rate_deg = 300", "_rate_deg = 1" + "0" * 400, "max_turn_rate_deg: a huge number is out"),
    ],
)
def test_what_is_wrong_is_named(old: str, new: str, message: str) -> None:
    assert old in SHIPPED
    with pytest.raises(ConfigError) as caught:
        parse_model(SHIPPED.replace(old, new, 1), "my.toml")
    place, said = str(caught.value).split(" ", maxsplit=1)
    assert re.fullmatch(r"my\.toml:(\d+:)?", place)
    assert said.startswith(message)
    assert str(caught.value).isprintable()


def test_what_is_wrong_is_found_by_its_line() -> None:
    result = outcome(MINIMAL.replace("width = 0.5", "width = 500"))
    assert result == "my.toml:5: width: 500 is out of range, expected 0.01 to 10"
    assert str(outcome("name = 1")).startswith("my.toml:1: name: expected a text")


JUNK = st.one_of(
    st.none(),
    st.sampled_from(["''", "'x'", "true", "[]", "{}", "[{}]", "[[]]", "nan", "inf", "1979-05-27"]),
    st.floats().map(repr),
    st.integers().map(repr),
)


@given(st.lists(st.tuples(st.sampled_from(SHIPPED.splitlines()), JUNK), max_size=60))
def test_any_mixture_of_lines_gives_a_model_or_names_the_file(
    lines: list[tuple[str, str | None]],
) -> None:
    text = "\n".join(s if v is None else f"{s.partition('=')[0]} = {v}" for s, v in lines)
    result = outcome(text)
    assert isinstance(result, RobotModel) or result.startswith("my.toml:")


def outcome(text: str) -> RobotModel | str:
    try:
        return parse_model(text, "my.toml")
    except ConfigError as error:
        return str(error)
