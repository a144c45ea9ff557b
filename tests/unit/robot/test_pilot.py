"""Which motion is due, and when: velocity commands, snapshots and the time in, commands out."""

from collections.abc import Callable
from dataclasses import replace
from math import inf
from random import Random

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.errors import Refusal
from pioneer3.geometry import ORIGIN, STILL, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel, generic_model, load_model
from pioneer3.robot.pilot import (
    BRAKING,
    BURST,
    ENABLE_RETRY,
    ENABLE_TRIES,
    LONGEST_PAUSE,
    MIN_INTERVAL,
    REPEAT,
    REPORT_TIMEOUT,
    SHARED,
    STALL_RECOVERY,
    MotionRequest,
    Pilot,
    VelocityCommand,
)
from pioneer3.robot.session import commands_for, settings_for
from pioneer3.state import Battery, Bumpers, Motors, Odometry, Snapshot

LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5)
P3AT = load_model("p3at-sh")
AHEAD = Twist2(0.3, 0.0)
ON, OFF = commands.Enable(on=True), commands.Enable(on=False)
EXPIRY = LIMITS.expiry


def seen(
    *,
    v: float = 0.0,
    w: float = 0.0,
    enabled: bool = False,
    stalled: bool = False,
    stop_button: bool = False,
    bumpers: Bumpers | None = None,
) -> Snapshot:
    odometry = Odometry(robot_in_odom=ORIGIN, twist=Twist2(v, w), left_speed=v, right_speed=v)
    motors = Motors(enabled=enabled, left_stalled=stalled, stop_button=stop_button)
    return Snapshot(
        stamp=0.0,
        sequence=1,
        odometry=odometry,
        battery=Battery(voltage=12.5),
        motors=motors,
        bumpers=bumpers or Bumpers(),
    )


STANDING, READY = seen(), seen(enabled=True)


def frames(pilot: Pilot) -> list[Command]:
    """Return the commands that a session makes of the motion that is due."""
    return commands_for(pilot.outgoing())


def flying(now: float = 0.0, *, auto_enable: bool = True) -> Pilot:
    """Return a pilot in a session, nothing asked, motors off, nothing left to send."""
    pilot = Pilot(auto_enable=auto_enable)
    pilot.session_opened(LIMITS, now)
    pilot.observe(STANDING, now)
    frames(pilot)
    return pilot


def ask(
    pilot: Pilot, twist: Twist2, now: float, until: float = inf, *, after: int | None = None
) -> Refusal | None:
    """Ask for what has just begun, unless it began `after` another stop."""
    began = pilot.last_stop.number if after is None else after
    return pilot.drive(VelocityCommand(twist, until, after=began), now)


def vel(v: float, w: float = 0.0) -> list[Command]:
    return [commands.Vel(speed=v), commands.RVel(rate=w)]


def driving(now: float = 0.0) -> Pilot:
    """Return a pilot that drives ahead, motors on."""
    pilot = flying(now)
    assert ask(pilot, AHEAD, now) is None
    pilot.observe(READY, now)
    frames(pilot)
    return pilot


def test_a_session_begins_with_a_stop_and_the_limits() -> None:
    pilot = Pilot()
    pilot.session_opened(LIMITS, 0.0)
    settings: list[Command] = [
        commands.SetV(speed=0.7),
        commands.SetRV(rate=1.5),
        commands.SetA(acceleration=0.3),
        commands.SetA(acceleration=-0.3),
        commands.SetRA(acceleration=LIMITS.turn_acceleration),
        commands.SetRA(acceleration=-LIMITS.turn_deceleration),
        commands.Sonar(on=True),
    ]
    assert settings_for(P3AT, LIMITS) == settings
    assert commands_for(pilot.outgoing(), settings) == [commands.Stop(), *settings]
    assert frames(pilot) == []


@pytest.mark.parametrize(
    "model",
    [
        replace(P3AT, settable_speed=False, settable_acceleration=False),
        generic_model("p2at", max_speed=1.0, max_turn_rate=1.0),
    ],
    ids=["old firmware", "unknown type"],
)
def test_a_robot_whose_limits_cannot_be_set_is_not_told_any(model: RobotModel) -> None:
    assert settings_for(model, LIMITS) == [commands.Sonar(on=True)]


