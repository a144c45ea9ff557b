"""The own file of a robot: found by its name or serial number, and as short as what differs."""

from dataclasses import replace
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import OdometryCorrection, load_model
from pioneer3.models.aria import NOT_IN_FILES, aria_text, parse_aria
from pioneer3.models.catalog import parse_own
from pioneer3.models.model import OwnLaser
from pioneer3.models.numbers import numbers_of
from pioneer3.models.own import find_own, new_own_text, own_files, own_folder, own_path

KIN = load_model("p3at-sh")
TWO_LASERS = """
camera = "http://127.0.0.1:8080/stream"

[[lasers]]
port = "/dev/ttyACM0"
kind = "urg-04lx"
x = 0.16
y = 0
theta_deg = 0

[[lasers]]
port = "tcp://10.0.0.2:2111"
kind = "tim5XX"
x = -0.2
y = 0
theta_deg = 180
upside_down = true
"""


def save(name: str, text: str) -> Path:
    path = own_folder() / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_it_is_found_by_the_name_before_the_serial_number() -> None:
    save("4711.toml", "max_speed = 0.4")
    assert find_own(("rosie", "4711"), KIN) is not None
    path = save("rosie.toml", "max_speed = 0.5")
    own = find_own(("rosie", "4711"), KIN)
    assert own is not None
    assert (own.path, own.model.max_speed, own.model.name) == (path, 0.5, "p3at-sh")
    assert own_files() == (own_folder() / "4711.toml", path)
    assert find_own(("bob", ""), KIN) is None


@pytest.mark.parametrize("name", ["", "  ", ".", "..", "../fleet", "a/b", "a\x00b", "\x1b[2J"])
def test_a_name_that_leaves_the_folder_has_no_file(name: str) -> None:
    save("../fleet.toml", "max_speed = 0.1")
    assert own_path(name) is None
    assert find_own((name,), KIN) is None


def test_without_a_known_type_it_says_what_it_is_like() -> None:
    save("old.toml", 'like = "p2at"\nmax_speed = 0.5')
    own = find_own(("old",), None)
    assert own is not None
    assert (own.model.distance_factor, own.model.max_speed) == (0.00132, 0.5)
    path = save("odd.toml", "max_speed = 0.5")
    with pytest.raises(ConfigError, match=f"{path}: like: missing; .*p3at-sh"):
        find_own(("odd",), None)


def test_it_has_lasers_of_which_the_first_is_that_of_the_model() -> None:
    own = parse_own(TWO_LASERS, "rosie.toml", KIN)
    assert own.camera == "http://127.0.0.1:8080/stream"
    assert [laser.port for laser in own.lasers] == ["/dev/ttyACM0", "tcp://10.0.0.2:2111"]
    assert own.model.laser == own.lasers[0].mount
    assert own.lasers[1].mount.upside_down


