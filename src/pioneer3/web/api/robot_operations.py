"""The operations of the API on robots, their cameras and their bodies.

The server has one connection to a camera, however many look; each gets the newest picture when it
can take one. Bodies are from the description that URDF is made of.
"""

from collections.abc import AsyncGenerator, Callable, Iterator, Mapping
from contextlib import aclosing
from math import inf

from pioneer3 import mjpeg
from pioneer3.behaviors.modes import AnyMode, Goto
from pioneer3.errors import DeviceError, MotionError, Refusal
from pioneer3.models import RobotModel, load_model, model_names
from pioneer3.models.description.solids import COLORS, LinkSolid, solids_of
from pioneer3.models.description.tree import Frames, FrameTree, tree_of
from pioneer3.robot.limits import checked, wheels_as_twist
from pioneer3.web import group, messages
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, Jpeg, PictureStream, operation
from pioneer3.web.connections import STREAMING
from pioneer3.web.modes import ModeForm, forms, group_forms
from pioneer3.web.page import Page
from pioneer3.web.robot_view import RobotView


def list_robots(request: ApiRequest) -> list[messages.ListedRobot]:
    """List the robots; a student's own only. The `id` of each is its number in the paths."""
    own = request.caller.robot
    return [view.describe() for n, view in request.page.robots.items() if own in {None, n}]


def get_status(request: ApiRequest) -> messages.Status:
    """Return the state of the connection to the robot."""
    return request.view.status()


def get_snapshot(request: ApiRequest) -> messages.SnapshotMessage | ErrorResponse:
    """Return the newest snapshot of the robot."""
    snapshot = request.view.robot.snapshot
    if snapshot is None:
        return ErrorResponse(409, "the robot is not connected")
    return request.view.snapshot(snapshot, request.page.clients)


def emergency_stop_all(request: ApiRequest) -> None:
    """Stop all robots as hard as possible, motors off, until each is reset.

    A student stops the own one.
    """
    request.page.emergency_stop(request.caller.robot)


def stop(request: ApiRequest) -> types.CommandResult | ErrorResponse:
    """Stop the robot, whoever drives."""
    request.view.robot.arbiter.stop()
    return _result(request)


def emergency_stop(request: ApiRequest) -> types.CommandResult | ErrorResponse:
    """Stop as hard as possible, motors off, until it is reset."""
    request.view.robot.emergency_stop()
    return _result(request)


def reset_emergency_stop(request: ApiRequest) -> types.CommandResult | ErrorResponse:
    """Release the emergency stop. The motors stay off."""
    request.view.robot.reset_emergency_stop()
    return _result(request)


def switch_motors(
    request: ApiRequest, body: types.MotorPower
) -> types.CommandResult | ErrorResponse:
    """Stop, then switch the motors' power."""
    refused = request.view.control.switch_motors(request.caller, on=body.on)
    return _refused(refused) or _result(request)


def drive(request: ApiRequest, body: types.Velocity) -> types.CommandResult | ErrorResponse:
    """Drive at a velocity, for half a second unless it is sent again.

    Takes control if it is free. Send it 10 to 20 times a second, and 0, 0 in the end.
    """
    refused = request.view.control.drive(request.caller, checked(body.v, body.w))
    return _refused(refused) or _result(request)


def drive_wheels(
    request: ApiRequest, body: types.WheelSpeeds
) -> types.CommandResult | ErrorResponse:
    """Drive the wheels of each side at a speed, as `drive` does."""
    twist = wheels_as_twist(body.left, body.right, request.view.robot.info.model)
    return drive(request, types.Velocity(v=twist.v, w=twist.w))


def get_control(request: ApiRequest) -> types.ControlState | ErrorResponse:
    """Return who has control of the robot."""
    holder = request.view.control.holder
    return types.ControlState(holder.name if holder else None, holder is request.caller)


