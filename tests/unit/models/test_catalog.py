"""Shipped models against facts.md 6.2 and 6.4, and the ways to ask for one."""

import os
from dataclasses import FrozenInstanceError
from math import inf, nan, pi, radians
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import (
    IrMount,
    LaserMount,
    RobotModel,
    SonarMount,
    find_model,
    generic_model,
    load_model,
    model_names,
)

NAMES = ("amigo-sh", "p3at", "p3at-sh", "p3dx", "p3dx-sh", "peoplebot-sh")


FIGURES = Path(__file__).parents[4] / "shared/robots.tsv"


def test_every_type_that_parameter_files_describe_is_shipped() -> None:
    assert len(model_names()) == 49
    assert {*NAMES, "p2at", "p2dx", "pion1m", "perfpb+", "powerbot", "seekur"} <= {*model_names()}


@pytest.mark.skipif(not FIGURES.is_file(), reason="no figures beside this tree")
def test_units_sizes_and_sonars_are_those_of_each_parameter_file() -> None:
    heading, *rows = [
        line.split("\t") for line in FIGURES.read_text().splitlines() if not line.startswith("#")
    ]
    for row in rows:
        figure = dict(zip(heading, row, strict=True))
        model = load_model(figure["file"])
        assert figure["Subclass"].lower() == model.name, figure["file"]
        for key, value in (
            ("DistConvFactor", model.distance_factor),
            ("VelConvFactor", model.speed_factor),
            ("RangeConvFactor", model.range_factor),
            ("Vel2Divisor", model.vel2_unit),
            ("RobotRadius", model.radius),
            ("RobotWidth", model.width),
        ):
            assert value * 1000 == pytest.approx(float(figure[key])), (model.name, key)
        assert model.heading_factor == pytest.approx(float(figure["AngleConvFactor"]), rel=0.005)
        assert model.wheel_base == pytest.approx(2 / float(figure["DiffConvFactor"]) / 1000)
        assert model.max_speed * 1000 <= float(figure["MaxVelocity"]) + 1e-9
        assert model.has_move_command == (figure["HasMoveCommand"] == "true")
        sonars = [tuple(map(float, unit.split(","))) for unit in figure[heading[-1]].split()]
        assert [(s.x * 1000, s.y * 1000) for s in model.sonars] == [
            pytest.approx(place[:2]) for place in sonars
        ], model.name


@pytest.mark.parametrize(
    ("name", "distance_mm", "speed_mm", "range_mm", "units", "baud"),
    [
        ("p2at", 1.32, 1, 0.268, 4096, 38400),
        ("p2d8", 0.485, 1, 1, 4096, 38400),
        ("p2pb", 0.424, 1, 0.268, 4096, 38400),
        ("amigo", 0.5083, 0.6154, 1, 4096, 38400),
        ("powerbot", 0.5813, 1, 1, 4096, 38400),
        ("pion1m", 0.05066, 2.5332, 0.1734, 1024, 0),
        ("pionat", 0.07, 2.5332, 0.1734, 1024, 0),
    ],
)
def test_old_robots_count_in_their_own_units(
    *, name: str, distance_mm: float, speed_mm: float, range_mm: float, units: int, baud: int
) -> None:
    model = load_model(name)
    factors = (model.distance_factor, model.speed_factor, model.range_factor)
    assert factors == pytest.approx((distance_mm / 1000, speed_mm / 1000, range_mm / 1000))
    assert (model.heading_factor, model.switch_speed) == (2 * pi / units, baud)


@pytest.mark.parametrize("name", NAMES)
def test_a_shipped_model_loads_under_its_own_name(name: str) -> None:
    assert load_model(name).name == name


