"""Why the robot stands still, in one sentence: the reason to be mended first."""

from dataclasses import replace

import pytest

from pioneer3.geometry import ORIGIN, STILL, Twist2
from pioneer3.limits import Limits
from pioneer3.robot.explain import Reason, ReasonKind, why_not_moving
from pioneer3.robot.pilot import ENABLE_TRIES, Pilot, VelocityCommand
from pioneer3.state import Battery, Bumpers, Motors, Odometry, Snapshot

AHEAD = Twist2(0.3, 0.0)
OFF = Snapshot(
    stamp=0.0,
    sequence=1,
    odometry=Odometry(robot_in_odom=ORIGIN, twist=STILL, left_speed=0, right_speed=0),
    battery=Battery(voltage=12.5),
    motors=Motors(),
)
ON = replace(OFF, motors=Motors(enabled=True))


def pilot(snapshot: Snapshot = OFF) -> Pilot:
    made = Pilot()
    made.session_opened(Limits(max_speed=1, max_turn_rate=1), 0.0)
    made.observe(snapshot, 0.0)
    return made


def reason(
    made: Pilot, snapshot: Snapshot | None, now: float = 0.0, decided: str | None = None
) -> Reason:
    answer = why_not_moving(made, snapshot, now, decided)
    assert answer is not None
    return answer


def why(made: Pilot, snapshot: Snapshot | None, now: float = 0.0) -> str:
    return str(reason(made, snapshot, now))


@pytest.mark.parametrize("twist", [Twist2(0.1, 0.0), Twist2(-0.1, 0.0), Twist2(0.0, 0.1)])
def test_a_robot_that_moves_needs_no_reason(twist: Twist2) -> None:
    moving = replace(ON, odometry=replace(ON.odometry, twist=twist))
    assert why_not_moving(pilot(), moving, 0.0) is None


def test_without_a_session() -> None:
    made = pilot()
    assert why(made, None) == "No robot is connected."
    made.session_lost("pulled out", 1.0)
    assert "the link was lost (pulled out)" in why(made, None)


def test_nothing_is_asked() -> None:
    assert why(pilot(), OFF) == "Nothing is asked of it, and the motors are off."
    assert why(pilot(), ON) == "Nothing is asked of it."
    assert reason(pilot(), OFF).kind is reason(pilot(), ON).kind is ReasonKind.IDLE


def test_the_command_expired() -> None:
    made = pilot()
    made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), 1.0)
    made.observe(ON, 1.1)
    assert why(made, replace(ON, stamp=2.0), 2.0).startswith("The last command expired after 0.5 s")


def test_the_command_was_just_sent() -> None:
    made = pilot()
    made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), 1.0)
    assert why(made, replace(OFF, stamp=1.0), 1.0).startswith("The motors are off; they are being")
    made.observe(ON, 1.1)
    assert why(made, replace(ON, stamp=1.1), 1.1).startswith("The command has just been sent")


def test_motors_that_no_command_switches_on_have_to_be_switched_on() -> None:
    made = pilot()
    made.auto_enable = False
    made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), 1.0)
    off = reason(made, replace(OFF, stamp=1.0), 1.0)
    assert off.text.endswith("commands do not switch them on: switch them on first.")
    assert off.kind is ReasonKind.FAULT


def test_the_emergency_stop_comes_before_everything() -> None:
    made = pilot()
    made.emergency_stop(0.0)
    pressed = replace(OFF, motors=Motors(stop_button=True))
    assert why(made, pressed).startswith("The emergency stop is latched")


def test_the_stop_button_comes_before_the_wait_for_a_fresh_command() -> None:
    pressed = replace(OFF, motors=Motors(stop_button=True))
    made = pilot()
    made.observe(pressed, 0.1)
    assert why(made, pressed).startswith("The stop button on the robot is pressed")
    assert why(made, OFF).startswith("Waiting for a fresh command: the stop button")
    assert reason(made, OFF).kind is ReasonKind.STOPPED
    assert reason(made, OFF).wants_help


def test_a_silent_robot() -> None:
    assert why(pilot(), OFF, 0.7) == "The robot has said nothing for 0.7 s: the link is failing."


def test_motors_that_do_not_come_on() -> None:
    made = pilot()
    for half in range(2 * ENABLE_TRIES):
        made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), half / 2)
        made.observe(OFF, half / 2)
    assert why(made, replace(OFF, stamp=9.0), 9.0).startswith("The motors do not come on")


def test_a_stall_that_is_seen_before_it_blocks() -> None:
    made = pilot()
    made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), 0.0)
    stalled = replace(ON, motors=Motors(enabled=True, left_stalled=True))
    assert why(made, stalled) == "The wheels are stalled: something blocks them."


def test_a_bumper() -> None:
    made = pilot()
    made.drive(VelocityCommand(AHEAD, after=made.last_stop.number), 0.0)
    touching = replace(ON, bumpers=Bumpers(front=(True,)))
    assert why(made, touching).startswith("A bumper touches something in that direction")


def test_a_reason_is_a_fault_unless_all_goes_as_it_should() -> None:
    asked, moving = pilot(), replace(ON, odometry=replace(ON.odometry, twist=AHEAD))
    asked.drive(VelocityCommand(AHEAD, after=asked.last_stop.number), 0.0)
    assert why_not_moving(asked, moving, 0.0) is None
    assert reason(asked, OFF).kind is ReasonKind.NORMAL  # motors are switched on
    assert reason(asked, ON).kind is ReasonKind.NORMAL  # just sent
    assert reason(asked, replace(ON, stamp=2.0), 2.0).kind is ReasonKind.NORMAL  # expired
    decided = reason(pilot(), ON, decided="wander: somebody in front")
    assert decided.kind is ReasonKind.NORMAL
    asked.emergency_stop(0.0)
    assert reason(asked, ON).kind is ReasonKind.FAULT
    pressed = replace(ON, motors=Motors(stop_button=True))
    assert reason(pilot(), pressed).kind is ReasonKind.FAULT
    assert reason(pilot(), None).kind is ReasonKind.FAULT