def take_control(
    request: ApiRequest, body: types.ControlRequest
) -> types.ControlState | ErrorResponse:
    """Take control for 5 s, or renew that.

    It is yours for longer while you drive, or a mode that you started runs.
    """
    control = request.view.control
    if body.take_over:
        refused = control.take_over(request.caller)
    else:
        refused = control.take(request.caller, keep=True)
    return _refused(refused) or get_control(request)


def release_control(request: ApiRequest) -> ErrorResponse | None:
    """Release control; the robot stops. Nothing happens if it is not yours."""
    request.view.release(request.caller)
    return None


def list_modes(request: ApiRequest) -> list[ModeForm]:
    """List the modes and their parameters, as the page's forms show them."""
    return forms()


def get_mode(request: ApiRequest) -> messages.ModeState | ErrorResponse:
    """Return the running mode, or how the last one ended."""
    return request.view.mode()


def start_mode(request: ApiRequest, body: AnyMode) -> messages.ModeState | ErrorResponse:
    """Stop, then start a mode.

    Takes control if it is free; it is yours while the mode runs.
    """
    refused = request.view.control.start_mode(request.caller, body, patience=inf)
    return _refused(refused) or get_mode(request)


def end_mode(request: ApiRequest) -> messages.ModeState | ErrorResponse:
    """End the mode and a goal that still waits; the motion ends at once."""
    return _refused(request.view.end_mode(request.caller)) or get_mode(request)


def list_group_modes(request: ApiRequest) -> list[ModeForm]:
    """List the modes of several robots and their parameters."""
    return group_forms()


def start_group_mode(request: ApiRequest, body: types.Group) -> ErrorResponse | None:
    """Start a mode of several robots, of all of them or none.

    Takes control of each but the leader, where it is free. Each mode ends as one that was started
    for its robot alone.
    """
    try:
        refused = group.start(
            request.page, request.caller, body.mode, body.robots, body.leader, waits=False
        )
    except MotionError as error:
        refused = Refusal(str(error))
    return _refused(refused)


def goto(request: ApiRequest, body: Goto) -> messages.ModeState | ErrorResponse:
    """Drive to a point: the same as that mode."""
    return start_mode(request, body)


def _refused(refused: Refusal | None) -> ErrorResponse | None:
    return ErrorResponse(409, refused.text) if refused else None


def _result(request: ApiRequest) -> types.CommandResult:
    why = request.view.robot.why_not_moving()
    return types.CommandResult(why and why.text)


async def get_camera_image(request: ApiRequest) -> Jpeg | ErrorResponse:
    """Return the next picture of the robot's camera, as JPEG.

    It waits for one that is new, so that a program that asks again and again gets each once.
    """
    try:
        picture = await request.view.robot.devices.camera.picture(max_age=0.0)
    except DeviceError as error:
        return ErrorResponse(409, str(error))
    return Jpeg(picture.jpeg)


async def get_camera_stream(request: ApiRequest) -> PictureStream | ErrorResponse:
    """Return the pictures of the robot's camera as MJPEG: JPEG parts without end.

    A viewer that is slow gets fewer of them. The stream ends with the session.
    """
    view = request.view
    try:
        await view.robot.devices.camera.picture()
    except DeviceError as error:
        return ErrorResponse(409, str(error))
    extensions = request.scope.get("extensions", {})
    return PictureStream(_parts(view, request, extensions.get(STREAMING, lambda: None)))


async def _parts(
    view: RobotView, request: ApiRequest, goes_on: Callable[[], None]
) -> AsyncGenerator[bytes, None]:
    async with aclosing(view.robot.devices.camera.pictures()) as pictures:
        async for picture in pictures:
            if request.caller.ended.is_set():
                return
            goes_on()
            yield mjpeg.part(picture.jpeg, picture.view)


def get_body(request: ApiRequest) -> types.RobotBody | ErrorResponse:
    """Return the body of a type of robot: boxes and cylinders, as its URDF has them."""
    name = request.path["model"]
    model = _model(request.page, name)
    if model is None:
        return ErrorResponse(
            404, f"there is no model {name[:40]!r}; `pioneer3 model list` shows all"
        )
    return body_of(model)


