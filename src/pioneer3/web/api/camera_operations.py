"""The operations of the API on cameras.

The server has one connection to a camera, however many look; each gets the newest picture when it
can take one.
"""

from collections.abc import AsyncGenerator, Callable
from contextlib import aclosing

from pioneer3 import mjpeg
from pioneer3.errors import DeviceError
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api.operation import ApiRequest, Jpeg, PictureStream, operation
from pioneer3.web.connections import STREAMING
from pioneer3.web.robot_view import RobotView


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


CAMERA = (
    operation("GET", "/api/robots/{robot}/camera/image", get_camera_image, Role.VIEWER, 404, 409),
    operation("GET", "/api/robots/{robot}/camera/stream", get_camera_stream, Role.VIEWER, 404, 409),
)
