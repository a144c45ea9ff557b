"""What is fitted to robots, in world files and on the command line."""

from dataclasses import fields
from math import radians
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.equipment import EquipmentOptions as Options
from pioneer3.sim.worldfile import parse_equipment, parse_world, to_toml
from pioneer3.tables import keys

AT, PEOPLEBOT = load_model("p3at-sh"), load_model("peoplebot-sh")
ALL = """{ gripper = true, compass = true, gyro = 2, bumpers = 4, joystick = true, camera = "sony",
camera_port = 3, picture_port = 8190, picture_width = 160, picture_height = 120, picture_rate = 5,
table_ir = "old", north_deg = 45, compass_noise_deg = 1.5,
gyro_bias_deg_s = -0.5, gyro_noise_deg_s = 0.25 }""".replace("\n", " ")
READ = Options(
    gripper=True,
    compass=True,
    gyro_type=2,
    bumpers=4,
    joystick=True,
    camera="sony",
    camera_port=3,
    picture_port=8190,
    picture_width=160,
    picture_height=120,
    picture_rate=5.0,
    table_ir="old",
    north=radians(45),
    compass_noise=radians(1.5),
    gyro_bias=radians(-0.5),
    gyro_noise=radians(0.25),
)


def test_every_choice_of_the_equipment_can_be_made() -> None:
    on_the_model = {"bumpers"}
    choices = {field.name for field in fields(Options)} - on_the_model
    assert choices == {field.name for field in fields(Equipment)}
    assert len(keys(Options)) == len(fields(Options))


def test_a_world_file_says_what_is_fitted(tmp_path: Path) -> None:
    world = parse_world(tmp_path / "w.toml", f"[world]\n[[robot]]\nequipment = {ALL}\n[[robot]]")
    assert world.robots[0].equipment == READ
    assert world.robots[1].equipment == Options()
    assert parse_world(tmp_path / "w.toml", to_toml(world, tmp_path)) == world


def test_what_is_not_said_is_as_the_model_comes() -> None:
    assert Options().equipment_of(AT) == Equipment.of(AT) == Equipment()
    assert Options(gripper=True).equipment_of(PEOPLEBOT) == Equipment(gripper=True, table_ir="new")
    assert Options(table_ir="none").equipment_of(PEOPLEBOT).table_ir is None
    assert Options(table_ir="old").equipment_of(PEOPLEBOT).table_ir == "old"
    assert (
        Options(camera="vcc4").overridden_by(Options(camera="none")).equipment_of(AT).camera is None
    )


def test_all_of_it_reaches_the_robot() -> None:
    fitted = READ.equipment_of(AT)
    for field in fields(Equipment):
        assert getattr(fitted, field.name) == getattr(READ, field.name)
    model = READ.model_with(AT)
    assert (model.front_bumpers, model.rear_bumpers) == (4, 4)
    assert Options().model_with(AT) == AT
    assert Options(bumpers=0).model_with(PEOPLEBOT).front_bumpers == 0


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("", Options()),
        ("gripper", Options(gripper=True)),
        ("gripper=false", Options(gripper=False)),
        ("gyro", Options(gyro_type=1)),
        ("bumpers", Options(bumpers=5)),
        ("bumpers=7", Options(bumpers=7)),
        ("gyro=2", Options(gyro_type=2)),
        ("table-ir", Options(table_ir="new")),
        (" compass , joystick,", Options(compass=True, joystick=True)),
        (
            "gripper,compass,gyro,joystick,camera=vcc4,table-ir=new",
            Options(
                gripper=True,
                compass=True,
                gyro_type=1,
                joystick=True,
                camera="vcc4",
                table_ir="new",
            ),
        ),
        ("camera=sony,camera-port=2", Options(camera="sony", camera_port=2)),
        (
            "north-deg=90,gyro_noise_deg_s=0.1",
            Options(north=radians(90), gyro_noise=radians(0.1)),
        ),
    ],
)
def test_the_command_line_fits_with_the_same_words(text: str, options: Options) -> None:
    assert parse_equipment(text) == options


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("griper", "--fit: griper: unknown key, did you mean gripper?"),
        ("camera", "--fit: camera: needs a value, such as camera=vcc4"),
        ("camera=canon", "--fit: camera: 'canon' is not one of vcc4, sony, none"),
        ("camera=1", "--fit: camera: expected a text, got 1"),
        ("camera_port", "--fit: camera_port: needs a value, such as camera-port=1"),
        ("camera-port=4", "--fit: camera_port: 4 is out of range, expected 1 to 3"),
        ("gyro=3", "--fit: gyro: 3 is out of range, expected 0 to 2"),
        ("gyro=on", "--fit: gyro: expected a whole number, got 'on'"),
        ("gripper=yes", "--fit: gripper: expected true or false, got 'yes'"),
        ("compass_noise_deg=-1", "--fit: compass_noise_deg: -1 is out of range"),
        ("north_deg=nan", "--fit: north_deg: nan is out of range"),
        ("=1", "--fit: ''"),
    ],
)
def test_a_wrong_word_is_named(text: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_equipment(text)
    assert str(caught.value).startswith(complaint)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("equipment", "complaint"),
    [
        ("'gripper'", "w.toml:3: robot[0].equipment: expected a table, got 'gripper'"),
        ("{ griper = 1 }", "w.toml:3: robot[0].equipment.griper: unknown key, did you mean gri"),
        ("{ gyro = 9 }", "w.toml:3: robot[0].equipment.gyro: 9 is out of range, expected 0 to 2"),
        ("{ camera = 'x' }", "robot[0].equipment.camera: 'x' is not one of vcc4, sony, none"),
    ],
)
def test_a_wrong_key_is_named_with_its_line(tmp_path: Path, equipment: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_world(tmp_path / "w.toml", f"[world]\n[[robot]]\nequipment = {equipment}")
    assert complaint in str(caught.value)