def test_stops_go_first_then_settings_then_power_and_velocity() -> None:
    everything = MotionRequest(
        stop=True, hard_stop=True, accelerations=LIMITS.accelerations, motors=True, twist=AHEAD
    )
    sonar = commands.Sonar(on=True)
    due = commands_for(everything, [sonar])
    assert due[:3] == [commands.Stop(), commands.EStop(), sonar]
    assert due[-3:] == [ON, *vel(0.3)]
    assert due[3:-3] == settings_for(P3AT, LIMITS)[2:6]


def test_motors_found_on_are_switched_off() -> None:
    pilot = Pilot()
    pilot.session_opened(LIMITS, 0.0)
    frames(pilot)
    pilot.observe(READY, 0.0)
    assert OFF in frames(pilot)
    pilot.observe(STANDING, 0.1)
    pilot.observe(READY, 0.2)  # somebody at the robot switches them on
    assert OFF not in frames(pilot)


def test_before_a_session_requests_are_refused() -> None:
    pilot = Pilot()
    assert str(ask(pilot, AHEAD, 0.0)) == "no robot is connected"
    pilot.session_opened(LIMITS, 0.0)
    frames(pilot)
    assert str(ask(pilot, AHEAD, 1.0)) == "no robot is connected"
    assert frames(pilot) == []


def test_a_request_switches_the_motors_on_and_sends_its_velocity() -> None:
    pilot = flying()
    assert ask(pilot, Twist2(0.2, 0.1), 0.1) is None
    assert frames(pilot) == [ON, *vel(0.2, 0.1)]


def test_a_request_is_limited() -> None:
    pilot = flying()
    ask(pilot, Twist2(7.0, 0.0), 0.1)
    assert frames(pilot) == [ON, *vel(0.7)]


def test_a_zero_request_does_not_need_motors() -> None:
    pilot = flying()
    ask(pilot, STILL, 1.0)
    assert frames(pilot) == []


def test_the_same_request_is_repeated_every_fifth_of_a_second_while_it_holds() -> None:
    pilot = driving()
    sent = 0
    for hundredth in range(1, 41):
        now = hundredth / 100
        ask(pilot, AHEAD, now)
        pilot.observe(seen(v=0.3, enabled=True), now)
        sent += frames(pilot) == vel(0.3)
    assert sent == 0.4 / REPEAT


def test_a_new_request_goes_out_at_once() -> None:
    pilot = driving()
    ask(pilot, Twist2(0.1, 0.2), MIN_INTERVAL)
    assert frames(pilot) == vel(0.1, 0.2)


def test_a_changed_request_does_not_wait_for_the_repetition_of_the_old_one() -> None:
    pilot = driving()
    pilot.observe(seen(v=0.3, enabled=True), REPEAT)
    assert frames(pilot) == vel(0.3)
    ask(pilot, Twist2(0.1, 0.2), REPEAT + 0.001)
    assert frames(pilot) == vel(0.1, 0.2)


def test_a_few_requests_in_quick_succession_all_go_out() -> None:
    pilot = driving()
    for number in range(1, BURST):
        ask(pilot, Twist2(0.1, number / 10), number / 1000)
        assert frames(pilot) == vel(0.1, number / 10)


def test_a_flood_of_requests_does_not_queue_up_on_a_slow_line() -> None:
    pilot = driving()
    sent: list[list[Command]] = []
    for thousandth in range(1, 1000):
        ask(pilot, Twist2(0.1, thousandth / 1000), thousandth / 1000)
        pilot.observe(READY, thousandth / 1000)
        sent.append(frames(pilot))
    assert pilot.deadline <= 0.999 + MIN_INTERVAL
    pilot.tick(pilot.deadline)
    sent.append(frames(pilot))
    sent = [frames for frames in sent if frames]
    assert len(sent) <= 1 / MIN_INTERVAL + BURST
    assert sent[-1] == vel(0.1, 0.999)


