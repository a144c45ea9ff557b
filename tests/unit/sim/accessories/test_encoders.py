from math import pi

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Request
from pioneer3.models import load_model
from pioneer3.sim.accessories.encoders import Encoders
from tests.unit.sim.accessories.carrier import FakeCarrier, answers


def counts(encoders: Encoders, now: float) -> tuple[int, int]:
    encoders.obey(commands.RequestEncoders(Request.ONCE), now)
    (report,) = answers(encoders, now)
    assert isinstance(report, reports.Encoders)
    return report.left_counts, report.right_counts


@pytest.mark.parametrize(("model", "ticks"), [("p3at-sh", 138_000), ("p3dx-sh", 128_000)])
def test_a_metre_ahead_is_what_the_manuals_quote(model: str, ticks: int) -> None:
    carrier = FakeCarrier(load_model(model))
    encoders = Encoders(carrier)
    carrier.drive.linear.velocity = 0.5
    encoders.tick(10.0)
    assert counts(encoders, 12.0) == (ticks, ticks)


def test_a_turn_to_the_left_rolls_the_right_wheel_ahead() -> None:
    carrier = FakeCarrier()
    encoders = Encoders(carrier)
    carrier.drive.angular.velocity = pi
    for step in range(101):
        encoders.tick(step * 0.02)
    rolled = round(pi * carrier.model.wheel_base * 128_000)
    assert counts(encoders, 2.0) == (-rolled, rolled)


def test_a_ramp_is_integrated_exactly() -> None:
    carrier = FakeCarrier()
    encoders = Encoders(carrier)
    for step in range(51):
        carrier.drive.linear.velocity = 0.3 * step * 0.02
        encoders.tick(step * 0.02)
    assert encoders.left == encoders.right == pytest.approx(0.15)


def test_counters_run_on_where_the_pose_comes_back() -> None:
    carrier = FakeCarrier()
    encoders = Encoders(carrier)
    for now, speed in ((0.0, 1.0), (1.0, 1.0), (1.0, -1.0), (3.0, -1.0)):
        carrier.drive.linear.velocity = speed
        encoders.tick(now)
    assert counts(encoders, 3.0) == (-128_000, -128_000)
    assert not encoders.obey(commands.SetO(), 3.0)
    assert counts(encoders, 3.0) == (-128_000, -128_000)


def test_counters_wrap_at_32_bits() -> None:
    encoders = Encoders(FakeCarrier())
    encoders.roll(20_000.0, -20_000.0)
    left, right = counts(encoders, 0.0)
    assert left == 20_000 * 128_000 - (1 << 32)
    assert right == -20_000 * 128_000 + (1 << 32)
