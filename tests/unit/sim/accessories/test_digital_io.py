import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories.base import NOTHING
from pioneer3.sim.accessories.digital_io import DigitalIo
from tests.unit.sim.accessories.carrier import answers


def io(digital: DigitalIo) -> reports.Io:
    digital.obey(commands.IoRequest(RequestMode.ONCE), 0.0)
    (report,) = answers(digital)
    assert isinstance(report, reports.Io)
    return report


def test_all_lines_are_high_and_all_analog_ports_low_at_first() -> None:
    assert io(DigitalIo()) == reports.Io((0xFF,) * 4, (0xFF,), (0,) * 8)


@pytest.mark.parametrize(
    ("mask", "values", "left"),
    [(0x0F, 0x05, 0xF5), (0, 0xFF, 0xFF), (0xFF, 0, 0), (0x80, 0x7F, 0x7F), (0x01, 0x01, 0xFF)],
)
def test_digout_changes_the_masked_outputs_only(mask: int, values: int, left: int) -> None:
    digital = DigitalIo()
    digital.obey(commands.DigOut(mask=mask, values=values), 0.0)
    assert io(digital).digital_out == (left,)
    assert digital.inputs(NOTHING, 0.0).digital_out == left


def test_the_outputs_outlive_the_session() -> None:
    digital = DigitalIo()
    digital.obey(commands.DigOut(mask=0xFF, values=0x12), 0.0)
    digital.hang_up()
    assert digital.outputs == 0x12


def test_an_input_line_lies_in_its_byte() -> None:
    digital = DigitalIo()
    digital.set_input(0, high=False)
    digital.set_input(25, high=False)
    assert io(digital).digital_in == (0xFE, 0xFF, 0xFF, 0xFD)
    assert digital.inputs(NOTHING, 0.0).digital_in == 0xFE
    digital.set_input(0, high=True)
    assert io(digital).digital_in == (0xFF, 0xFF, 0xFF, 0xFD)


def test_sensors_pull_lines_down_whatever_the_level() -> None:
    digital = DigitalIo(lambda: 0x02000001)
    digital.set_input(1, high=False)
    assert io(digital).digital_in == (0xFC, 0xFF, 0xFF, 0xFD)


def test_adsel_chooses_what_the_standard_report_shows() -> None:
    digital = DigitalIo()
    digital.set_analog(3, 2.5)
    assert digital.inputs(NOTHING, 0.0).analog == 0
    digital.obey(commands.AdSel(3), 0.0)
    sip = digital.inputs(NOTHING, 0.0)
    assert (sip.analog_port, sip.analog) == (3, 128)


def test_a_port_that_is_not_there_is_not_selected() -> None:
    digital = DigitalIo()
    assert digital.obey(commands.AdSel(8), 0.0)
    assert digital.selected == 0


@pytest.mark.parametrize(
    ("volts", "raw"), [(-1.0, 0), (0.0, 0), (2.5, 512), (5.0, 1023), (9, 1023)]
)
def test_analog_counts_are_of_4_88_millivolts(volts: float, raw: int) -> None:
    digital = DigitalIo()
    digital.set_analog(7, volts)
    assert io(digital).analog_raw == (0,) * 7 + (raw,)


def test_setpbioport_is_remembered() -> None:
    digital = DigitalIo()
    digital.obey(commands.SetPbioPort(port=11, on=True), 0.0)
    digital.obey(commands.SetPbioPort(port=4, on=True), 0.0)
    digital.obey(commands.SetPbioPort(port=4, on=False), 0.0)
    assert digital.ports_on == {11}


def test_what_is_not_there_is_refused() -> None:
    digital = DigitalIo()
    with pytest.raises(ConfigError, match="digital input 32"):
        digital.set_input(32, high=True)
    with pytest.raises(ConfigError, match="analog port -1"):
        digital.set_analog(-1, 1.0)
    with pytest.raises(ConfigError, match="nan V"):
        digital.set_analog(0, float("nan"))
