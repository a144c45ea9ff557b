"""Routes to the operations of the API."""

from collections.abc import Mapping
from inspect import isawaitable

import msgspec
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import BaseRoute, Route

from pioneer3.errors import CommandError
from pioneer3.mjpeg import BOUNDARY, MULTIPART
from pioneer3.web.access.middleware import ErrorResponse, respond, session_of
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.api.access_operations import ACCESS
from pioneer3.web.api.class_operations import CLASS, NO_CLASS
from pioneer3.web.api.log_operations import LOGS
from pioneer3.web.api.navigation_operations import NAVIGATION
from pioneer3.web.api.operation import (
    MEDIA,
    OCTETS,
    ApiRequest,
    Jpeg,
    Operation,
    PictureStream,
    RunFile,
    decode,
    openapi,
)
from pioneer3.web.api.robot_operations import ROBOTS
from pioneer3.web.classroom.downloads import Download
from pioneer3.web.page import Page
from pioneer3.web.requests import NOT_YOURS, ONLY_DRIVERS, ONLY_TEACHERS, REPLAYED

OPERATIONS = (*ROBOTS, *NAVIGATION, *CLASS, *LOGS, *ACCESS)
LONGEST_BODY = 16_384
JSON = "application/json"


def api_routes(page: Page) -> list[BaseRoute]:
    """Return a route for each path, and one for the OpenAPI document."""
    document = openapi(OPERATIONS)

    async def describe(_: Request) -> Response:
        return Response(document, media_type=JSON)

    paths = dict.fromkeys(operation.path for operation in OPERATIONS)
    return [Route("/api/openapi.json", describe), *(_route(page, path) for path in paths)]


def _route(page: Page, path: str) -> Route:
    by_method: dict[str, Operation] = {one.method: one for one in OPERATIONS if one.path == path}

    async def serve(request: Request) -> Response:
        return await _serve(
            page, by_method["GET" if request.method == "HEAD" else request.method], request
        )

    return Route(path, serve, methods=list(by_method))


async def _serve(page: Page, operation: Operation, request: Request) -> Response:
    session = session_of(request)
    if refused := _refuse(operation, session, request.path_params):
        return respond(refused)
    if operation in CLASS and page.classroom is None:
        return respond(NO_CLASS)
    number = request.path_params.get("robot", "")  # as it is written in the list of robots
    if (
        page.replay is not None
        and operation not in ACCESS
        and (number or operation.method != "GET")
    ):
        return respond(ErrorResponse(409, REPLAYED))
    call = ApiRequest(
        page=page,
        session=session,
        scope=request.scope,
        path=request.path_params,
        named={str(n): view for n, view in page.robots.items()}.get(number),
        address=request.client.host if request.client else "",
    )
    if number and call.named is None:
        return respond(ErrorResponse(404, f"there is no robot {number[:20]}"))
    result = await _carry_out(operation, call, request)
    if isawaitable(result):
        result = await result
    return _response(result, call.cookie)


def _response(result: object, cookie: str | None) -> Response:
    """Return the response for the answer of an operation."""
    headers = {"Set-Cookie": cookie} if cookie else None
    match result:
        case ErrorResponse():
            return respond(result)
        case RunFile(path):
            return Download(path, media_type=OCTETS, filename=path.name)
        case Jpeg(data):
            return Response(data, media_type=MEDIA[Jpeg])
        case PictureStream(parts):
            return StreamingResponse(parts, media_type=f"{MULTIPART}; boundary={BOUNDARY}")
        case None:
            return Response(status_code=204, headers=headers)
    return Response(msgspec.json.encode(result), headers=headers, media_type=JSON)


async def _carry_out(operation: Operation, call: ApiRequest, request: Request) -> object:
    if operation.body is None:
        return operation.act(call)
    data = await _read(request)
    if isinstance(data, ErrorResponse):
        return data
    try:
        return operation.act(call, decode(operation, data))
    except (msgspec.MsgspecError, UnicodeError, CommandError) as error:
        return ErrorResponse(400, str(error))


async def _read(request: Request) -> bytes | ErrorResponse:
    """Return the body. Forms of other pages cannot send JSON."""
    kind = request.headers.get("content-type", JSON).partition(";")[0].strip().lower()
    data = bytearray()
    async for chunk in request.stream():
        data += chunk
        if len(data) > LONGEST_BODY:
            return ErrorResponse(413, f"longer than {LONGEST_BODY} bytes")
    if data and kind != JSON:
        return ErrorResponse(415, f"{JSON} is expected, not {kind[:80]}")
    return bytes(data)


def _refuse(
    operation: Operation, session: LoginSession | None, path: Mapping[str, str]
) -> ErrorResponse | None:
    if operation.needs is None:
        return None
    if session is None:
        return ErrorResponse(
            401, "pair this browser, or send a bearer token; see docs/how-to/share.md"
        )
    student = session.role is Role.STUDENT
    if student and path.get("robot", str(session.robot)) != str(session.robot):
        return ErrorResponse(403, NOT_YOURS)
    if not session.role.covers(operation.needs):
        return ErrorResponse(403, ONLY_TEACHERS if student else ONLY_DRIVERS)
    return None
