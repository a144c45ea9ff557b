"""Reports on request: once at once, streams with every cycle, none after a stop or a hang-up."""

from collections.abc import Callable

import numpy as np
import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, RequestMode, Tcm2Mode
from pioneer3.arcos.reports import Report
from pioneer3.sim.accessories.base import Accessory, HostRequest
from pioneer3.sim.accessories.digital_io import DigitalIo
from pioneer3.sim.accessories.gauges import BatteryGauge, SimulatedEncoders, SimulatedJoystick
from pioneer3.sim.accessories.gripper import NoGripper, SimulatedGripper
from pioneer3.sim.accessories.heading import SimulatedCompass
from tests.unit.sim.accessories.carrier import FakeCarrier, answers, cycles

TCM2 = {
    RequestMode.STOP: Tcm2Mode.OFF,
    RequestMode.ONCE: Tcm2Mode.ONCE,
    RequestMode.STREAM: Tcm2Mode.STREAM,
}
Case = tuple[Callable[[], Accessory], Callable[[RequestMode], Command], type[Report]]
CASES: list[Case] = [
    (DigitalIo, commands.IoRequest, reports.Io),
    (lambda: SimulatedEncoders(FakeCarrier()), commands.RequestEncoders, reports.Encoders),
    (
        lambda: SimulatedCompass(FakeCarrier(), np.random.default_rng(1)),
        lambda how: commands.Tcm2(TCM2[how]),
        reports.Compass,
    ),
    (SimulatedGripper, commands.GripperPacRequest, reports.GripperState),
    (NoGripper, commands.GripperPacRequest, reports.GripperState),
    (SimulatedJoystick, commands.JoyInfo, reports.Joystick),
    (lambda: BatteryGauge(FakeCarrier()), commands.RequestBatteryInfo, reports.BatteryInfo),
]


@pytest.mark.parametrize(("make", "ask", "kind"), CASES)
class TestRequests:
    def test_nothing_comes_unasked(
        self,
        make: Callable[[], Accessory],
        ask: Callable[[RequestMode], Command],
        kind: type[Report],
    ) -> None:
        assert cycles(make(), 5) == []

    def test_once_is_answered_at_once_and_only_once(
        self,
        make: Callable[[], Accessory],
        ask: Callable[[RequestMode], Command],
        kind: type[Report],
    ) -> None:
        accessory = make()
        assert accessory.obey(ask(RequestMode.ONCE), 0.0)
        assert [type(report) for report in answers(accessory)] == [kind]
        assert cycles(accessory, 5) == []

    def test_a_stream_comes_with_every_cycle_until_it_is_stopped(
        self,
        make: Callable[[], Accessory],
        ask: Callable[[RequestMode], Command],
        kind: type[Report],
    ) -> None:
        accessory = make()
        accessory.obey(ask(RequestMode.STREAM), 0.0)
        assert list(answers(accessory)) == []
        assert [type(report) for report in cycles(accessory, 5)] == [kind] * 5
        accessory.obey(ask(RequestMode.STOP), 0.5)
        assert cycles(accessory, 5, start=0.5) == []

    def test_the_end_of_the_session_ends_the_stream(
        self,
        make: Callable[[], Accessory],
        ask: Callable[[RequestMode], Command],
        kind: type[Report],
    ) -> None:
        accessory = make()
        accessory.obey(ask(RequestMode.STREAM), 0.0)
        accessory.hang_up()
        assert cycles(accessory, 5) == []

    def test_what_is_for_others_is_left_to_them(
        self,
        make: Callable[[], Accessory],
        ask: Callable[[RequestMode], Command],
        kind: type[Report],
    ) -> None:
        assert not make().obey(commands.Vel(0.1), 0.0)


def test_once_ends_a_stream() -> None:
    asked = HostRequest()
    asked.set(RequestMode.STREAM)
    asked.set(RequestMode.ONCE)
    assert [asked.due(cycle=True) for _ in range(3)] == [True, False, False]