def test_a_stop_never_waits_for_its_turn() -> None:
    pilot = driving()
    ask(pilot, Twist2(), 0.001)
    assert frames(pilot) == vel(0.0)


def test_a_request_expires_to_the_moment() -> None:
    pilot = driving()
    pilot.observe(seen(v=0.3, enabled=True), 0.4)
    assert pilot.deadline == EXPIRY
    frames(pilot)
    pilot.tick(EXPIRY - 0.001)
    assert pilot.asked(EXPIRY - 0.001) == AHEAD
    assert vel(0.0) != frames(pilot)
    pilot.tick(EXPIRY)
    assert frames(pilot) == vel(0.0)
    assert pilot.asked(EXPIRY) == STILL


def test_a_request_may_end_sooner_but_not_later_than_its_expiry() -> None:
    pilot = flying()
    ask(pilot, AHEAD, 1.0, until=1.1)
    assert pilot.asked(1.09) == AHEAD
    assert pilot.asked(1.1) == STILL
    ask(pilot, AHEAD, 2.0, until=99.0)
    assert pilot.asked(2.0 + EXPIRY) == STILL


def test_a_robot_that_falls_silent_is_told_to_stand_until_it_speaks_again() -> None:
    pilot = driving()
    for tenth in range(1, 8):
        ask(pilot, AHEAD, tenth / 10)
    assert frames(pilot) == vel(0.0)
    pilot.observe(seen(v=0.1, enabled=True), 0.8)
    assert frames(pilot) == vel(0.3)


def test_zero_is_repeated_until_the_robot_stands() -> None:
    pilot = driving()
    ask(pilot, STILL, 0.1)
    assert frames(pilot) == vel(0.0)
    moving = seen(v=0.2, enabled=True)
    assert not sends(pilot, moving, 0.24)
    assert pilot.deadline == pytest.approx(0.1 + REPEAT + SHARED)
    assert sends(pilot, moving, 0.26)
    assert not sends(pilot, moving, 0.4)
    assert sends(pilot, moving, 0.46)
    assert not any(sends(pilot, READY, t / 10) for t in range(8, 30))
    turning = seen(w=0.2, enabled=True)
    assert sends(pilot, turning, 3.0)


def sends(pilot: Pilot, snapshot: Snapshot, now: float) -> bool:
    pilot.observe(snapshot, now)
    return frames(pilot) == vel(0.0)


def test_enable_is_sent_again_until_the_motors_are_on_and_not_for_ever() -> None:
    pilot = flying()
    tries = 0
    for tenth in range(100):
        ask(pilot, AHEAD, tenth / 10)
        pilot.observe(STANDING, tenth / 10)
        tries += frames(pilot).count(ON)
    assert tries == ENABLE_TRIES
    assert pilot.enable_failed
    assert (ENABLE_TRIES - 1) * ENABLE_RETRY < 2.0  # a move waits that long before it gives up


def test_a_request_after_a_pause_tries_again_to_switch_the_motors_on() -> None:
    pilot = flying()
    for tenth in range(100):
        ask(pilot, AHEAD, tenth / 10)
        pilot.observe(STANDING, tenth / 10)
    frames(pilot)
    ask(pilot, AHEAD, 10.0)
    assert ON not in frames(pilot)
    ask(pilot, AHEAD, 11.0)
    assert ON in frames(pilot)


def test_motors_go_off_when_the_robot_is_seen_standing() -> None:
    pilot = driving()
    pilot.observe(seen(v=0.3, enabled=True), 0.1)
    frames(pilot)
    assert pilot.set_motors(on=False, now=0.15) is None
    assert frames(pilot) == [commands.Stop()]
    for tenth in range(2, 6):
        pilot.observe(seen(v=0.3 - tenth / 20, enabled=True), tenth / 10)
        assert OFF not in frames(pilot)
    pilot.observe(READY, 0.6)
    assert frames(pilot) == [OFF]


