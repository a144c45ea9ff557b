"""One operation of the API: declared once, served and documented from that."""

import re
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from inspect import cleandoc
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_type_hints

import msgspec
from starlette.types import Scope

from pioneer3 import __version__
from pioneer3.mjpeg import MULTIPART
from pioneer3.web.access.middleware import MEDIA_TYPE, ErrorResponse
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.classroom.classroom import Classroom
from pioneer3.web.page import Page
from pioneer3.web.requests import TOO_DEEP
from pioneer3.web.robot_view import RobotView

Method = Literal["GET", "POST", "PUT", "DELETE"]
Json = dict[str, object]
"""An object of JSON that is written as it is."""
OCTETS = "application/octet-stream"
PERMISSIONS = {
    None: "For everybody.",
    Role.VIEWER: "For everybody with a session.",
    Role.STUDENT: "For drivers, and for the student of the robot.",
    Role.DRIVER: "For drivers.",
}


@dataclass(slots=True, kw_only=True)
class ApiRequest:
    """One request to the API, with the parameters in its path, and the robot that this names.

    The session is the caller's, `None` where a caller needs none, and the address that of the
    network. The answer has a `cookie` as its Set-Cookie header, `None` for none.
    """

    page: Page
    session: LoginSession | None
    scope: Scope
    path: Mapping[str, str]
    named: RobotView | None = None
    address: str = ""
    cookie: str | None = None

    @property
    def caller(self) -> LoginSession:
        """The caller's session, where one is needed."""
        assert self.session is not None
        return self.session

    @property
    def classroom(self) -> Classroom:
        """The class, where there is one."""
        assert self.page.classroom is not None
        return self.page.classroom

    @property
    def view(self) -> RobotView:
        """The robot that the path names, where it names one."""
        assert self.named is not None
        return self.named


@dataclass(frozen=True, slots=True)
class RunFile:
    """An answer that is a file, for people to keep under its name."""

    path: Path


@dataclass(frozen=True, slots=True)
class Jpeg:
    """An answer that is a picture."""

    data: bytes


@dataclass(frozen=True, slots=True)
class PictureStream:
    """An answer that is picture after picture, as parts of MJPEG."""

    parts: AsyncIterator[bytes]


MEDIA = {RunFile: OCTETS, Jpeg: "image/jpeg", PictureStream: MULTIPART}
"""Types of answers that are no JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Operation:
    """A method on a path; `act` carries out a request, for which a caller `needs` a role.

    A request has a body of some type, or `None`, and the answer one, or `NoneType`.
    """

    method: Method
    path: str
    act: Callable[..., Any]
    needs: Role | None
    body: Any
    answer: Any
    errors: tuple[int, ...]

    @property
    def name(self) -> str:
        """Unique."""
        return self.act.__name__

    @property
    def text(self) -> tuple[str, str]:
        """Its description: the first sentence, and the rest."""
        first, _, rest = cleandoc(self.act.__doc__ or "").partition("\n")
        return first, rest.strip()

    @property
    def parameters(self) -> list[str]:
        """Names in the path."""
        return re.findall(r"{(\w+)}", self.path)


def operation(
    method: Method, path: str, act: Callable[..., Any], needs: Role | None, *errors: int
) -> Operation:
    """Return the operation with the types and the docstring of `act`.

    `act` takes an :class:`ApiRequest`, and a `body` if requests have one; it returns the answer or
    an :class:`ErrorResponse`.
    """
    hints = get_type_hints(act, include_extras=True)
    answer = hints.pop("return")
    if isinstance(answer, UnionType):
        rest = [kind for kind in get_args(answer) if kind is not ErrorResponse]
        answer = rest[0] if len(rest) == 1 else NoneType
    usual = {403} | ({401} if needs else set()) | ({400, 413, 415} if "body" in hints else set())
    return Operation(
        method=method,
        path=path,
        act=act,
        needs=needs,
        body=hints.get("body"),
        answer=answer,
        errors=tuple(sorted({*usual, *errors, 421, 429})),
    )


def decode(operation: Operation, data: bytes) -> Any:
    """Return the body in `data`, checked.

    Raises:
        msgspec.MsgspecError, UnicodeError: the body is invalid; the message says why.
    """
    try:
        return msgspec.json.decode(data or b"{}", type=operation.body)
    except RecursionError:
        raise msgspec.ValidationError(TOO_DEEP) from None


def openapi(operations: Sequence[Operation]) -> bytes:
    """Return the JSON document that describes `operations` (OpenAPI 3.1)."""
    kinds = [kind for one in operations for kind in (one.body, one.answer) if _has_schema(kind)]
    schemas, components = msgspec.json.schema_components(
        [*kinds, ErrorResponse], ref_template="#/components/schemas/{name}"
    )
    refs = iter(schemas)
    paths: dict[str, Json] = {}
    for one in operations:
        described = _describe(one)
        if _has_schema(one.body):
            described["requestBody"] = {"required": True, "content": _content(next(refs))}
        success: Json = {"description": "Done."}
        if _has_schema(one.answer):
            success["content"] = _content(next(refs))
        elif one.answer in MEDIA:
            success["content"] = _content({"type": "string"}, MEDIA[one.answer])
        status = "200" if "content" in success else "204"
        described["responses"] = {status: success, **_errors(one, schemas[-1])}
        paths.setdefault(one.path, {})[one.method.lower()] = described
    document = {
        "openapi": "3.1.0",
        "info": {
            "title": "pioneer3",
            "version": __version__,
            "description": "Drive a Pioneer 3. SI units, angles counter-clockwise.",
        },
        "paths": paths,
        "components": {
            "schemas": components,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }
    return msgspec.json.encode(document)


def _has_schema(kind: object) -> bool:
    return kind not in {None, NoneType, *MEDIA}


def _content(schema: Json, media_type: str = "application/json") -> Json:
    return {media_type: {"schema": schema}}


def _errors(one: Operation, schema: Json) -> Json:
    content = _content(schema, MEDIA_TYPE)
    return {
        str(status): {"description": HTTPStatus(status).phrase, "content": content}
        for status in one.errors
    }


def _describe(one: Operation) -> Json:
    summary, rest = one.text
    return {
        "operationId": one.name,
        "summary": summary,
        "description": f"{rest}\n\n{PERMISSIONS[one.needs]}".strip(),
        "tags": [one.path.split("/")[2]],
        "security": [{"token": []}] if one.needs else [],
        "parameters": [
            {
                "name": name,
                "in": "path",
                "required": True,
                "schema": {"type": "integer"} if name == "robot" else {"type": "string"},
            }
            for name in one.parameters
        ],
    }
