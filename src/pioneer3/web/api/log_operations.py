"""The operations of the API on logs, which are their owners' alone."""

from pioneer3.errors import CommandError
from pioneer3.log.folder import is_being_written
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, RunFile, operation


async def list_logs(request: ApiRequest) -> list[types.LoggedRun]:
    """List the newest logs of this computer's user, the newest first."""
    return await request.page.logs.listed()


async def save_log(request: ApiRequest, body: types.LogNote) -> types.LoggedRun | ErrorResponse:
    """Keep the last five minutes of the running log as one of its own, with a note.

    It is pinned: it stays until somebody removes it.
    """
    try:
        return await request.page.logs.save(body.note, request.caller.name)
    except CommandError as error:
        return ErrorResponse(409, str(error))


def get_log(request: ApiRequest) -> RunFile | ErrorResponse:
    """Return a log; `pioneer3 replay FILE` shows it."""
    try:
        path = request.page.logs.find(request.path["file"])
    except CommandError as error:
        return ErrorResponse(404, str(error))
    if is_being_written(path):
        return ErrorResponse(409, "it is being written: save the last minutes of it instead")
    return RunFile(path)


LOGS = (
    operation("GET", "/api/logs", list_logs, Role.DRIVER),
    operation("POST", "/api/logs", save_log, Role.DRIVER, 409),
    operation("GET", "/api/logs/{file}", get_log, Role.DRIVER, 404, 409),
)