def test_motors_go_off_after_a_second_whatever_the_robot_says() -> None:
    pilot = driving()
    moving = seen(v=0.3, enabled=True)
    pilot.observe(moving, 0.1)
    pilot.set_motors(on=False, now=0.1)
    frames(pilot)
    for tenth in range(2, 11):
        pilot.observe(moving, tenth / 10)
        assert OFF not in frames(pilot)
    assert pilot.deadline == pytest.approx(0.1 + BRAKING)
    pilot.tick(pilot.deadline)
    assert OFF in frames(pilot)


def test_what_a_report_said_before_the_stop_does_not_count_as_standing() -> None:
    pilot = driving()  # told to drive, and reported to stand
    pilot.set_motors(on=False, now=0.1)
    assert frames(pilot) == [commands.Stop()]


def test_motors_of_a_robot_at_rest_go_off_at_once() -> None:
    pilot = driving()
    pilot.stop(0.1)
    pilot.observe(READY, 0.2)
    frames(pilot)
    pilot.set_motors(on=False, now=0.3)
    assert OFF in frames(pilot)


def test_new_limits_reach_the_robot_with_the_next_look() -> None:
    pilot = flying()
    pilot.limits = replace(LIMITS, acceleration=0.2)
    pilot.tick(1.0)
    assert commands.SetA(acceleration=0.2) in frames(pilot)


def test_without_auto_enable_motors_go_on_only_when_asked_for() -> None:
    pilot = flying(auto_enable=False)
    ask(pilot, AHEAD, 1.0)
    assert ON not in frames(pilot)
    assert pilot.set_motors(on=True, now=2.0) is None
    assert frames(pilot) == [commands.Stop(), ON]


def test_stop_is_sent_each_time() -> None:
    pilot = driving()
    for tenth in (1, 2, 3):
        pilot.stop(tenth / 10)
        assert frames(pilot) == [commands.Stop()]
    assert pilot.asked(0.3) == STILL


def test_a_flood_of_stops_leaves_room_on_the_line() -> None:
    pilot = driving()
    sent: list[Command] = []
    for thousandth in range(1000):
        pilot.stop(thousandth / 1000)
        sent += frames(pilot)
    assert sent == [commands.Stop()] * round(1 / MIN_INTERVAL)


def test_a_flood_of_emergency_stops_leaves_room_too_and_none_is_lost() -> None:
    pilot = driving()
    sent: list[Command] = []
    for thousandth in range(1000):
        pilot.emergency_stop(thousandth / 1000)
        sent += frames(pilot)
    assert sent[:2] == [commands.Stop(), commands.EStop()]
    assert sent.count(commands.EStop()) <= round(1 / MIN_INTERVAL)


def test_what_waits_for_the_link_is_one_frame_of_a_kind_stops_first() -> None:
    pilot = driving()
    for tenth in range(1, 51):  # the link takes nothing for 5 s
        now = tenth / 10
        ask(pilot, Twist2(0.1 + tenth / 100, 0.2), now)
        pilot.observe(seen(v=0.3, enabled=True), now)
        if tenth % 10 == 0:
            pilot.set_motors(on=tenth % 20 == 0, now=now)
    ask(pilot, AHEAD, 5.1)
    pilot.emergency_stop(5.2)
    waiting = frames(pilot)
    assert waiting[:2] == [commands.Stop(), commands.EStop()]
    assert not any(isinstance(command, commands.Vel) for command in waiting)
    assert len({type(command) for command in waiting}) == len(waiting)
    ask(pilot, AHEAD, 5.3)
    assert frames(pilot) == []


def test_an_old_velocity_never_follows_the_stop_after_it() -> None:
    pilot = driving()
    ask(pilot, Twist2(0.1, 0.2), MIN_INTERVAL)
    pilot.stop(MIN_INTERVAL)
    assert frames(pilot) == [commands.Stop()]


BLOCKS = {
    "stall": (seen(enabled=True, stalled=True), "the wheels stalled"),
    "stop button": (seen(stop_button=True), "the stop button on the robot is pressed"),
    "motors off": (STANDING, "the robot switched its motors off"),
}


