import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode
from pioneer3.models import load_model
from pioneer3.sim.accessories.gauges import SimulatedEncoders
from tests.unit.sim.accessories.carrier import FakeCarrier, answers


def counts(encoders: SimulatedEncoders) -> tuple[int, int]:
    encoders.obey(commands.RequestEncoders(RequestMode.ONCE), 0.0)
    (report,) = answers(encoders)
    assert isinstance(report, reports.Encoders)
    return report.left_counts, report.right_counts


@pytest.mark.parametrize(("model", "ticks"), [("p3at-sh", 138_000), ("p3dx-sh", 128_000)])
def test_a_metre_is_what_the_manuals_quote(model: str, ticks: int) -> None:
    carrier = FakeCarrier(load_model(model), wheel_travel=(-1.0, 1.0))
    assert counts(SimulatedEncoders(carrier)) == (-ticks, ticks)


def test_counters_know_nothing_of_the_odometry() -> None:
    carrier = FakeCarrier(wheel_travel=(2.0, 1.0))
    encoders = SimulatedEncoders(carrier)
    assert not encoders.obey(commands.SetO(), 3.0)
    assert counts(encoders) == (256_000, 128_000)


def test_counters_wrap_at_32_bits() -> None:
    left, right = counts(SimulatedEncoders(FakeCarrier(wheel_travel=(20_000.0, -20_000.0))))
    assert left == 20_000 * 128_000 - (1 << 32)
    assert right == -20_000 * 128_000 + (1 << 32)
