"""Streams of JPEG pictures over HTTP, as network cameras send them; without I/O.

The answer to a GET is `multipart/x-mixed-replace`: part after part, each a picture, without end.
A camera may leave out the length of a part; the next boundary ends it then.
"""

import re
from base64 import b64encode
from collections.abc import Mapping
from dataclasses import dataclass, replace
from hashlib import md5, sha256
from math import pi
from typing import Final, NamedTuple
from urllib.parse import urlsplit

from pioneer3.errors import ConfigError, LinkError
from pioneer3.names import printable

MULTIPART: Final = "multipart/x-mixed-replace"
BOUNDARY: Final = "pioneer3picture"
"""Boundary of the streams that we send."""
MOST_PICTURE: Final = 8 << 20
"""A picture of more bytes is refused."""
MOST_HEAD: Final = 16 << 10
"""So are more bytes of headers in one place."""
START = b"\xff\xd8"
"""First bytes of every JPEG (ITU T.81, table B.1)."""
END = b"\xff\xd9"
"""Last bytes of every JPEG."""
SCHEME: Final = re.compile(r"([^\s=]+)(?:\s+([^\s=].*))?", re.DOTALL)
"""Begins a question for a user: its scheme, and the first parameter."""
HASHES: Final = {"MD5": md5, "SHA-256": sha256}
MOST_PARTS: Final = 200
"""In one read, and in a second: a stream of more is refused."""
NOT_LINE_END: Final = re.compile(rb"[^\r\n]")
EMPTY_LINE: Final = re.compile(rb"\r?\n\r?\n")
"""With the end of the line before."""
TRAILING: Final = 64
"""Some cameras fill up a picture after its end, by fewer bytes than this."""
CHALLENGE: Final = "www-authenticate"
VIEW: Final = "X-Field-Of-View-Rad"
"""Header of a part: the angle from the left edge of the picture to the right one [rad], which
changes with the zoom. Ours; other cameras do not tell it."""
PORTS: Final = {"http": 80, "https": 443}
WRITE_LOGIN: Final = (
    "write `machine HOST login USER password PASSWORD` into ~/.netrc, and chmod 600 ~/.netrc"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraUrl:
    """Where a stream is; `path` is from the slash on, with the query, `secure` means https."""

    host: str
    port: int
    path: str = "/"
    secure: bool = False

    def __str__(self) -> str:
        """The URL."""
        scheme = "https" if self.secure else "http"
        host = f"[{self.host}]" if ":" in self.host else self.host
        usual = self.port == PORTS[scheme]
        return f"{scheme}://{host}{'' if usual else f':{self.port}'}{self.path}"


def parse_url(text: str) -> CameraUrl:
    """Read `http://HOST[:PORT][/PATH]`, or the same with https.

    Raises:
        ConfigError: It is no such URL.
    """
    try:
        parts = urlsplit(text)
        port = parts.port
        (parts.hostname or "").encode("idna")  # as the resolver does
    except ValueError:  # its words may show a part of a login
        raise _wrong(text, "no URL of a camera") from None
    if parts.scheme not in PORTS or not parts.hostname or not text.isascii():
        raise _wrong(text, "no URL of a camera")
    if any(character <= " " or character == "\x7f" for character in text):
        raise _wrong(text, "a space or a control character in it")
    path = parts.path or "/"
    if "@" in parts.netloc:
        raise _wrong(text, f"others could read the login in it; {WRITE_LOGIN}")
    return CameraUrl(
        host=parts.hostname,
        port=PORTS[parts.scheme] if port is None else port,
        path=f"{path}?{parts.query}" if parts.query else path,
        secure=parts.scheme == "https",
    )


def _wrong(text: str, problem: str) -> ConfigError:
    bare = text.rpartition("@")[2]  # never shows a password
    return ConfigError(
        f"--camera {bare}: {problem}; expected the URL of an MJPEG stream, such as "
        "http://127.0.0.1:8181/ or http://192.168.0.90/axis-cgi/mjpg/video.cgi"
    )


def request(url: CameraUrl, authorization: str = "") -> bytes:
    """Return the question for a stream; HTTP/1.0, so that it comes in one piece."""
    host = str(replace(url, path="")).partition("//")[2]
    login = f"Authorization: {authorization}\r\n" if authorization else ""
    return (
        f"GET {url.path} HTTP/1.0\r\nHost: {host}\r\nUser-Agent: pioneer3\r\n"
        f"Accept: {MULTIPART}\r\n{login}\r\n"
    ).encode()


class Credentials(NamedTuple):
    """Name and password of a user; printable, and the name has neither colon nor quote."""

    user: str
    password: str


def authorization(url: CameraUrl, login: Credentials, challenge: str, nonce: str) -> str:
    """Return the answer to the question for a user (RFC 7617, RFC 7616); empty if none is known.

    Digest is preferred, as it does not tell the password. `challenge` has all headers
    WWW-Authenticate, with commas between them; `nonce` are random hexadecimal digits of ours.
    """
    asked = _challenges(challenge)
    for scheme, parameters in asked:
        if scheme == "digest" and parameters.get("algorithm", "MD5").upper() in HASHES:
            return _digest(url, login, parameters, nonce)
    if any(scheme == "basic" for scheme, _ in asked):
        return f"Basic {b64encode(f'{login.user}:{login.password}'.encode()).decode()}"
    return ""


def _digest(url: CameraUrl, login: Credentials, given: Mapping[str, str], nonce: str) -> str:
    """Return the answer to a question by Digest with the parameters `given`."""
    realm, theirs = given.get("realm", ""), given.get("nonce", "")
    algorithm = given.get("algorithm", "MD5")

    def hashed(text: str) -> str:
        return HASHES[algorithm.upper()](text.encode(), usedforsecurity=False).hexdigest()

    secret, asked = hashed(f"{login.user}:{realm}:{login.password}"), hashed(f"GET:{url.path}")
    fields = {"username": login.user, "realm": realm, "nonce": theirs, "uri": url.path}
    plain = f"algorithm={algorithm}"
    if "auth" in given.get("qop", "").replace(" ", "").split(","):
        count = "00000001"
        answer = hashed(f"{secret}:{theirs}:{count}:{nonce}:auth:{asked}")
        fields["cnonce"] = nonce
        plain += f", qop=auth, nc={count}"
    else:
        answer = hashed(f"{secret}:{theirs}:{asked}")
    fields["response"] = answer
    if "opaque" in given:
        fields["opaque"] = given["opaque"]
    quoted = ", ".join(f'{name}="{value}"' for name, value in fields.items())
    return f"Digest {quoted}, {plain}"


def _challenges(text: str) -> list[tuple[str, dict[str, str]]]:
    """Return the schemes, in lower case, that a server knows, each with its parameters."""
    found: list[tuple[str, dict[str, str]]] = []
    for word in re.findall(r'(?:[^,"]|"[^"]*")+', text):
        begun = SCHEME.fullmatch(word.strip())
        if begun:
            found.append((begun[1].lower(), {}))
        name, _, value = ((begun[2] or "") if begun else word).partition("=")
        if found and name.strip():
            found[-1][1][name.strip().lower()] = value.strip().strip('"')
    return found


def stream_head() -> bytes:
    """Return the head of the answer that a stream follows, with its headers."""
    return answer("200 OK", f"{MULTIPART}; boundary={BOUNDARY}")


def answer(status: str, kind: str, body: bytes | None = None, extra: str = "") -> bytes:
    """Return an answer of HTTP/1.0; without `body` the connection's end ends what follows."""
    length = "" if body is None else f"Content-Length: {len(body)}\r\n"
    head = (
        f"HTTP/1.0 {status}\r\nContent-Type: {kind}\r\n{length}{extra}"
        "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n"
    )
    return head.encode() + (body or b"")


def part(jpeg: bytes, view: float | None = None) -> bytes:
    """Return a picture as a part of our stream, with its field of `view` [rad] if that is known."""
    known = "" if view is None else f"{VIEW}: {view:.6f}\r\n"
    head = f"--{BOUNDARY}\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n{known}\r\n"
    return head.encode() + jpeg + b"\r\n"


@dataclass(frozen=True, slots=True)
class AnswerHead:
    """The head of an answer: status of HTTP, the words after it, headers by lower-case names.

    Of several headers with one name the first; of WWW-Authenticate all, with commas between them.
    """

    status: int
    reason: str
    headers: dict[str, str]


TOO_FAST: Final = f"it sends more than {MOST_PARTS} pictures a second: this is no camera"


class Frame(NamedTuple):
    """A picture of a stream, and its angle of view as :class:`~pioneer3.state.Picture` has it."""

    jpeg: bytes
    view: float | None


def is_picture(data: bytes) -> bool:
    """Whether it begins as a JPEG does and ends as one does."""
    return data.startswith(START) and END in data[-TRAILING:]


class Parser:
    """Takes the bytes of an answer, and gives its pictures.

    Its buffer never holds more than one picture of :data:`MOST_PICTURE`, and a read.

    Attributes:
        broken: Number of parts that are no pictures; `parts` has them all, also empty ones.
    """

    def __init__(self) -> None:
        self.head: AnswerHead | None = None
        self.pictures = self.broken = self.parts = 0
        self._view: float | None = None
        self._buffer = bytearray()
        self._searched = 0
        self._ending = b""
        self._length: int | None = None
        self._in_part = False

    @property
    def challenge(self) -> str:
        """The question for a user and a password; empty without one."""
        if self.head is None or not self.wants_login:
            return ""
        return self.head.headers.get(CHALLENGE, "")

    @property
    def wants_login(self) -> bool:
        """Whether the answer is that a login is missing, or wrong."""
        return self.head is not None and self.head.status == 401

    def receive(self, data: bytes) -> list[Frame]:
        """Return the pictures that `data` completes.

        Raises:
            LinkError: This is no stream of pictures; the message says what it is.
        """
        self._buffer += data
        if self.head is None:
            lines = self._headers()
            if lines is None:
                return []
            self.head = _head(lines)
            self._ending = b"--" + _boundary(self.head).encode("latin-1")
        found = []
        most = self.parts + MOST_PARTS
        while (body := self._body()) is not None:
            self.parts += 1
            if self.parts > most:
                raise LinkError(TOO_FAST)
            if is_picture(body):
                self.pictures += 1
                found.append(Frame(body, self._view))
            elif body.strip():
                self.broken += 1
        return found

    def _body(self) -> bytes | None:
        """Return the body of the next part if it is complete."""
        if not self._in_part:
            lines = self._headers()
            if lines is None:
                return None
            fields = _fields(lines)
            self._length, self._view = _length(fields), _view(fields)
            self._in_part = True
        body = self._counted() if self._length is not None else self._delimited()
        if body is not None:
            self._in_part = False
        return body

    def _headers(self) -> list[str] | None:
        """Take lines up to an empty one, without those before the first; `None` if incomplete.

        Raises:
            LinkError: They are longer than any camera's.
        """
        first = NOT_LINE_END.search(self._buffer)
        del self._buffer[: first.start() if first else len(self._buffer)]
        most = MOST_HEAD + len(b"\r\n\r\n")
        found = EMPTY_LINE.search(self._buffer, 0, most)
        if found is None and len(self._buffer) >= most:
            raise LinkError(f"headers of more than {MOST_HEAD >> 10} kB: this is no camera")
        if found is None:
            return None
        end, after = found.span()
        lines = bytes(self._buffer[:end]).decode("latin-1").splitlines()
        del self._buffer[:after]
        return lines

    def _counted(self) -> bytes | None:
        assert self._length is not None
        if len(self._buffer) < self._length:
            return None
        body = bytes(self._buffer[: self._length])
        del self._buffer[: self._length]
        return body

    def _delimited(self) -> bytes | None:
        """Take the bytes before the next boundary; `None` if it has not come.

        Raises:
            LinkError: None comes for too long.
        """
        end = self._buffer.find(self._ending, self._searched)
        if end < 0:
            self._searched = max(0, len(self._buffer) - len(self._ending))
            if len(self._buffer) > MOST_PICTURE:
                raise LinkError(_too_large("more than that"))
            return None
        body = bytes(self._buffer[:end])
        del self._buffer[:end]
        self._searched = 0
        return body


def _fields(lines: list[str]) -> dict[str, str]:
    pairs = (line.partition(":") for line in lines)
    found: dict[str, str] = {}
    for told, colon, value in pairs:
        name = told.strip().lower()
        if colon and name == CHALLENGE and name in found:
            found[name] += f", {value.strip()}"
        elif colon:
            found.setdefault(name, value.strip())
    return found


def _head(lines: list[str]) -> AnswerHead:
    lines = [printable(line) for line in lines]
    words = lines[0].split(None, 2)
    if len(words) < 2 or not words[0].startswith("HTTP/") or not words[1].isdigit():
        raise LinkError("what answers there does not speak HTTP: is this the camera's port?")
    reason = words[2] if len(words) > 2 else ""
    return AnswerHead(int(words[1][:3]), reason[:60], _fields(lines[1:]))


def _boundary(head: AnswerHead) -> str:
    """Return the boundary between the parts of an answer, without the dashes before it.

    Raises:
        LinkError: It is no stream.
    """
    if head.status != 200:
        raise LinkError(_refusal(head))
    kind, _, parameters = head.headers.get("content-type", "").partition(";")
    if not kind.strip().lower().startswith("multipart/"):
        what = "one picture" if kind.strip().lower() == "image/jpeg" else f"{kind[:40] or 'data'!r}"
        raise LinkError(f"it sends {what}, no MJPEG stream: give the URL of its stream")
    if head.headers.get("transfer-encoding", "identity").lower() != "identity":
        raise LinkError("it sends chunks, which HTTP/1.0 does not have")
    given = (word.strip().partition("=") for word in parameters.split(";"))
    found = next((value for name, _, value in given if name.lower() == "boundary"), "")
    boundary = found.strip().strip('"').removeprefix("--")
    if not boundary or len(boundary) > 200:
        raise LinkError("its stream tells no boundary between pictures")
    return boundary


def _refusal(head: AnswerHead) -> str:
    match head.status:
        case 401 | 403:
            return f"it wants a user and a password: {WRITE_LOGIN}"
        case 404:
            return "it has no such page: give the URL of its MJPEG stream"
        case 301 | 302 | 303 | 307 | 308:
            return f"it sends on to {head.headers.get('location', '?')[:200]}: give that URL"
        case 503:
            return "it has too many viewers, or is busy"
    return f"it answers {head.status} {head.reason}"


def _view(fields: Mapping[str, str]) -> float | None:
    """Return the field of view that the headers of a part tell [rad]."""
    try:
        view = float(fields[VIEW.lower()])
    except (KeyError, ValueError):
        return None
    return view if 0 < view < pi else None


def _length(fields: Mapping[str, str]) -> int | None:
    """Return the length of a part by its headers.

    Raises:
        LinkError: It is none, or too much.
    """
    text = fields.get("content-length")
    if text is None:
        return None
    if not (text.isascii() and text.isdigit()) or len(text) > 20:
        raise LinkError(f"a picture of {text[:20]!r} bytes: this is no camera")
    if int(text) > MOST_PICTURE:
        raise LinkError(_too_large(f"{int(text)} bytes"))
    return int(text)


def _too_large(size: str) -> str:
    return (
        f"a picture of {size}, the most is {MOST_PICTURE >> 20} MB: "
        "let the camera send smaller ones"
    )