@pytest.mark.parametrize(("what", "why"), BLOCKS.values(), ids=BLOCKS)
def test_what_began_before_a_stop_is_ignored_however_long(what: Snapshot, why: str) -> None:
    pilot = driving()
    began = pilot.last_stop.number
    pilot.observe(what, 0.1)
    assert pilot.blocked == why
    assert frames(pilot) == vel(0.0)
    after = replace(what, motors=Motors(enabled=what.motors.enabled))
    for tenth in range(2, 100):
        assert str(ask(pilot, AHEAD, tenth / 10, after=began)).startswith(why)
        pilot.observe(after, tenth / 10)
        assert frames(pilot) == []


@pytest.mark.parametrize(("what", "why"), BLOCKS.values(), ids=BLOCKS)
def test_what_begins_after_a_stop_is_obeyed(what: Snapshot, why: str) -> None:
    pilot = driving()
    pilot.observe(what, 0.1)
    assert pilot.blocked == why
    assert ask(pilot, AHEAD, 0.15) is None
    assert pilot.blocked is None


def happens(pilot: Pilot, stop: str) -> None:
    """Let the robot be stopped in some way, at 0.2 s."""
    match stop:
        case "stop":
            pilot.stop(0.2)
        case "motor switch":
            pilot.set_motors(on=True, now=0.2)
        case "emergency stop":
            pilot.emergency_stop(0.2)
            pilot.reset_emergency_stop()
        case "raw command":
            pilot.leave_to_raw_commands(0.2)
        case "sleep":
            pilot.tick(LONGEST_PAUSE + 0.3)
        case "lost link":
            pilot.session_lost("pulled out", 0.2)
            pilot.session_opened(LIMITS, 60.0)
            pilot.observe(STANDING, 60.0)


STOPS = ["stop", "motor switch", "emergency stop", "raw command", "sleep", "lost link"]


@pytest.mark.parametrize("stop", STOPS)
def test_every_stop_outdates_what_began_before(stop: str) -> None:
    pilot = driving()
    began = pilot.last_stop.number
    happens(pilot, stop)
    assert ask(pilot, AHEAD, 60.0, after=began) == pilot.last_stop.told
    assert pilot.asked(60.0) == STILL
    assert ask(pilot, AHEAD, 60.1) is None
    assert pilot.asked(60.1) == AHEAD


def test_what_began_while_the_link_was_lost_or_the_stop_latched_is_outdated_too() -> None:
    lost = driving()
    lost.session_lost("pulled out", 0.2)
    pressed = lost.last_stop.number
    lost.session_opened(LIMITS, 60.0)
    lost.observe(STANDING, 60.0)
    assert "pulled out" in str(ask(lost, AHEAD, 60.0, after=pressed))
    latched = driving()
    latched.emergency_stop(0.2)
    pressed = latched.last_stop.number
    latched.reset_emergency_stop()
    assert "emergency stop was pressed" in str(ask(latched, AHEAD, 1.0, after=pressed))


def test_wheels_that_stay_stalled_are_given_time_to_get_free_and_not_for_ever() -> None:
    pilot = driving()
    stuck = seen(enabled=True, stalled=True)
    pilot.observe(stuck, 0.1)
    away = Twist2(-0.2, 0.0)
    now = 0.2
    assert ask(pilot, away, now) is None
    while not pilot.blocked and now < 10.0:
        now += 0.1
        ask(pilot, away, now)
        pilot.observe(stuck, now)
    assert pilot.blocked == "the wheels stalled"
    assert now == pytest.approx(0.2 + STALL_RECOVERY, abs=0.11)
    assert pilot.last_stop.stalled == away


def test_wheels_that_are_free_may_stall_again_at_once() -> None:
    pilot = driving()
    pilot.observe(seen(enabled=True, stalled=True), 0.1)
    assert ask(pilot, Twist2(-0.2, 0.0), 0.2) is None
    pilot.observe(READY, 0.3)
    assert pilot.blocked is None
    pilot.observe(seen(enabled=True, stalled=True), 0.4)
    assert pilot.blocked == "the wheels stalled"


def test_pushing_on_against_what_stalled_the_wheels_ends_at_the_next_report() -> None:
    pilot = driving()
    stuck = seen(enabled=True, stalled=True)
    pilot.observe(stuck, 0.1)
    assert ask(pilot, Twist2(0.2, 0.1), 0.2) is None
    pilot.observe(stuck, 0.3)
    assert pilot.blocked == "the wheels stalled"