@pytest.mark.parametrize(
    ("name", "title", "drive", "radius", "width", "front", "rear", "speed", "turn_rate_deg"),
    [
        ("p3at-sh", "Pioneer 3-AT", "skid", 0.5, 0.505, 0.313, 0.313, 1.2, 300),
        ("p3at", "Pioneer 3-AT", "skid", 0.5, 0.505, 0.313, 0.313, 1.2, 300),
        ("p3dx-sh", "Pioneer 3-DX", "differential", 0.25, 0.425, 0.21, 0.301, 2.2, 500),
        ("p3dx", "Pioneer 3-DX", "differential", 0.25, 0.425, 0.21, 0.301, 2.2, 500),
        ("amigo-sh", "AmigoBot", "differential", 0.18, 0.279, 0.16, 0.17, 1.0, 300),
        ("peoplebot-sh", "PeopleBot", "differential", 0.34, 0.425, 0.2565, 0.2565, 2.2, 500),
    ],
)
def test_sizes_and_limits_are_those_of_the_parameter_files(
    *,
    name: str,
    title: str,
    drive: str,
    radius: float,
    width: float,
    front: float,
    rear: float,
    speed: float,
    turn_rate_deg: float,
) -> None:
    model = load_model(name)
    assert (model.title, model.family, model.drive) == (title, "Pioneer", drive)
    assert (model.radius, model.width) == (radius, width)
    assert (model.length_front, model.length_rear) == (front, rear)
    assert model.length == front + rear
    assert (model.max_speed, model.max_turn_rate) == (speed, radians(turn_rate_deg))


@pytest.mark.parametrize(
    ("name", "distance_mm", "diff_conv_factor"),
    [
        ("p3at-sh", 1, 0.0034),
        ("p3at", 0.465, 0.0034),
        ("p3dx-sh", 1, 0.0056),
        ("p3dx", 0.485, 0.0056),
        ("amigo-sh", 1, 0.011),
        ("peoplebot-sh", 1, 0.006),
    ],
)
def test_factors_are_those_of_the_parameter_files(
    name: str, distance_mm: float, diff_conv_factor: float
) -> None:
    model = load_model(name)
    assert model.distance_factor == pytest.approx(distance_mm / 1000, rel=1e-12)
    assert model.wheel_base == pytest.approx(2 / diff_conv_factor / 1000, rel=1e-9)
    assert model.heading_factor == 2 * pi / 4096
    assert (model.speed_factor, model.range_factor, model.vel2_unit) == (0.001, 0.001, 0.02)
    assert model.gyro_scaler == 1.626


@pytest.mark.parametrize("name", NAMES)
def test_what_the_robot_starts_with_and_how_it_is_spoken_to(name: str) -> None:
    model = load_model(name)
    assert (model.acceleration, model.deceleration) == (0.3, 0.3)
    assert model.turn_acceleration == model.turn_deceleration == radians(100)
    assert model.has_move_command
    assert model.settable_speed
    assert model.settable_acceleration
    assert not model.request_encoders
    assert model.switch_speed == 38400
    assert model.request_io == (name == "peoplebot-sh")


@pytest.mark.parametrize(
    ("name", "count", "number", "x", "y", "theta_deg"),
    [
        ("p3at-sh", 16, 0, 0.147, 0.136, 90),
        ("p3at", 16, 9, -0.189, -0.119, -130),
        ("p3dx-sh", 16, 3, 0.166, 0.027, 10),
        ("p3dx", 16, 15, -0.157, 0.136, 90),
        ("amigo-sh", 8, 6, -0.146, -0.058, -145),
        ("peoplebot-sh", 32, 27, -0.29, -0.027, -170),
    ],
)
def test_sonars_sit_where_the_parameter_files_put_them(
    *, name: str, count: int, number: int, x: float, y: float, theta_deg: float
) -> None:
    sonars = load_model(name).sonars
    assert len(sonars) == count
    assert sonars[number] == SonarMount(x, y, radians(theta_deg))


@pytest.mark.parametrize("name", [name for name in NAMES if name != "amigo-sh"])
def test_sonars_are_symmetric_left_and_right(name: str) -> None:
    """A typing error would break it; in amigo-sh the source has x 125 left and 120 right."""
    sonars = load_model(name).sonars
    mirrored = {(s.x, -s.y, round(-s.theta, 9)) for s in sonars}
    assert mirrored == {(s.x, s.y, round(s.theta, 9)) for s in sonars}


@pytest.mark.parametrize(
    ("name", "x"),
    [
        ("p3at-sh", 0.125),
        ("p3at", 0.16),
        ("p3dx-sh", 0.021),
        ("p3dx", 0.018),
        ("peoplebot-sh", 0.021),
    ],
)
def test_lasers_sit_where_the_parameter_files_put_them(name: str, x: float) -> None:
    assert load_model(name).laser == LaserMount(kind="lms2xx", x=x, y=0.0, theta=0.0)


def test_an_amigobot_has_no_laser() -> None:
    assert load_model("amigo-sh").laser is None


