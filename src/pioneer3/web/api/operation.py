"""One operation of the API: declared once, served and documented from that."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import cleandoc
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_type_hints

import msgspec

from pioneer3.web.access.role import Role
from pioneer3.web.access.sessions import Session
from pioneer3.web.page import Page
from pioneer3.web.problem import Problem
from pioneer3.web.requests import TOO_DEEP
from pioneer3.web.robot_view import RobotView

Method = Literal["GET", "POST", "PUT", "DELETE"]


@dataclass(slots=True, kw_only=True)
class Call:
    """One request to the API.

    Attributes:
        page: What it is about.
        session: Who asks; `None` for a stranger, where strangers may ask.
        scope: ASGI's.
        path: What stood in the braces of the path.
        at: The robot that the path names, `None` where it names none.
        address: Where the request came from.
        cookie: What to set in the browser, `None` for nothing.
    """

    page: Page
    session: Session | None
    scope: Mapping[str, Any]
    path: Mapping[str, str]
    at: RobotView | None = None
    address: str = ""
    cookie: str | None = None

    @property
    def who(self) -> Session:
        """Who asks, where only those who are in may ask."""
        assert self.session is not None
        return self.session

    @property
    def view(self) -> RobotView:
        """The robot that it is about, where the path names one."""
        assert self.at is not None
        return self.at


@dataclass(frozen=True, slots=True, kw_only=True)
class Operation:
    """What a method on a path does.

    Attributes:
        act: Carries it out.
        needs: Role of who may ask, `None` for everybody.
        body: Type of what the request carries, `None` for nothing.
        answer: Type of the answer, `NoneType` for none.
        problems: Statuses of the problems that it may answer with.
    """

    method: Method
    path: str
    act: Callable[..., Any]
    needs: Role | None
    body: Any
    answer: Any
    problems: tuple[int, ...]

    @property
    def name(self) -> str:
        """Unique."""
        return self.act.__name__

    @property
    def text(self) -> tuple[str, str]:
        """What it does: a sentence, and the rest."""
        first, _, rest = cleandoc(self.act.__doc__ or "").partition("\n")
        return first, rest.strip()

    @property
    def parameters(self) -> list[str]:
        """Names in the path."""
        return re.findall(r"{(\w+)}", self.path)


def operation(
    method: Method,
    path: str,
    act: Callable[..., Any],
    needs: Role | None,
    *problems: int,
) -> Operation:
    """Return the operation whose types and words are those of `act`.

    `act` takes a :class:`Call`, and a `body` if requests carry one; it returns the answer or a
    :class:`Problem`.
    """
    hints = get_type_hints(act, include_extras=True)
    answer = hints.pop("return")
    if isinstance(answer, UnionType):
        rest = [kind for kind in get_args(answer) if kind is not Problem]
        answer = rest[0] if len(rest) == 1 else NoneType
    usual = {403} | ({401} if needs else set()) | ({400, 413, 415} if "body" in hints else set())
    return Operation(
        method=method,
        path=path,
        act=act,
        needs=needs,
        body=hints.get("body"),
        answer=answer,
        problems=tuple(sorted({*usual, *problems, 421, 429})),
    )


def decode(operation: Operation, data: bytes) -> Any:
    """Return the body in `data`, checked.

    Raises:
        msgspec.MsgspecError, UnicodeError: it is none; the message says what is wrong with it.
    """
    try:
        return msgspec.json.decode(data or b"{}", type=operation.body)
    except RecursionError:
        raise msgspec.ValidationError(TOO_DEEP) from None