def body_of(model: RobotModel) -> types.RobotBody:
    """Return the body of a robot of this type."""
    frames = Frames()
    tree = tree_of(model, frames)
    return types.RobotBody(model.name, tuple(_links(tree, solids_of(model, tree, frames))))


def _model(page: Page, name: str) -> RobotModel | None:
    """Return the model of a robot of the page, or a shipped one; `None` if there is none."""
    for view in page.robots.values():
        info = view.robot.supervisor.info
        if info is not None and info.model.name == name:
            return info.model
    return load_model(name) if name in model_names() else None


def _links(
    tree: FrameTree, solids: Mapping[str, tuple[LinkSolid, ...]]
) -> Iterator[types.DescribedLink]:
    fixed, wheels = tree.fixed_in_base(), {joint.child: joint for joint in tree.wheels}
    for name, parts in solids.items():
        wheel = wheels.get(name)
        x, y, z, yaw = (wheel.x, wheel.y, wheel.z, 0.0) if wheel else fixed[name]
        yield types.DescribedLink(
            at=(x, y, z),
            yaw=yaw,
            wheel=("left" if wheel.y > 0 else "right") if wheel else None,
            solids=tuple(_solid(part) for part in parts),
        )


def _solid(solid: LinkSolid) -> types.DescribedSolid:
    return types.DescribedSolid(
        shape="cylinder" if solid.is_round else "box",
        color=COLORS[solid.color],
        size=solid.size,
        at=solid.at,
        turned=solid.turned,
    )


ROBOT = "/api/robots/{robot}"
VIEWER, STUDENT, DRIVER = Role.VIEWER, Role.STUDENT, Role.DRIVER
ROBOTS = (
    operation("GET", "/api/robots", list_robots, VIEWER),
    operation("POST", "/api/emergency_stop", emergency_stop_all, VIEWER),
    operation("GET", f"{ROBOT}/status", get_status, VIEWER, 404),
    operation("GET", f"{ROBOT}/snapshot", get_snapshot, VIEWER, 404, 409),
    operation("POST", f"{ROBOT}/stop", stop, VIEWER, 404),
    operation("POST", f"{ROBOT}/emergency_stop", emergency_stop, VIEWER, 404),
    operation("POST", f"{ROBOT}/reset", reset_emergency_stop, STUDENT, 404),
    operation("PUT", f"{ROBOT}/motors", switch_motors, STUDENT, 404, 409),
    operation("POST", f"{ROBOT}/drive", drive, STUDENT, 404, 409),
    operation("POST", f"{ROBOT}/drive_wheels", drive_wheels, STUDENT, 404, 409),
    operation("GET", f"{ROBOT}/control", get_control, VIEWER, 404),
    operation("PUT", f"{ROBOT}/control", take_control, STUDENT, 404, 409),
    operation("DELETE", f"{ROBOT}/control", release_control, STUDENT, 404),
    operation("GET", "/api/modes", list_modes, VIEWER),
    operation("GET", "/api/group_modes", list_group_modes, VIEWER),
    operation("POST", "/api/group_mode", start_group_mode, DRIVER, 404, 409),
    operation("GET", f"{ROBOT}/mode", get_mode, VIEWER, 404),
    operation("PUT", f"{ROBOT}/mode", start_mode, STUDENT, 404, 409),
    operation("DELETE", f"{ROBOT}/mode", end_mode, STUDENT, 404, 409),
    operation("POST", f"{ROBOT}/goto", goto, STUDENT, 404, 409),
    operation("GET", f"{ROBOT}/camera/image", get_camera_image, VIEWER, 404, 409),
    operation("GET", f"{ROBOT}/camera/stream", get_camera_stream, VIEWER, 404, 409),
    operation("GET", "/api/models/{model}", get_body, VIEWER, 404),
)