def test_a_stall_while_nothing_is_asked_blocks_nothing() -> None:
    pilot = flying()
    pilot.observe(seen(stalled=True), 0.1)
    assert pilot.blocked is None


def test_a_lost_session_forgets_everything_asked_for() -> None:
    pilot = driving()
    ask(pilot, Twist2(0.1, 0.0), 0.1)
    pilot.session_lost("gone", 0.2)
    assert frames(pilot) == []
    assert pilot.deadline == inf
    assert pilot.asked(0.2) == STILL
    pilot.session_opened(LIMITS, 1.0)
    frames(pilot)
    pilot.observe(READY, 1.0)
    assert frames(pilot) == [OFF]
    pilot.stop(1.1)  # no robot spoke yet when somebody pressed stop: harmless
    assert ask(pilot, AHEAD, 1.2) is None


def test_stop_without_a_session_does_not_make_a_held_key_fresh() -> None:
    pilot = driving()
    pilot.session_lost("gone", 0.2)
    pilot.stop(0.3)
    assert pilot.blocked is not None


def test_a_host_that_slept_longer_than_the_watchdog_waits_for_a_fresh_request() -> None:
    pilot = driving()
    pilot.observe(seen(v=0.3, enabled=True), 2.5)
    assert pilot.blocked == "the watchdog stopped the robot: this program slept 2.5 s"
    assert frames(pilot) == vel(0.0)


def test_a_host_that_hears_reports_has_not_slept() -> None:
    pilot = driving()
    for tenth in range(1, 100):
        pilot.observe(READY, tenth / 10)
    pilot.tick(9.95)
    assert pilot.blocked is None


def test_a_tick_notices_sleep_too() -> None:
    pilot = driving()
    pilot.tick(2.1)
    assert "slept 2.1 s" in str(pilot.blocked)


def test_the_emergency_stop_latches() -> None:
    pilot = driving()
    pilot.emergency_stop(0.1)
    assert frames(pilot) == [commands.Stop(), commands.EStop()]
    assert pilot.emergency
    pilot.observe(READY, 0.2)
    assert frames(pilot) == [OFF]
    assert str(ask(pilot, AHEAD, 5.0)) == "the emergency stop is latched"
    assert str(pilot.set_motors(on=True, now=5.0)) == "the emergency stop is latched"
    assert pilot.set_motors(on=False, now=5.0) is None


def test_while_latched_the_motors_are_kept_off() -> None:
    pilot = driving()
    pilot.emergency_stop(0.1)
    pilot.observe(STANDING, 0.2)
    frames(pilot)
    pilot.observe(READY, 3.0)  # somebody at the robot switches them on
    assert frames(pilot) == [OFF]


def test_after_the_reset_the_motors_stay_off_and_a_held_key_does_nothing() -> None:
    pilot = driving()
    pilot.emergency_stop(0.1)
    held = pilot.last_stop.number
    for tenth in range(2, 20):
        ask(pilot, AHEAD, tenth / 10, after=held)
        pilot.observe(STANDING, tenth / 10)
    pilot.reset_emergency_stop()
    frames(pilot)
    for tenth in range(20, 50):
        assert "emergency stop was pressed" in str(ask(pilot, AHEAD, tenth / 10, after=held))
        pilot.observe(STANDING, tenth / 10)
    assert frames(pilot) == []
    assert ask(pilot, AHEAD, 5.0 + EXPIRY) is None
    assert ON in frames(pilot)


def test_releasing_the_stop_button_brings_no_motors_back() -> None:
    pilot = driving()
    pilot.observe(seen(stop_button=True), 0.1)
    pilot.observe(seen(stop_button=True), 2.0)
    frames(pilot)
    for tenth in range(21, 60):
        pilot.observe(STANDING, tenth / 10)
    assert frames(pilot) == []


def test_a_bumper_stops_what_pushes_it() -> None:
    pilot = driving()
    pilot.observe(seen(v=0.3, enabled=True, bumpers=Bumpers(front=(False, True))), 0.1)
    assert frames(pilot) == vel(0.0)
    ask(pilot, Twist2(-0.2, 0.0), 0.2)
    assert frames(pilot) == vel(-0.2)


