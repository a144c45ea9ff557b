"""Settings of navigation: their names, ranges and units, and that they change what they tell of."""

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.nav.beams import Beams
from pioneer3.nav.costs import CostMap
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.planner import NoWay, Way, plan
from pioneer3.nav.settings import AS_SHIPPED, SETTINGS

DX = load_model("p3dx-sh")
DOOR = np.array(
    [
        (0.0, 0.0, 6.0, 0.0),
        (6.0, 0.0, 6.0, 4.0),
        (6.0, 4.0, 0.0, 4.0),
        (0.0, 4.0, 0.0, 0.0),
        (3.0, 0.0, 3.0, 1.75),
        (3.0, 2.25, 3.0, 4.0),
    ]
)
"""Walls of two rooms, with a door of 0.5 m between them."""


def test_each_setting_has_its_default_within_its_range_and_a_meaning() -> None:
    assert [
        name
        for name, setting in SETTINGS.items()
        if not (setting.low <= setting.default <= setting.high and setting.meaning)
    ] == []


def test_a_number_counts_in_si_and_a_text_may_carry_its_unit() -> None:
    told = AS_SHIPPED.with_texts(["planner.margin=5cm", "localizer.turn=30"])
    assert (told.planner.margin, told.localizer.turn) == pytest.approx((0.05, np.pi / 6))
    assert AS_SHIPPED.with_values({"localizer.turn": 0.2}).localizer.turn == 0.2
    assert told.mapper == AS_SHIPPED.mapper


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("planner.margn=5cm", "no such setting; did you mean planner.margin?"),
        ("planner.margin=3", "3 is out of range, expected 0 m to 0.5 m"),
        ("planner.margin", "'' is not a length"),
        ("planner.period=nan", "'nan' is not a time"),
        ("localizer.particles=1.5", "expected a whole number, got '1.5'"),
        ("localizer.agreement=nan", "nan is out of range"),
        ("fleet=1", "no such setting; there are planner.margin"),
    ],
)
def test_what_is_wrong_with_a_setting_is_told(text: str, problem: str) -> None:
    with pytest.raises(ConfigError, match=problem.replace("?", r"\?")):
        AS_SHIPPED.with_texts([text])


@pytest.mark.parametrize(("margin", "kind"), [("7cm", NoWay), ("3cm", Way)])
def test_a_smaller_margin_opens_a_narrow_door(margin: str, kind: type) -> None:
    rooms = LineMap(name="rooms", walls=DOOR)
    settings = AS_SHIPPED.with_texts([f"planner.margin={margin}"])
    costs = CostMap.of(rooms, DX, settings.planner, cell=0.02)
    assert isinstance(plan(costs, (1.5, 2.0), (4.5, 2.0)), kind)


@pytest.mark.parametrize(("way", "frames"), [("15cm", 4), ("50cm", 2)])
def test_scans_are_kept_as_often_as_the_mapper_is_told(way: str, frames: int) -> None:
    angles = np.linspace(-1.5, 1.5, 60)
    wall = 2.0 * np.stack([np.ones_like(angles), np.tan(angles)], axis=1)
    mapper = Mapper(settings=AS_SHIPPED.with_texts([f"mapper.way={way}"]).mapper)
    for number in range(4):
        odom = Pose2(0.2 * number)
        mapper.add(
            Beams(
                stamp=0.1 * number,
                robot_in_odom=odom,
                points=wall - (odom.x, 0.0),
                clear=np.empty((0, 2)),
                origin=np.zeros(2),
                far=10.0,
            )
        )
    assert len(mapper.survey.frames) == frames
