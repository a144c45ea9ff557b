"""The plan of a calibration: its ground, and what it asks."""

import numpy as np
import pytest

from pioneer3.calibration.course import CLEARANCE
from pioneer3.calibration.steps import (
    OPTIONAL,
    QUESTIONS,
    ROOM,
    By,
    CalibrationStep,
    plan,
    usual_side,
)
from pioneer3.calibration.track import RawTrack
from pioneer3.models import load_model
from pioneer3.models.odometry import UNCORRECTED


def path(step: CalibrationStep) -> np.ndarray:
    steps = [(leg.way / 10, leg.turn / 10) for leg in step.legs for _ in range(10)]
    return RawTrack(np.arange(len(steps) + 1.0), np.array(steps)).poses(UNCORRECTED, 0.33)


@pytest.mark.parametrize("name", ["p3dx-sh", "p3at-sh", "powerbot-sh"])
@pytest.mark.parametrize("by_laser", [True, False])
def test_the_robot_stays_on_the_ground_that_a_step_tells(name: str, by_laser: bool) -> None:
    model = load_model(name)
    steps = plan(model, 1.0, 1.5, 2, by_laser=by_laser, by_sonar=True)
    for step in steps:
        x, y, _ = path(step).T
        reach = model.length_front if step.name == "straight" else model.corner
        assert x.min() - model.corner >= step.room.x_min - model.corner - CLEARANCE
        assert x.max() + reach <= step.room.x_max + 1e-9
        assert y.min() - model.width / 2 >= step.room.y_min
        assert y.max() + model.width / 2 <= step.room.y_max


@pytest.mark.parametrize("left", [True, False])
def test_a_square_ends_where_it_began_and_on_the_ground_of_the_other(left: bool) -> None:
    steps = plan(load_model("p3dx-sh"), 1.2, 1.2, 1, by_laser=False, by_sonar=False)
    step = next(each for each in steps if each.square and each.left is left)
    assert path(step)[-1, :2] == pytest.approx((0, 0), abs=1e-9)
    assert path(step)[:, :2].min() > -1e-9
    assert [each.name for each in steps] == ["square left", "square right", "straight"]


def test_the_usual_ground_is_two_metres_wide() -> None:
    for name in ("p3dx-sh", "p3at-sh"):
        model = load_model(name)
        steps = plan(model, usual_side(model), usual_side(model), 1, by_laser=False, by_sonar=True)
        for step in steps:
            assert step.room.x_max - step.room.x_min <= ROOM + 1e-9


def test_a_laser_asks_nobody_and_every_question_is_there() -> None:
    model = load_model("p3dx-sh")
    assert not [each for each in plan(model, 1, 1, 1, by_laser=True, by_sonar=True) if each.asks]
    steps = plan(model, 1, 1, 1, by_laser=False, by_sonar=True)
    assert {name for step in steps for name in step.asks} == set(QUESTIONS)
    assert set(QUESTIONS) > OPTIONAL
    assert [step.by for step in steps[:2]] == [By.SONAR] * 2
