"""Routes to the files that students load from a class.

=================  =============================================================================
address            contents
=================  =============================================================================
`/NAME.whl`        the wheel of this package as it runs here
`/wheels/`         a page of links for `pip install --find-links`, where there is a wheelhouse
`/wheels/NAME`     one of its wheels
`/programs/NAME`   a program of a lesson, with the address of the caller's robot filled in
=================  =============================================================================

Wheels are for everybody who reaches the page: nothing of the class is in them. Programs need a
session, which tells the robot. Names are looked up among those that there are, so a path leads
nowhere else.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.routing import Route
from starlette.types import Message, Receive, Scope, Send

from pioneer3.classroom.downloads import KINDS, Downloads
from pioneer3.web.access.middleware import session_of
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.connections import TAKING
from pioneer3.web.page import Page

WHEEL_KIND: Final = "application/octet-stream"
"""Media type of wheels, as package indexes have it."""


class Download(FileResponse):
    """A file that may take as long as its reader goes on taking it."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the file."""
        goes_on: Callable[[], None] = scope.get("extensions", {}).get(TAKING, lambda: None)

        async def send_on(message: Message) -> None:
            goes_on()
            await send(message)

        await super().__call__(scope, receive, send_on)


def download_routes(page: Page) -> list[Route]:
    """Return the routes of the files; without a class there are none of them."""

    def found() -> Downloads:
        if page.classroom is None or page.classroom.downloads is None:
            raise HTTPException(404, "there is no class here: start one with pioneer3 class")
        return page.classroom.downloads

    async def wheel(request: Request) -> Response:
        path = found().wheel
        if request.path_params["name"] != path.name.removesuffix(".whl"):
            raise HTTPException(404, f"this class has another version: {path.name}")
        return Download(path, media_type=WHEEL_KIND)

    async def links(_: Request) -> Response:
        downloads = found()
        if downloads.wheels is None:
            raise HTTPException(404, "this class has no wheelhouse: start it with --wheelhouse")
        return HTMLResponse(downloads.links())

    async def other_wheel(request: Request) -> Response:
        path = (found().wheels or {}).get(request.path_params["name"])
        if path is None or not path.is_file():
            raise HTTPException(404, "there is no wheel of this name")
        return Download(path, media_type=WHEEL_KIND)

    async def program(request: Request) -> Response:
        downloads, name = found(), request.path_params["name"]
        if name not in downloads.programs:
            raise HTTPException(404, "there is no program of this name")
        text = downloads.program(name, _robot_url(page, request))
        return Response(
            text,
            media_type=KINDS[Path(name).suffix],
            headers={"Content-Disposition": f'attachment; filename="{name}"'},
        )

    return [
        Route("/{name}.whl", wheel),
        Route("/wheels/", links),
        Route("/wheels/{name}", other_wheel),
        Route("/programs/{name}", program),
    ]


def _robot_url(page: Page, request: Request) -> str:
    """Return the address of the caller's robot; a teacher names one by `?robot=`."""
    session = session_of(request)
    if session is None:
        raise HTTPException(401, "join the class first: a program is for your robot")
    number = _number(session, request.query_params.get("robot", "1"))
    assert page.classroom is not None
    robot = page.classroom.robots.get(number)
    if robot is None:
        raise HTTPException(404, "there is no robot of this number")
    return robot.url


def _number(session: LoginSession, named: str) -> int:
    if session.role is Role.STUDENT:
        return session.robot or 0
    return int(named) if named.isascii() and named.isdigit() and len(named) < 4 else 0
