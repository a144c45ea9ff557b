"""Routes: the page, its parts, its WebSocket and the API.

Pages name their parts under a version, which is made of the contents of all of them. Browsers keep
what has a version, and load nothing anew; after an upgrade, pages name another version.
"""

import gzip
import re
from collections.abc import Awaitable, Callable
from functools import cache
from hashlib import sha256
from pathlib import Path

from starlette.applications import Starlette
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope
from starlette.websockets import WebSocket

from pioneer3.errors import CommandError, ConfigError
from pioneer3.web.access.hosts import LOCAL_NAMES
from pioneer3.web.access.middleware import (
    POLICY_VIOLATION,
    AccessMiddleware,
    respond_to_failure,
    respond_to_http_exception,
    session_of,
)
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.api.routes import api_routes
from pioneer3.web.book import book_routes, is_built
from pioneer3.web.classroom.downloads import download_routes
from pioneer3.web.client import Client
from pioneer3.web.messages import Refused, encode
from pioneer3.web.page import Page
from pioneer3.web.replay.replay import LogPlayer

STATIC = Path(__file__).with_name("static")
IMPORT = re.compile(r'^(?:import|\}) (?:.* )?from "(\..+)";$', re.MULTILINE)
HELP = '  <link rel="help" href="/book/">\n'
NO_REPLAY = 4404
"""Close code where there is no such log."""
TEXTS = {"text/css", "text/javascript", "application/javascript"}
KEPT = "max-age=31536000, immutable"
PAGES = {
    "/pair": "pages/pair.html",
    "/api": "pages/api.html",
    "/join": "pages/join.html",
    "/class": "pages/class.html",
    "/lessons": "pages/lessons.html",
}
FILES = {
    "/app.webmanifest": "app/app.webmanifest",
    "/worker.js": "app/worker.js",  # here: a worker serves only its own folder
}


def make_app(page: Page, names: frozenset[str] = LOCAL_NAMES) -> ASGIApp:
    """Return the application; it answers to `names` only.

    The files of the page are no secret; the robot is behind the WebSocket and the API.
    """

    async def connect(socket: WebSocket) -> None:
        session = session_of(socket)
        if session is None:
            await socket.close(POLICY_VIOLATION)
            return
        name = socket.query_params.get("replay")
        if name is None:
            await Client(page, socket, session).serve()
        elif session.role is not Role.DRIVER:
            await socket.close(POLICY_VIOLATION)
        else:
            await replay(name, socket, session)

    async def replay(name: str, socket: WebSocket, session: LoginSession) -> None:
        try:
            async with page.logs.opened(name) as log:
                beside = page.beside()
                async with beside.replaying(LogPlayer([log], beside.audiences, gentle=True)):
                    await Client(beside, socket, session).serve()
        except (CommandError, ConfigError) as error:
            await socket.accept()
            await socket.send_text(encode(Refused(str(error))))
            await socket.close(NO_REPLAY)

    async def authority(_: Request) -> Response:
        if page.access.authority is None:
            raise HTTPException(404, "there is no certificate of ours to trust")
        return FileResponse(page.access.authority, media_type="application/x-x509-ca-cert")

    app = Starlette(
        routes=[
            Route("/ca.crt", authority),
            Route("/", _page(index())),
            *(Route(path, _page(versioned(name))) for path, name in PAGES.items()),
            *(Route(path, _file(name)) for path, name in FILES.items()),
            WebSocketRoute("/ws", connect),
            *api_routes(page),
            *book_routes(),
            *download_routes(page),
            Mount("/static", _Parts(directory=STATIC)),
        ],
        exception_handlers={
            HTTPException: respond_to_http_exception,
            Exception: respond_to_failure,
        },
    )
    return AccessMiddleware(app, page.access, names)


@cache
def index() -> str:
    """Return the page. It names all its modules, so that browsers load them side by side.

    Where the book is built, it names that too, for links from sentences about faults.
    """
    html = versioned("index.html")
    start = f"/static/{version()}/"
    (main,) = re.findall(rf'<script type="module" src="{start}(.+?)"', html)
    links = (f'  <link rel="modulepreload" href="{start}{name}">\n' for name in modules(main)[1:])
    book = HELP if is_built() else ""
    return html.replace("</head>", f"{''.join(links)}{book}</head>")


def versioned(name: str) -> str:
    """Return a page of STATIC that names its parts under their version."""
    return (STATIC / name).read_text("utf-8").replace('"/static/', f'"/static/{version()}/')


@cache
def version() -> str:
    """Return the version of all files of STATIC: 16 hexadecimal digits."""
    contents = sha256()
    for path in sorted(path for path in STATIC.rglob("*") if path.is_file()):
        contents.update(path.relative_to(STATIC).as_posix().encode())
        contents.update(sha256(path.read_bytes()).digest())
    return contents.hexdigest()[:16]


def modules(main: str) -> list[str]:
    """Return `main` and all modules that it imports, also through others, as paths below STATIC."""
    found = [main]
    for name in found:  # grows meanwhile
        folder = (STATIC / name).parent
        for imported in IMPORT.findall((STATIC / name).read_text("utf-8")):
            path = (folder / imported).resolve().relative_to(STATIC.resolve()).as_posix()
            if path not in found:
                found.append(path)
    return found


@cache
def _compressed(path: Path) -> bytes:
    """Return a file of STATIC, compressed once: it would take long in the robot's loop."""
    return gzip.compress(path.read_bytes(), mtime=0)


class _Parts(StaticFiles):
    """Serves the files of STATIC: to be kept under their version, to be asked for without one."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return the response; under any other version there is nothing."""
        name = path.removeprefix(f"{version()}/")
        response = await super().get_response(name, scope)
        if name == path:
            return response
        if isinstance(response, FileResponse) and response.media_type in TEXTS:
            accepted = Headers(scope=scope).get("accept-encoding", "")
            if "gzip" in accepted and scope["method"] == "GET":
                packed = _compressed(Path(response.path))
                headers = {"Content-Encoding": "gzip"}
                response = Response(packed, media_type=response.media_type, headers=headers)
            response.headers["Vary"] = "Accept-Encoding"
        response.headers["Cache-Control"] = KEPT
        return response


def _page(html: str) -> Callable[[Request], Awaitable[Response]]:
    async def serve(_: Request) -> Response:
        return HTMLResponse(html)

    return serve


def _file(name: str) -> Callable[[Request], Awaitable[Response]]:
    async def serve(_: Request) -> Response:
        return FileResponse(STATIC / name)

    return serve
