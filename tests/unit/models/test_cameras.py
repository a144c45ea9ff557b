"""What makes of cameras see."""

from math import degrees, tan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.models.cameras import CAMERAS, CameraModel
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.eye import Eye

MODELS = st.sampled_from([*CAMERAS.values()])


def test_every_make_that_can_be_fitted_has_a_field_of_view() -> None:
    for name in CAMERAS:
        assert EquipmentOptions(camera=name).camera == name  # type: ignore[arg-type]
    assert CAMERAS["vcc4"].wide == Eye().view
    assert degrees(CAMERAS["vcc4"].tele) == pytest.approx(3)


@given(MODELS, st.floats(0, 0.9), st.floats(0.01, 0.1))
def test_zoom_narrows_the_view_by_an_equal_factor_for_equal_steps(
    model: CameraModel, zoom: float, step: float
) -> None:
    def enlarged(by: float) -> float:
        return tan(model.view(by) / 2) / tan(model.view(by + step) / 2)

    assert model.view(0.0) == pytest.approx(model.wide)
    assert model.view(1.0) == pytest.approx(model.tele)
    assert enlarged(zoom) == pytest.approx(enlarged(0.0))
    assert enlarged(zoom) > 1
