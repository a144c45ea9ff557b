from math import nan, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, GripperAction, GyroMode, RequestMode, Tcm2Mode
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.accessories import (
    Accessories,
    CarryingRobot,
    Equipment,
    SipFields,
    StickPosition,
    TableSensor,
)
from pioneer3.sim.accessories.collection import IGNORED
from pioneer3.sim.accessories.sony import SimulatedSonyEvi
from pioneer3.sim.body import Body
from tests.combinations import examples
from tests.property.test_codecs import messages
from tests.unit.sim.accessories.carrier import FakeCarrier

EVERYTHING = Equipment(
    gripper=True,
    compass=True,
    gyro_type=1,
    joystick=True,
    table_ir="new",
    camera="vcc4",
    gyro_noise=0.01,
    compass_noise=0.01,
)
POLITE = [cls for cls in commands.every_command() if cls.ID in IGNORED]


def test_a_body_carries_accessories() -> None:
    carrier: CarryingRobot = Body(load_model("p3at-sh"))
    rack = Accessories(carrier)
    rack.tick(0.0)
    assert rack.inputs(0.0) == SipFields()


def test_a_bare_pioneer_has_lines_encoders_gauge_and_ports() -> None:
    rack = Accessories(FakeCarrier())
    fitted = (rack.gripper, rack.compass, rack.gyro, rack.joystick, rack.table_ir, rack.camera)
    assert fitted == (None,) * 6
    asked: tuple[Command, ...] = (
        commands.IoRequest(RequestMode.ONCE),
        commands.RequestEncoders(RequestMode.ONCE),
        commands.RequestBatteryInfo(RequestMode.ONCE),
        commands.GripperPacRequest(RequestMode.ONCE),
    )
    for command in asked:
        assert rack.obey(command, 0.0)
    kinds = [type(report) for report in rack.reports(0.0, cycle=False)]
    assert kinds == [reports.Io, reports.Encoders, reports.BatteryInfo, reports.GripperState]


@pytest.mark.parametrize(
    "command",
    [
        commands.Tcm2(Tcm2Mode.STREAM),
        commands.Gyro(GyroMode.ON),
        commands.JoyInfo(RequestMode.STREAM),
        commands.Vel(0.1),
        commands.Unknown(30, b""),
    ],
)
def test_what_it_does_not_have_nobody_takes(command: Command) -> None:
    rack = Accessories(FakeCarrier())
    assert not rack.obey(command, 0.0)
    assert list(rack.reports(0.1, cycle=True)) == []


@pytest.mark.parametrize("cls", POLITE)
@settings(max_examples=10)
@given(data=st.data())
def test_sounds_lamps_and_switches_are_taken_silently(cls: type[Any], data: st.DataObject) -> None:
    rack = Accessories(FakeCarrier())
    command: Any = data.draw(messages(cls))
    assert rack.obey(command, 0.0)
    assert list(rack.reports(0.1, cycle=True)) == []


def test_everything_fitted_streams_with_every_cycle() -> None:
    rack = Accessories(FakeCarrier(), EVERYTHING, np.random.default_rng(1))
    asked: tuple[Command, ...] = (
        commands.IoRequest(RequestMode.STREAM),
        commands.RequestEncoders(RequestMode.STREAM),
        commands.GripperPacRequest(RequestMode.STREAM),
        commands.Tcm2(Tcm2Mode.STREAM),
        commands.Gyro(GyroMode.ON),
        commands.JoyInfo(RequestMode.STREAM),
    )
    for command in asked:
        assert rack.obey(command, 0.0)
    for cycle in range(1, 4):
        rack.tick(cycle / 10 - 0.05)
        assert len(rack.reports(cycle / 10, cycle=True)) == 6
    rack.hang_up()
    assert list(rack.reports(0.4, cycle=True)) == []


def test_the_standard_report_shows_all_of_them() -> None:
    carrier = FakeCarrier(load_model("peoplebot-sh"), robot_in_world=Pose2(0, 0, pi / 2 - 1.0))
    fitted = Equipment(gripper=True, compass=True, joystick=True, table_ir="old")
    rack = Accessories(carrier, fitted)
    assert rack.table_ir
    assert rack.joystick
    rack.table_ir.covered = TableSensor.LEFT
    rack.joystick.stick = StickPosition(button1=True)
    rack.digital.set_analog(2, 5.0)
    rack.obey(commands.AdSel(2), 0.0)
    rack.obey(commands.DigOut(mask=0xFF, values=1), 0.0)
    assert rack.inputs(0.0) == SipFields(
        analog_port=2,
        gripper_state=0x30,
        analog=255,
        digital_in=0xFE,
        digital_out=1,
        compass_raw=29,
        flags=reports.SipFlag.JOYSTICK_BUTTON,
    )


