"""When the controller must look at the clock, and that looking then is enough."""

from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, GyroMode
from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import Equipment
from tests.combinations import examples
from tests.property.test_codecs import messages
from tests.unit.sim.bench import ON, SYNCS, Bench

EVERYTHING = Equipment(
    gripper=True, compass=True, gyro_type=1, joystick=True, camera="sony", camera_port=1
)
CENTRE = bytes([0x81, 0x01, 0x06, 0x02, 0x18, 0x14, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF])
LEFT = bytes([0x81, 0x01, 0x06, 0x02, 0x18, 0x14, 0xF, 0xF, 8, 0, 0, 0, 0, 0, 0xFF])


def equipped() -> Bench:
    bench = Bench(equipment=EVERYTHING).open()
    bench.hear()
    return bench


def test_without_a_session_never() -> None:
    bench = Bench()
    assert bench.firmware.due == inf
    bench.firmware.receive(SYNCS, 0.0)
    assert bench.firmware.due == inf
    bench.open()
    bench.say(commands.Close())
    assert bench.firmware.due == inf


def test_in_a_session_with_every_report() -> None:
    bench = Bench().open()
    bench.hear()
    times = []
    for _ in range(10):
        bench.now = bench.firmware.due
        times.append(bench.now)
        bench.say(commands.Pulse())
        bench.firmware.tick(bench.now)
        assert [type(report) for report in bench.hear()] == [reports.Sip]
    assert times == pytest.approx([0.1 * number for number in range(1, 11)])


def test_when_the_watchdog_expires_between_two_reports() -> None:
    bench = Bench().open()
    bench.firmware.tick(0.04)
    bench.now = 0.05
    bench.say(ON, commands.Vel(0.3))
    bench.firmware.device.watchdog = 0.04
    assert bench.firmware.due == pytest.approx(0.09)
    bench.firmware.tick(bench.firmware.due)
    assert bench.body.drive.held
    assert bench.firmware.due == pytest.approx(0.1)


def test_config_tells_the_watchdog_of_the_hosts_own_time() -> None:
    bench = Bench().open()
    bench.hear()
    bench.firmware.device.watchdog = 20.0
    bench.say(commands.RequestConfig())
    (config,) = bench.hear()
    assert isinstance(config, reports.Config)
    assert config.watchdog_ms == 2000


def test_a_watchdog_of_nought_never_expires() -> None:
    bench = Bench().open()
    bench.firmware.device.watchdog = 0.0
    bench.say(ON, commands.Vel(0.3))
    bench.wait(5.0, pulse=False)
    assert bench.speed == pytest.approx(0.3)


def test_when_the_camera_has_turned() -> None:
    bench = equipped()
    bench.say(commands.GetAux(3), commands.Tty2(LEFT))
    assert [type(report) for report in bench.hear()] == [reports.SerialAux]
    bench.say(commands.GetAux(3))
    bench.firmware.tick(0.1)
    bench.hear()
    due = bench.firmware.due
    assert 0.1 < due < 0.2  # 128 of its steps to the left
    bench.firmware.tick(due)
    assert [type(report) for report in bench.hear()] == [reports.SerialAux]


def test_with_every_sample_of_the_gyro_that_a_host_wants() -> None:
    bench = equipped()
    assert bench.firmware.due == pytest.approx(0.1)
    bench.say(commands.Gyro(GyroMode.ON))
    rates = []
    for sample in range(1, 9):
        assert bench.firmware.due == pytest.approx(0.025 * sample)
        bench.now = bench.firmware.due
        bench.body.robot_in_world = Pose2(0.0, 0.0, max(0, sample - 4) * 0.01)
        bench.firmware.tick(bench.now)
        rates += [
            r
            for report in bench.hear()
            if isinstance(report, reports.GyroRates)
            for r in report.samples
        ]
    assert [rate.rate_raw < 512 for rate in rates] == [False] * 4 + [True] * 4
    bench.say(commands.Gyro(GyroMode.OFF))
    assert bench.firmware.due == pytest.approx(0.3)


class TestLookingOnlyThenIsEnough:
    """The same is said in the same order as by one that looks at the clock all the time."""

    def run(self, said: list[tuple[Command, int]], *, always: bool) -> list[bytes]:
        bench = equipped()
        heard: list[bytes] = []
        for command, pause in said:
            bench.say(command)
            until = bench.now + pause * 0.05
            while bench.now < until:
                bench.now = min(until, bench.now + 0.001 if always else bench.firmware.due)
                bench.firmware.tick(bench.now)
            heard.append(bench.firmware.device.outgoing())
        return heard

    @settings(max_examples=examples(40))
    @given(
        st.lists(
            st.tuples(
                st.one_of(
                    st.sampled_from(
                        [commands.GetAux(3), commands.Tty2(LEFT), commands.Tty2(CENTRE)]
                    ),
                    st.sampled_from(
                        [commands.RequestEncoders, commands.Gripper, commands.Tcm2, commands.Gyro]
                    ).flatmap(messages),
                ),
                st.integers(0, 10),
            ),
            max_size=8,
        )
    )
    def test_it(self, said: list[tuple[Command, int]]) -> None:
        assert self.run(said, always=False) == self.run(said, always=True)
