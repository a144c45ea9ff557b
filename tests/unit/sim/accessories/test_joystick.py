import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode
from pioneer3.arcos.reports import SipFlag
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories import StickPosition
from pioneer3.sim.accessories.base import NOTHING
from pioneer3.sim.accessories.gauges import SimulatedJoystick
from tests.unit.sim.accessories.carrier import answers


def packet(stick: StickPosition) -> reports.Joystick:
    joystick = SimulatedJoystick()
    joystick.stick = stick
    joystick.obey(commands.JoyInfo(RequestMode.ONCE), 0.0)
    (report,) = answers(joystick)
    assert isinstance(report, reports.Joystick)
    return report


def test_let_go_it_stands_in_the_middle() -> None:
    assert packet(StickPosition()) == reports.Joystick(
        button1=0, button2=0, x_raw=512, y_raw=512, throttle_raw=0
    )


@pytest.mark.parametrize(
    ("stick", "x", "y"),
    [
        (StickPosition(forward=1.0), 512, 1023),
        (StickPosition(forward=-1.0), 512, 0),
        (StickPosition(left=1.0), 1023, 512),
        (StickPosition(left=-1.0), 0, 512),
        (StickPosition(left=-9.0, forward=9.0), 0, 1023),
        (StickPosition(left=0.5, forward=-0.5), 768, 256),
    ],
)
def test_pushed_it_goes_to_the_ends(stick: StickPosition, x: int, y: int) -> None:
    report = packet(stick)
    assert (report.x_raw, report.y_raw) == (x, y)


@pytest.mark.parametrize(("throttle", "raw"), [(0.5, 512), (1.0, 1023), (-1.0, 0)])
def test_the_throttle_has_1024_steps(throttle: float, raw: int) -> None:
    assert packet(StickPosition(throttle=throttle)).throttle_raw == raw


def test_the_first_button_is_a_flag_too() -> None:
    joystick = SimulatedJoystick()
    assert joystick.inputs(NOTHING, 0.0).flags == SipFlag(0)
    joystick.stick = StickPosition(button1=True, button2=True)
    assert joystick.inputs(NOTHING, 0.0).flags == SipFlag.JOYSTICK_BUTTON
    assert packet(joystick.stick).button2 == 1


def test_a_stick_is_somewhere() -> None:
    with pytest.raises(ConfigError, match="not finite"):
        StickPosition(forward=float("nan"))
