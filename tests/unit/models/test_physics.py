from dataclasses import fields

import pytest

from pioneer3.models import RobotModel, load_model, model_names
from pioneer3.models.numbers import PARAMETERS, numbers_of
from pioneer3.models.physics import BODIES
from pioneer3.models.shape import SHAPES


@pytest.mark.parametrize("name", BODIES)
def test_every_number_of_a_body_has_a_unit_and_a_source(name: str) -> None:
    for described in (BODIES[name], SHAPES[name]):
        named = {field.name for field in fields(described)} - {"sources"}
        if getattr(described, "caster", "") is None:
            named -= {"caster", "caster_radius", "caster_trail"}
        assert set(described.sources) == named
        assert all(described.sources.values())
    assert all("unit" in field.metadata for field in fields(BODIES[name])[:-1])


@pytest.mark.parametrize(
    "model", [load_model(name) for name in model_names()], ids=lambda model: model.name
)
def test_the_table_of_numbers_is_whole(model: RobotModel) -> None:
    numbers = numbers_of(model, shipped=True)
    names = [number.name for number in numbers]
    assert len(set(names)) == len(names)
    derived = {"total_mass", "effective_track", "rolling_radius", "turning_track"}
    assert {*PARAMETERS, *derived} < set(names)
    assert ("caster_mass" in names) is (model.drive == "differential")
    assert all(number.value and number.source for number in numbers)


def test_numbers_that_belong_together_are_told_apart() -> None:
    values = {each.name: each.value for each in numbers_of(load_model("p3at"), shipped=True)}
    assert values["contact"] == "(0.1, 0.3), (0.5, 0.9, 0.01)"
    assert values["axles"] == "0.134, -0.134"
