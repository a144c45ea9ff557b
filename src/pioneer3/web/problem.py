"""Errors as RFC 9457 problem details: what went wrong, in words."""

from http import HTTPStatus

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

MEDIA_TYPE = "application/problem+json"


class Problem(msgspec.Struct, frozen=True):
    """Why a request was not carried out (RFC 9457).

    Attributes:
        status: The HTTP status.
        detail: The reason, for people.
        title: The status in words.
    """

    status: int
    detail: str
    title: str = ""


def answer(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """Return the response that tells of `problem`."""
    titled = msgspec.structs.replace(problem, title=HTTPStatus(problem.status).phrase)
    return Response(
        msgspec.json.encode(titled),
        problem.status,
        headers={"WWW-Authenticate": "Bearer"} if problem.status == 401 else headers,
        media_type=MEDIA_TYPE,
    )


def of_http_exception(_: Request, error: Exception) -> Response:
    """Answer what the router refuses: no such path, no such method."""
    assert isinstance(error, HTTPException)
    return answer(Problem(error.status_code, error.detail), dict(error.headers or {}))


def of_failure(_: Request, error: Exception) -> Response:
    """Answer an error of ours; the log has the rest."""
    return answer(Problem(500, "an error of the server; its log says more"))
