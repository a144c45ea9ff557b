"""The model of a robot whose type is not known, and that has a file of its own."""

from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import Fallback
from pioneer3.models.own import own_folder
from pioneer3.robot.session import model_of, own_of
from pioneer3.state import Identity

ODD = Identity(name="rosie", family="Pioneer", model="odd")


@pytest.fixture
def file() -> Path:
    own_folder().mkdir(parents=True)
    path = own_folder() / "rosie.toml"
    path.write_text("max_speed = 0.25")
    return path


def test_what_its_own_file_lacks_is_that_of_a_model_that_is_given(file: Path) -> None:
    model = model_of(ODD, None, Fallback("p2at"))
    assert (model.max_speed, model.distance_factor) == (0.25, 0.00132)
    own = own_of(ODD, None, "p2at")
    assert own is not None
    assert own.model == model


def test_without_one_its_own_file_is_refused(file: Path) -> None:
    with pytest.raises(ConfigError, match=f"{file}: like: missing"):
        model_of(ODD, None)
