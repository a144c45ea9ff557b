import pytest

from pioneer3.models import RobotModel, generic_model, load_model, model_names, shape_of


@pytest.mark.parametrize(
    "model", [load_model(name) for name in model_names()], ids=lambda m: m.name
)
def test_a_shape_fits_its_model(model: RobotModel) -> None:
    shape = shape_of(model)
    assert 0 < shape.clearance < shape.sonar_height < shape.height
    assert shape.track + shape.wheel_width <= model.width
    for axle in shape.axles:
        assert -model.length_rear <= axle - shape.wheel_radius
        assert axle + shape.wheel_radius <= model.length_front
    assert list(shape.axles) == sorted(shape.axles, reverse=True)
    assert (len(shape.axles) == 2) is (model.drive == "skid")
    assert (shape.caster is None) is (model.drive == "skid")


def test_variants_of_a_robot_have_its_shape() -> None:
    assert shape_of(load_model("p3at")) == shape_of(load_model("p3at-sh"))
    assert shape_of(load_model("p3dx-sh-lms500")) == shape_of(load_model("p3dx"))


def test_a_robot_that_nobody_knows_has_the_shape_of_its_kin() -> None:
    unknown = generic_model("p9", max_speed=1.0, max_turn_rate=1.0)
    assert shape_of(unknown) == shape_of(load_model("p3dx"))
