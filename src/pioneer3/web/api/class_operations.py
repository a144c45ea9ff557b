"""The operations of the API on a class."""

from starlette.datastructures import Headers

from pioneer3.errors import CommandError, ConfigError
from pioneer3.links.hosts import bracketed
from pioneer3.web import messages, requests
from pioneer3.web.access.hosts import host_name
from pioneer3.web.access.invitations import svg
from pioneer3.web.access.middleware import ErrorResponse, cookie
from pioneer3.web.access.sessions import IDLE, Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, RunFile, operation
from pioneer3.web.book import is_built
from pioneer3.web.classroom.classroom import describe

NO_CLASS = ErrorResponse(404, "there is no class here: start one with pioneer3 class")


def join_class(request: ApiRequest, body: types.JoinRequest) -> types.Joined | ErrorResponse:
    """Join a class with its token; the answer sets a cookie.

    Who has joined already keeps the robot, and gets the new name. Others join from other addresses,
    until the teacher lets several join from one.
    """
    classroom = request.classroom
    wait = classroom.limiter.wait(request.address)
    if wait:
        return ErrorResponse(429, f"too many attempts; try again in {wait:.0f} s")
    if not classroom.admits(body.token):
        return ErrorResponse(
            403, "this link is not good any more: ask your teacher for the new one"
        )
    try:
        session, secret = classroom.join(body.name, request.address, request.session)
    except (CommandError, OverflowError) as error:
        return ErrorResponse(409, str(error))
    if secret is not None:
        request.cookie = cookie(request.scope, secret, seconds=IDLE)
    assert session.robot is not None
    seat = classroom.seat(session.robot)
    return types.Joined(session.robot, session.name, seat.url)


def get_class(request: ApiRequest) -> messages.Class | ErrorResponse:
    """Return the class; a student gets the own seat and runs only."""
    return request.classroom.message(request.page.audiences.find(request.caller))


def get_link(request: ApiRequest) -> types.ClassLink | ErrorResponse:
    """Return the address for students, and its QR code."""
    classroom = request.classroom
    return types.ClassLink(classroom.join_url, svg(classroom.join_url), classroom.lan)


def get_installation(request: ApiRequest) -> types.Installation | ErrorResponse:
    """Return the line that installs pioneer3 from here, and the files that there are."""
    downloads = request.classroom.downloads
    if downloads is None:
        return NO_CLASS
    host = host_name(Headers(scope=request.scope).get("host"))
    return types.Installation(
        downloads.command(bracketed(host)),
        downloads.wheels is not None,
        list(downloads.programs),
        is_built(),
    )


def pause_all(request: ApiRequest, body: types.Paused) -> ErrorResponse | None:
    """Stop all robots and let nobody drive, or end that."""
    return _ask(request, requests.PauseRobots(body.paused))


def pause_robot(request: ApiRequest, body: types.Paused) -> ErrorResponse | None:
    """Stop a robot and let nobody drive it, or end that."""
    return _ask(request, requests.PauseRobots(body.paused, request.view.number))


def put_back_all(request: ApiRequest) -> ErrorResponse | None:
    """Stop all simulated robots and put them where they began."""
    return _ask(request, requests.PutBack())


def put_back_robot(request: ApiRequest) -> ErrorResponse | None:
    """Stop a simulated robot and put it where it began."""
    return _ask(request, requests.PutBack(request.view.number))


def lock_class(request: ApiRequest, body: types.Locked) -> ErrorResponse | None:
    """Let no more students join, or let them again."""
    return _ask(request, requests.LockJoining(body.locked))


def share_addresses(request: ApiRequest, body: types.Shared) -> ErrorResponse | None:
    """Let several students join from one network address, or one from each."""
    return _ask(request, requests.ShareAddresses(body.shared))


def free_seat(request: ApiRequest) -> ErrorResponse | None:
    """Show the student of a robot out; the robot stops."""
    return _ask(request, requests.FreeSeat(request.view.number))


def record_run(
    request: ApiRequest, body: types.RecordingStep
) -> types.RecordingState | ErrorResponse:
    """Record a run of a robot, end the recording, hand it in, or drop it."""
    classroom = request.classroom
    try:
        run = classroom.record(request.view.number, body.step)
    except (CommandError, ConfigError) as error:
        return ErrorResponse(409, str(error))
    recording = classroom.seat(request.view.number).recording
    return types.RecordingState(recording, describe(run) if run is not None else None)


def list_runs(request: ApiRequest) -> list[messages.HandedIn] | ErrorResponse:
    """List the runs that were handed in; a student's own."""
    return list(request.classroom.handed_in(request.caller.robot))


def get_run(request: ApiRequest) -> RunFile | ErrorResponse:
    """Return a run that was handed in; `pioneer3 replay FILE` shows it."""
    classroom = request.classroom
    name = request.path["file"]
    own = {run.file for run in classroom.handed_in(request.caller.robot)}
    path = classroom.runs.find(name) if name in own else None
    if path is None or not path.is_file():
        return ErrorResponse(404, "there is no run of this name")
    return RunFile(path)


def _ask(request: ApiRequest, wish: requests.ClassRequest) -> ErrorResponse | None:
    """Carry out what a page could ask as well."""
    refused = request.classroom.carry_out(wish)
    return ErrorResponse(409, refused.text) if refused else None


ROBOT = "/api/class/robots/{robot}"
VIEWER, STUDENT, DRIVER = Role.VIEWER, Role.STUDENT, Role.DRIVER
CLASS = (
    operation("POST", "/api/class/join", join_class, None, 403, 404, 409),
    operation("GET", "/api/class", get_class, VIEWER, 404),
    operation("GET", "/api/class/link", get_link, DRIVER, 404),
    operation("GET", "/api/class/installation", get_installation, None, 404),
    operation("PUT", "/api/class/paused", pause_all, DRIVER, 404, 409),
    operation("POST", "/api/class/put_back", put_back_all, DRIVER, 404, 409),
    operation("PUT", "/api/class/locked", lock_class, DRIVER, 404, 409),
    operation("PUT", "/api/class/shared", share_addresses, DRIVER, 404, 409),
    operation("GET", "/api/class/runs", list_runs, STUDENT, 404),
    operation("GET", "/api/class/runs/{file}", get_run, STUDENT, 404),
    operation("PUT", f"{ROBOT}/paused", pause_robot, DRIVER, 404, 409),
    operation("POST", f"{ROBOT}/put_back", put_back_robot, DRIVER, 404, 409),
    operation("PUT", f"{ROBOT}/recording", record_run, STUDENT, 404, 409),
    operation("DELETE", ROBOT, free_seat, DRIVER, 404, 409),
)
