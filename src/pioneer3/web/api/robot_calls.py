"""What the API does with robots."""

from math import inf

from pioneer3.robot.limits import checked
from pioneer3.web.access.role import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import Call, operation
from pioneer3.web.api.reading import described, read
from pioneer3.web.modes import Goto, Mode
from pioneer3.web.problem import Problem


def list_robots(call: Call) -> list[types.Robot]:
    """List the robots."""
    return [described(view) for view in call.page.robots.values()]


def get_snapshot(call: Call) -> types.Snapshot | Problem:
    """Read everything the robot says."""
    snapshot = call.view.robot.snapshot
    if snapshot is None:
        return Problem(409, "the robot is not connected")
    return read(call.view, snapshot)


def emergency_stop_all(call: Call) -> None:
    """Stop all robots as hard as possible, motors off, until each is reset."""
    call.page.emergency_stop()


def stop(call: Call) -> types.Answered | Problem:
    """Stand still, whoever drives."""
    call.view.robot.arbiter.stop()
    return _answered(call)


def emergency_stop(call: Call) -> types.Answered | Problem:
    """Stop as hard as possible, motors off, until it is reset."""
    call.view.robot.emergency_stop()
    return _answered(call)


def reset_emergency_stop(call: Call) -> types.Answered | Problem:
    """Release the emergency stop. The motors stay off."""
    call.view.robot.reset_emergency_stop()
    return _answered(call)


def switch_motors(call: Call, body: types.Switch) -> types.Answered | Problem:
    """Stop, then switch the motors' power."""
    if refused := _refused(call.view.robot.arbiter.set_motors(on=body.on)):
        return refused
    return _answered(call)


def drive(call: Call, body: types.Velocity) -> types.Answered | Problem:
    """Drive at a velocity, for half a second unless it is sent again.

    Takes the wheel if it is free. Send it 10 to 20 times a second, and 0, 0 in the end.
    """
    twist = checked(body.v, body.w)
    if refused := _refused(call.view.control.drive(call.who, twist)):
        return refused
    return _answered(call)


def get_wheel(call: Call) -> types.WheelState | Problem:
    """Say who has the wheel."""
    holder = call.view.control.holder
    return types.WheelState(holder.name if holder else None, holder is call.who)


def take_wheel(call: Call, body: types.Wanted) -> types.WheelState | Problem:
    """Take the wheel for 5 s, or renew that.

    It is yours for longer while you drive, or a mode that you started runs.
    """
    control = call.view.control
    if body.take_over:
        control.take_over(call.who)
    elif why := control.take(call.who, keep=True):
        return Problem(409, why)
    return get_wheel(call)


def give_up_wheel(call: Call) -> Problem | None:
    """Give up the wheel; the robot stops. Nothing happens if it is not yours."""
    call.view.control.release(call.who)
    return None


def get_mode(call: Call) -> types.ModeState | Problem:
    """Say which mode runs, or how the last one ended."""
    arbiter = call.view.robot.arbiter
    ended = arbiter.ended
    return types.ModeState(
        mode=arbiter.mode.name if arbiter.mode else None,
        decided=list(arbiter.told) if arbiter.mode else [],
        ended=f"{ended.mode.name}: {ended.why}" if ended else None,
        done=ended is not None and ended.done,
    )


def start_mode(call: Call, body: Mode) -> types.ModeState | Problem:
    """Stop, then let the robot drive by itself.

    Takes the wheel if it is free; it is yours while the mode runs.
    """
    refused = call.view.control.start_mode(call.who, body, patience=inf)
    return _refused(refused) or get_mode(call)


def end_mode(call: Call) -> types.ModeState | Problem:
    """End the mode; its motion ends at once."""
    return _refused(call.view.control.end_mode(call.who)) or get_mode(call)


def goto(call: Call, body: Goto) -> types.ModeState | Problem:
    """Drive to a point: the same as that mode."""
    return start_mode(call, body)


def _refused(why: str | None) -> Problem | None:
    return Problem(409, why) if why else None


def _answered(call: Call) -> types.Answered:
    return types.Answered(call.view.robot.why_not_moving())


ROBOT = "/api/robots/{robot}"
LOOK, DO = Role.VIEWER, Role.DRIVER
ROBOTS = (
    operation("GET", "/api/robots", list_robots, LOOK),
    operation("POST", "/api/emergency_stop", emergency_stop_all, LOOK),
    operation("GET", f"{ROBOT}/snapshot", get_snapshot, LOOK, 404, 409),
    operation("POST", f"{ROBOT}/stop", stop, LOOK, 404),
    operation("POST", f"{ROBOT}/emergency_stop", emergency_stop, LOOK, 404),
    operation("POST", f"{ROBOT}/reset", reset_emergency_stop, DO, 404),
    operation("PUT", f"{ROBOT}/motors", switch_motors, DO, 404, 409),
    operation("POST", f"{ROBOT}/drive", drive, DO, 404, 409),
    operation("GET", f"{ROBOT}/wheel", get_wheel, LOOK, 404),
    operation("PUT", f"{ROBOT}/wheel", take_wheel, DO, 404, 409),
    operation("DELETE", f"{ROBOT}/wheel", give_up_wheel, DO, 404),
    operation("GET", f"{ROBOT}/mode", get_mode, LOOK, 404),
    operation("PUT", f"{ROBOT}/mode", start_mode, DO, 404, 409),
    operation("DELETE", f"{ROBOT}/mode", end_mode, DO, 404, 409),
    operation("POST", f"{ROBOT}/goto", goto, DO, 404, 409),
)
