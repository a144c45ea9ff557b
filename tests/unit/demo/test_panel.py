"""What a screen adds to ARIA's lines."""

from io import StringIO
from math import pi

import pytest
from rich.console import Console

from pioneer3.demo.mode import DemoMode, Description, Gauge
from pioneer3.demo.program import named
from pioneer3.demo.view import bar, panel
from pioneer3.geometry import Pose2
from pioneer3.navigation.picture import Trail
from pioneer3.robot.devices import Presence


def drawn(gauge: Gauge, width: int) -> str:
    return bar(gauge, width).plain


@pytest.mark.parametrize(
    ("share", "shown"),
    [
        (0.0, "········"),
        (0.5, "████····"),
        (1.0, "████████"),
        (7.0, "████████"),
        (1 / 16, "▌·······"),
    ],
)
def test_a_bar_is_as_long_as_its_share(share: float, shown: str) -> None:
    assert drawn(Gauge(name="g", share=share, text=""), 8) == shown


@pytest.mark.parametrize(
    ("share", "shown"),
    [
        (0.0, "····│····"),
        (0.5, "····│██··"),
        (-0.5, "··██│····"),
        (-1.0, "████│····"),
        (9.0, "····│████"),
    ],
)
def test_a_signed_bar_grows_from_its_middle(share: float, shown: str) -> None:
    assert drawn(Gauge(name="g", share=share, text="", signed=True), 9) == shown


@pytest.mark.parametrize("width", range(4, 60))
@pytest.mark.parametrize("share", [-1.0, -0.37, 0.0, 0.99])
def test_a_bar_fills_its_room(width: int, share: float) -> None:
    for signed in (False, True):
        assert len(drawn(Gauge(name="g", share=share, text="", signed=signed), width)) == width


def about(name: str, *keys: str) -> Description:
    return Description(key=name[0], name=name, hint="", help=keys, make=lambda _, it: DemoMode(it))


def shown(mode: DemoMode, *gauges: Gauge, width: int = 40) -> str:
    console = Console(width=width, file=StringIO())
    with console.capture() as captured:
        console.print(panel(mode, gauges, ("a detail",), width, cropped=False))
    return captured.get()


def test_a_panel_has_name_keys_gauges_and_details() -> None:
    mode = DemoMode(about("teleop", "up, down: speed"))
    text = shown(mode, Gauge(name="turn", share=0.5, text="+1 rad/s", signed=True))
    assert "TELEOP" in text
    assert "up, down speed" in text
    assert "+1 rad/s" in text
    assert "a detail" in text


def test_a_panel_tells_what_is_missing_and_how_one_knows() -> None:
    absent = Presence(False, "CONFIG says HasGripper 0.")
    mode = DemoMode(about("gripper"), presence=lambda: absent)
    assert "CONFIG says HasGripper 0." in shown(mode)


def test_the_trail_is_seen_from_the_robot() -> None:
    trail = Trail()
    trail.add(Pose2(0.0, 0.0, 0.0))
    trail.add(Pose2(0.01, 0.0, 0.0))  # hardly moved
    trail.add(Pose2(0.5, 0.0, 0.0))
    # seen from (0.5, 0) and facing left, the start lies to the left
    start, here = trail.seen_from(Pose2(0.5, 0.0, pi / 2))
    assert [*start, *here] == pytest.approx([0.0, 0.5, 0.0, 0.0])


def test_a_jump_begins_a_new_trail() -> None:
    trail = Trail()
    trail.add(Pose2(0.0, 0.0, 0.0))
    trail.add(Pose2(5.0, 0.0, 0.0))
    assert len(trail.seen_from(Pose2())) == 1


@pytest.mark.parametrize(
    ("sent", "name"),
    [
        ("\x1b[A", "up"),
        ("\x1bOB", "down"),
        ("\x1b[C", "right"),
        ("\x1b[D", "left"),
        ("\x1b[5~", "pageup"),
        ("\x1b[6~", "pagedown"),
        ("\x1b", "escape"),
        (" ", "space"),
        ("\r", "enter"),
        ("\x7f", "backspace"),
        ("\x12", "ctrl+r"),
        ("w", "w"),
        ("W", "W"),
        ("^", "^"),
    ],
)
def test_what_a_terminal_sends_has_the_names_of_the_screen(sent: str, name: str) -> None:
    assert named(sent) == name