def test_only_the_peoplebot_has_bumpers_and_table_sensors() -> None:
    for name in NAMES:
        model = load_model(name)
        count = 5 if name == "peoplebot-sh" else 0
        assert (model.front_bumpers, model.rear_bumpers) == (count, count)
        assert bool(model.table_irs) == (name == "peoplebot-sh")
    assert load_model("peoplebot-sh").table_irs[2] == IrMount(-0.002, -0.116)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("P3AT-SH", "p3at-sh"),
        ("  p3dx ", "p3dx"),
        ("p3dx-sh-LMS1xx", "p3dx-sh-lms1xx"),
        ("researchPB", "researchpb"),
        ("amigo-sh-lab", "amigo-sh"),
        ("peoplebot-sh-lab", "peoplebot-sh"),
    ],
)
def test_case_and_laser_suffixes_do_not_matter(asked: str, found: str) -> None:
    model = find_model(asked)
    assert model is not None
    assert model.name == found
    assert load_model(asked) == model


def test_a_laser_suffix_changes_the_laser() -> None:
    laser = load_model("p3at-sh-lms1xx").laser
    assert laser == LaserMount(kind="lms1XX", x=0.197, y=0.0, theta=0.0)


@pytest.mark.parametrize(
    "subtype", ["", "amigos", "p3at-hs", "p2", "seekur-xl", "../p3at", "\x00", "-"]
)
def test_an_unknown_subtype_has_no_model(subtype: str) -> None:
    assert find_model(subtype) is None


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match=r"'p3at-hs'.*did you mean p3at-sh\?"):
        load_model("p3at-hs")


@pytest.mark.parametrize("name", ["", "robot.yaml", "\x1b[31m", "/"])
def test_a_nonsense_name_is_refused_on_one_printable_line(name: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_model(name)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("suffix", [".p", ".toml"])
@pytest.mark.parametrize("kind", ["missing", "directory", "binary", "pipe", "huge"])
def test_what_cannot_be_read_is_named(tmp_path: Path, kind: str, suffix: str) -> None:
    path = tmp_path / f"robot{suffix}"
    match kind:
        case "directory":
            path.mkdir()
        case "binary":
            path.write_bytes(bytes(range(256)))
        case "pipe":
            os.mkfifo(path)
        case "huge":
            path.write_text("; comment\n" * 200_000)
    with pytest.raises(ConfigError) as caught:
        load_model(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_is_named(tmp_path: Path) -> None:
    path = tmp_path / "robot.p"
    path.write_text("")
    path.chmod(0)
    with pytest.raises(ConfigError, match="cannot read this model file: Permission denied"):
        load_model(path)


def test_a_path_with_a_nul_is_refused() -> None:
    with pytest.raises(ConfigError, match="cannot read"):
        load_model("robot\x00.p")


def test_a_model_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        load_model("p3at").radius = 1.0  # type: ignore[misc]


def test_a_generic_model_has_modern_factors_and_knows_no_sonars() -> None:
    model = generic_model("p9xx", max_speed=0.9, max_turn_rate=2.0)
    assert (model.name, model.max_speed, model.max_turn_rate) == ("p9xx", 0.9, 2.0)
    assert (model.distance_factor, model.heading_factor) == (0.001, 2 * pi / 4096)
    assert (model.sonars, model.laser, model.front_bumpers) == ((), None, 0)


def test_a_generic_model_is_as_large_as_the_largest_common_one() -> None:
    model = generic_model("p9xx", max_speed=0.9, max_turn_rate=2.0)
    shipped = [load_model(name) for name in NAMES]
    assert model.radius >= max(m.radius for m in shipped)
    assert model.width >= max(m.width for m in shipped)
    assert min(model.length_front, model.length_rear) >= max(m.length_rear for m in shipped)


@pytest.mark.parametrize("value", [0.0, -1.0, nan, inf, 1e-12, 174.5])
def test_a_generic_model_survives_whatever_a_robot_says(value: float) -> None:
    model = generic_model("\x00", max_speed=value, max_turn_rate=value)
    assert isinstance(model, RobotModel)
    assert model.name == "unknown"


def test_zeros_of_a_short_config_become_what_a_real_robot_starts_with() -> None:
    model = generic_model("p9xx", max_speed=0, max_turn_rate=0)
    assert (model.max_speed, model.max_turn_rate) == (0.75, radians(100))
    assert model.deceleration == 0.3
