"""The gripper by hand (facts.md 8.5)."""

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Cell, Row
from pioneer3.robot.devices.gripper import GripperReading

WIDTH = 13


def gripper(cockpit: Cockpit) -> Mode:
    """Return the mode that opens, closes and lifts."""
    hand = cockpit.robot.devices.gripper

    def on_key(key: str) -> bool:
        match key:
            case "up":
                hand.lift_up()
            case "down":
                hand.lift_down()
            case "right":
                hand.open()
            case "left":
                hand.close()
            case "space":
                hand.halt()
            case "e" | "E":
                if not hand.exercising:
                    cockpit.work(hand.exercise())
            case _:
                return False
        return True

    return Mode(
        key="g",
        name="gripper",
        help=(
            "up, down: lift",
            "right, left: open, close",
            "space: halt",
            "e: exercise until a key",
        ),
        presence=lambda: hand.presence,
        enter=hand.wanted,
        on_key=on_key,
        row=lambda: gripper_row(hand.latest) if hand.latest else None,
        details=lambda: ("exercising",) if hand.exercising else (),
    )


def gripper_row(reading: GripperReading) -> Row:
    """Return beams, paddles and lift."""
    return Row(
        (
            Cell("BB outer", WIDTH, _beam(broken=reading.outer_beam_broken)),
            Cell("BB inner", WIDTH, _beam(broken=reading.inner_beam_broken)),
            Cell("Paddles", WIDTH, reading.paddles),
            Cell("Lift", WIDTH, "maxed" if reading.lift_at_limit else "clear"),
            Cell("LeftPaddle", WIDTH, _paddle(touches=reading.left_touches)),
            Cell("RightPaddle", WIDTH, _paddle(touches=reading.right_touches)),
        )
    )


def _beam(*, broken: bool) -> str:
    return "blocked" if broken else "clear"


def _paddle(*, touches: bool) -> str:
    return "triggered" if touches else "clear"