def test_it_may_be_given_as_a_model_too(tmp_path: Path) -> None:
    path = tmp_path / "rosie.toml"
    path.write_text('like = "p3at-sh"\n' + TWO_LASERS)
    assert load_model(path).laser == parse_own(TWO_LASERS, "rosie.toml", KIN).model.laser


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[[lasers]]\nport = 7", r"rosie.toml:2: lasers\[0\].port: expected a text"),
        ("[[lasers]]\nkind = 'a'", r"rosie.toml:1: lasers\[0\].port: missing"),
        ("lasers = 3", "rosie.toml:1: lasers: expected"),
        ("camera = 3", "rosie.toml:1: camera: expected a text"),
        ("lazers = []", "rosie.toml:1: lazers: unknown key, did you mean lasers?"),
        ("max_speed = 99", "rosie.toml:1: max_speed: 99 is out of range"),
        (
            "[odometry]\nscale = 12",
            r"rosie.toml:2: odometry\.scale: 12 is out of range, expected 0.8 to 1.25",
        ),
        (
            "[odometry]\nwheels = 1.1",
            r"rosie.toml:2: odometry\.wheels: unknown key, known are scale",
        ),
    ],
)
def test_what_is_wrong_in_it_is_named_by_line(text: str, complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        parse_own(text, "rosie.toml", KIN)


def test_it_has_the_errors_of_its_odometry() -> None:
    own = parse_own("[odometry]\nscale = 0.94\nwheel_ratio = 1.01", "rosie.toml", KIN)
    assert own.model.odometry == OdometryCorrection(scale=0.94, wheel_ratio=1.01)
    assert KIN.odometry.matrix(KIN.wheel_base) is None
    rows = {row.name: row.value for row in numbers_of(own.model, shipped=False)}
    assert (rows["scale"], rows["base_ratio"], rows["wheel_ratio"]) == ("0.94", "1", "1.01")
    assert "scale" not in {row.name for row in numbers_of(KIN, shipped=True)}
    with pytest.raises(ConfigError, match=r"odometry\.base_ratio: nan is out of range"):
        OdometryCorrection(base_ratio=float("nan"))


def test_a_new_file_gives_back_what_it_was_made_of() -> None:
    lasers = parse_own(TWO_LASERS, "", KIN).lasers
    text = new_own_text("rosie\n", "p2at", lasers, "http://h/s")
    own = parse_own(text, "rosie.toml")
    assert (own.lasers, own.camera) == (lasers, "http://h/s")
    assert own.model.distance_factor == 0.00132
    assert parse_own(new_own_text("rosie", "p2at", (), None), "").model == load_model("p2at")


def test_an_example_in_a_new_file_counts_without_its_comment_sign() -> None:
    text = new_own_text("rosie", "p3at-sh", (), None).replace("\n# ", "\n")
    own = parse_own(text, "rosie.toml")
    assert isinstance(own.lasers[0], OwnLaser)
    assert (own.model.max_speed, own.camera) == (0.7, "http://192.168.0.30:8080/stream")


def test_a_parameter_file_beside_it_has_what_differs_from_the_type() -> None:
    save("rosie.p", "DistConvFactor 1.01\nSection Laser parameters\nLaserX 99\n")
    own = find_own(("rosie",), KIN)
    assert own is not None
    assert own.model.laser is not None
    assert (own.model.distance_factor, own.model.laser.x) == (0.00101, 0.099)
    assert own.model.sonars == KIN.sonars
    save("rosie.p", "DistConvFactor 1e9")
    with pytest.raises(ConfigError, match=r"rosie\.p:1: DistConvFactor: "):
        find_own(("rosie",), KIN)
    save("rosie.toml", "")
    assert find_own(("rosie",), KIN) is not None


def test_a_short_parameter_file_keeps_what_its_type_has() -> None:
    save("rosie.p", "RobotLength 700\n")
    base = replace(KIN, title="Rosie", drive="differential", controller="P2OS", braking=0.7)
    own = find_own(("rosie",), base)
    assert own is not None
    assert (own.model.length_front, own.model.length_rear) == (0.35, 0.35)
    parts = ("title", "drive", "controller", "braking", "radius")
    assert [getattr(own.model, part) for part in parts] == [getattr(base, part) for part in parts]
    save("rosie.p", "RobotLength 700\nRobotLengthFront 300\nRobotLengthRear 400\n")
    own = find_own(("rosie",), base)
    assert own is not None
    assert (own.model.length_front, own.model.length_rear) == (0.3, 0.4)


@pytest.mark.parametrize("name", ["p3at-sh", "p2pb", "peoplebot-sh", "pion1m", "wheelchair-sh"])
def test_a_model_written_as_a_parameter_file_is_read_back(name: str) -> None:
    model = load_model(name)
    read = parse_aria(aria_text(model), "x.p", "x")
    assert (read.sonars, read.table_irs, read.laser) == (model.sonars, model.table_irs, model.laser)
    told = {field: getattr(model, field) for field in NOT_IN_FILES}
    assert parse_aria("", "x.p", "x", model) == replace(read, **told)
    for field in ("width", "distance_factor", "heading_factor", "switch_speed", "max_turn_rate"):
        assert getattr(read, field) == pytest.approx(getattr(model, field)), field


@pytest.mark.parametrize("name", ["a" * 251, "\u00e9" * 126])
def test_a_name_too_long_for_a_file_has_none(name: str) -> None:
    assert find_own((name,), KIN) is None
    assert own_path(name) is None
    assert own_path(name[:-1]) is not None


def test_a_folder_that_cannot_be_read_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", "/" + "a" * 300)
    with pytest.raises(ConfigError, match=r"rosie\.toml: cannot be read: File name too long"):
        find_own(("rosie",), KIN)


def test_a_link_to_a_file_that_is_gone_is_told() -> None:
    path = save("rosie.toml", "")
    path.unlink()
    path.symlink_to("gone.toml")
    with pytest.raises(ConfigError, match="cannot read this model file: No such file"):
        find_own(("rosie",), KIN)