def test_a_peoplebot_comes_with_its_table_sensors() -> None:
    rack = Accessories(FakeCarrier(load_model("peoplebot-sh")))
    assert rack.table_ir
    rack.table_ir.covered = TableSensor.RIGHT
    rack.obey(commands.IoRequest(RequestMode.ONCE), 0.0)
    (report,) = rack.reports(0.0, cycle=False)
    assert isinstance(report, reports.Io)
    assert report.digital_in == (0xFF, 0xFF, 0xFF, 0xFE)


def test_the_next_36_after_pressure_is_the_gripper_s() -> None:
    value = commands.GripperVal(0.5)
    assert not Accessories(FakeCarrier()).claims(value)
    rack = Accessories(FakeCarrier(), EVERYTHING)
    assert not rack.claims(value)
    rack.obey(commands.Gripper(GripperAction.PRESSURE), 0.0)
    assert rack.claims(value)
    assert not rack.claims(commands.AdSel(1))
    rack.obey(value, 0.0)
    assert not rack.claims(value)


@pytest.mark.parametrize(
    ("charge", "fixed", "percent"),
    [
        (1.0, None, 100),
        (0.305, None, 30),
        (0.0, None, 0),
        (1.0, 12.0, 50),
        (1.0, 5.0, 0),
        (0.5, 24.0, 100),
    ],
)
def test_the_gauge_shows_the_charge_or_what_a_test_has_set(
    charge: float, fixed: float | None, percent: int
) -> None:
    carrier = FakeCarrier()
    carrier.battery.charge, carrier.battery.fixed = charge, fixed
    rack = Accessories(carrier)
    rack.obey(commands.RequestBatteryInfo(RequestMode.ONCE), 0.0)
    (report,) = rack.reports(0.0, cycle=False)
    assert isinstance(report, reports.BatteryInfo)
    (battery,) = report.batteries
    assert battery.relative_charge_percent == battery.absolute_charge_percent == percent


def test_the_chosen_camera_hangs_on_the_chosen_port() -> None:
    rack = Accessories(FakeCarrier(), Equipment(camera="sony", camera_port=3))
    assert isinstance(rack.camera, SimulatedSonyEvi)
    assert [port.device for port in rack.aux] == [None, None, rack.camera]


def test_a_camera_talks_through_its_port_as_aria_does() -> None:
    rack = Accessories(FakeCarrier(), Equipment(camera="vcc4", camera_port=2))
    for ask, said in (
        (commands.GetAux2(0), b""),
        (commands.GetAux2(6), b"\xff00\x00\xa01\xef"),
        (commands.GetAux2(6), b"\xff00\x00\x900\xef"),
    ):
        rack.obey(ask, 0.0)
        rack.obey(commands.Tty3(said), 0.0)
    heard = [rack.reports(0.0, cycle=False)]
    rack.obey(commands.GetAux2(6), 0.1)
    rack.obey(commands.Tty3(b"\xff00\x00\x63\xef"), 0.1)
    heard.append(rack.reports(0.2, cycle=True))
    rack.obey(commands.GetAux2(8), 0.3)
    heard.append(rack.reports(0.3, cycle=False))
    data = [r.data for batch in heard for r in batch if isinstance(r, reports.SerialAux)]
    assert b"".join(data).endswith(b"\xfe0000" + b"80008000\xef")


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("gyro_type", 3),
        ("camera_port", 0),
        ("camera", "kodak"),
        ("table_ir", "newer"),
        ("north", nan),
        ("gyro_noise", -1.0),
        ("compass_noise", -0.1),
        ("gyro_bias", nan),
    ],
)
def test_equipment_that_does_not_exist_is_refused(field: str, value: Any) -> None:
    with pytest.raises(ConfigError, match=field):
        Equipment(**{field: value})


def run(said: list[tuple[Command, float]]) -> list[object]:
    carrier = FakeCarrier(load_model("peoplebot-sh"))
    rack = Accessories(carrier, EVERYTHING, np.random.default_rng(5))
    now, heard = 0.0, list[object]()
    for command, pause in said:
        rack.obey(command, now)
        heard += rack.reports(now, cycle=False)
        now += pause
        carrier.robot_in_world = Pose2(now, -now, pause)
        rack.tick(now)
        heard += [*rack.reports(now, cycle=True), rack.inputs(now)]
    rack.hang_up()
    return heard


@settings(max_examples=examples(200))
@given(
    st.lists(
        st.tuples(st.sampled_from(commands.every_command()).flatmap(messages), st.floats(0.0, 0.5)),
        max_size=12,
    )
)
def test_any_commands_give_reports_that_fit_the_wire_the_same_every_time(
    said: list[tuple[Command, float]],
) -> None:
    heard = run(said)
    assert heard == run(said)
    for report in heard:
        if isinstance(report, SipFields):
            reports.to_payload(
                reports.Sip(
                    compass_raw=report.compass_raw,
                    flags=report.flags,
                    analog_port=report.analog_port,
                    gripper_state=report.gripper_state,
                    analog=report.analog,
                    digital_in=report.digital_in,
                    digital_out=report.digital_out,
                )
            )
        else:
            assert len(reports.to_payload(report)) <= 203  # type: ignore[arg-type]