def test_what_a_bumper_has_held_up_for_more_than_a_moment_does_not_drive_by_itself() -> None:
    held, free = (seen(enabled=True, bumpers=Bumpers(front=(each, each))) for each in (True, False))
    for seconds, goes_on in ((1.5, True), (2.5, False)):
        pilot = driving()
        for tenth in range(1, round(10 * seconds)):
            pilot.observe(held, tenth / 10)
            pilot.drive(VelocityCommand(AHEAD, after=1), tenth / 10)
        frames(pilot)
        pilot.observe(free, seconds)
        pilot.drive(VelocityCommand(AHEAD, after=1), seconds)
        assert (pilot.asked(seconds) == AHEAD) is goes_on
    assert pilot.blocked == "a bumper was pressed"
    ask(pilot, Twist2(-0.2, 0.0), 2.6)
    assert pilot.asked(2.6).v == -0.2


def test_the_pilot_wants_to_be_asked_again_in_time() -> None:
    pilot = flying(10.0)
    pilot.tick(10.5)
    assert pilot.deadline == 10.5 + REPORT_TIMEOUT  # it stands, and is to stand
    ask(pilot, AHEAD, 10.6, until=10.7)
    assert pilot.deadline == 10.7


@pytest.mark.parametrize("seed", range(40))
def test_a_command_that_is_given_again_after_each_report_is_obeyed_like_a_fresh_one(
    seed: int,
) -> None:
    random, now = Random(seed), 0.0
    several = flying(), flying()
    command = VelocityCommand(STILL, after=several[0].last_stop.number)
    for number in range(400):
        pause = random.choice((0.0, 0.02, 0.1, 0.1, 0.1, 0.3, 0.6))
        while (due := min(pilot.deadline for pilot in several)) <= now + pause:
            now, pause = due, now + pause - due
            for pilot in several:
                pilot.tick(now)
            same(several, now)
        now += pause
        what = random.random()
        if what < 0.2:
            twist = random.choice((AHEAD, STILL, Twist2(0.0, 1.0), Twist2(-0.3, 0.2)))
            after = several[0].last_stop.number
            command = VelocityCommand(twist, now + random.choice((0.05, 0.6, inf)), after=after)
        elif what < 0.3:
            trouble = random.choice(TROUBLE)
            for pilot in several:
                trouble(pilot, now)
        usual = STANDING if number // 50 % 2 else READY  # motors that do not come on at times
        snapshot = random.choice((*[usual] * 20, seen(v=0.3, enabled=True), *SEEN_ONCE))
        for pilot, given in zip(several, (command, replace(command)), strict=True):
            pilot.observe(snapshot, now)
            pilot.drive(given, now)
        same(several, now)


def begin_again(pilot: Pilot, now: float) -> None:
    pilot.session_lost("a cable", now)
    pilot.session_opened(LIMITS, now)


SEEN_ONCE = (
    seen(enabled=True, stalled=True),
    seen(enabled=True, stop_button=True),
    seen(enabled=True, bumpers=Bumpers(front=(True,))),
)
TROUBLE: tuple[Callable[[Pilot, float], object], ...] = (
    lambda pilot, now: pilot.stop(now),
    lambda pilot, now: pilot.emergency_stop(now),
    lambda pilot, now: pilot.reset_emergency_stop(),
    lambda pilot, now: pilot.set_motors(on=False, now=now),
    lambda pilot, now: pilot.set_motors(on=True, now=now),
    lambda pilot, now: pilot.leave_to_raw_commands(now),
    begin_again,
)


def same(several: tuple[Pilot, Pilot], now: float) -> None:
    """Check that two pilots have the same to send, and obey the same."""
    one, other = several
    assert frames(one) == frames(other)
    assert one.asked(now) == other.asked(now)
    assert (one.blocked, one.last_stop) == (other.blocked, other.last_stop)
    assert (one.sent, one.stands, one.switches_on) == (other.sent, other.stands, other.switches_on)
