"""A script at the API, without a network between: it speaks ASGI with the application."""

import json
from collections.abc import MutableMapping
from dataclasses import dataclass
from typing import Any

from starlette.types import ASGIApp

from tests.unit.web.browser import HERE

LAN = "192.168.0.7:8080"
ELSEWHERE = "192.168.0.99"


@dataclass(frozen=True)
class Answer:
    """What came back."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        """The body, which is JSON."""
        return json.loads(self.body)

    @property
    def detail(self) -> str:
        """The reason in a problem, which must be one."""
        assert self.headers["content-type"] == "application/problem+json"
        assert self.json["status"] == self.status
        return str(self.json["detail"])


@dataclass(frozen=True)
class Script:
    """Asks `app` from `peer`, with `headers` on every request."""

    app: ASGIApp
    host: str = HERE
    peer: str = "127.0.0.1"
    headers: tuple[tuple[str, str], ...] = ()
    scheme: str = "http"

    def with_headers(self, **headers: str) -> "Script":
        """Return the same with more headers."""
        more = tuple((name.replace("_", "-"), value) for name, value in headers.items())
        return Script(self.app, self.host, self.peer, (*self.headers, *more), self.scheme)

    async def ask(
        self, method: str, path: str, body: object = None, *, raw: bytes | None = None
    ) -> Answer:
        """Return the answer to one request; `body` is sent as JSON, `raw` as it is."""
        data = raw if raw is not None else b"" if body is None else json.dumps(body).encode()
        headers = {"host": self.host, "content-type": "application/json", **dict(self.headers)}
        scope = {
            "type": "http",
            "asgi": {"version": "3.0", "spec_version": "2.4"},
            "scheme": self.scheme,
            "method": method,
            "path": path,
            "query_string": b"",
            "headers": [(n.encode(), v.encode()) for n, v in headers.items()],
            "client": (self.peer, 50000),
            "server": ("127.0.0.1", 8080),
        }
        sent: list[MutableMapping[str, Any]] = []

        async def receive() -> dict[str, Any]:
            return {"type": "http.request", "body": data, "more_body": False}

        async def send(message: MutableMapping[str, Any]) -> None:
            sent.append(message)

        try:
            await self.app(scope, receive, send)
        except Exception:  # after its answer, for the log of the server
            if not sent:
                raise
        head = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
        return Answer(sent[0]["status"], head, b"".join(m.get("body", b"") for m in sent[1:]))


def stranger(app: ASGIApp) -> Script:
    """Return somebody on the network who is not paired."""
    return Script(app, host=LAN, peer=ELSEWHERE)
