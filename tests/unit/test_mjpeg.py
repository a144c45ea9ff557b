"""Streams of pictures over HTTP: any chunks give the same pictures, and no bytes do harm."""

from contextlib import suppress
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3 import mjpeg
from pioneer3.errors import ConfigError, LinkError
from pioneer3.mjpeg import CameraUrl, Frame, Parser, parse_url
from tests.cameras import jpeg_of

HEAD = b"HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n"
JPEG = jpeg_of()
PICTURES = st.binary(max_size=300).map(lambda noise: mjpeg.START + noise + mjpeg.END)


def pieces(data: bytes, cuts: list[int]) -> list[bytes]:
    places = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [data[a:b] for a, b in pairwise(places)]


def taken(data: bytes, cuts: list[int] | None = None) -> list[bytes]:
    parser = Parser()
    return [frame.jpeg for piece in pieces(data, cuts or []) for frame in parser.receive(piece)]


VIEWS = st.none() | st.integers(1, 3_000_000).map(lambda millionths: millionths / 1e6)
FRAMES = st.builds(Frame, PICTURES, VIEWS)


@given(st.lists(FRAMES, max_size=5), st.lists(st.integers(0, 5000), max_size=20))
def test_any_chunks_give_the_pictures_that_were_sent_each_with_its_view(
    frames: list[Frame], cuts: list[int]
) -> None:
    parser = Parser()
    sent = mjpeg.stream_head() + b"".join(mjpeg.part(*frame) for frame in frames)
    found = [frame for piece in pieces(sent, cuts) for frame in parser.receive(piece)]
    assert found == frames


@given(st.lists(st.integers(0, 5000), max_size=20))
def test_parts_without_a_length_end_at_the_boundary(cuts: list[int]) -> None:
    parts = b"".join(
        b"--frame\r\nContent-Type: image/jpeg\r\n\r\n" + JPEG + b"\r\n" for _ in range(3)
    )
    found = taken(HEAD + parts + b"--frame--\r\n\r\n", cuts)
    assert [picture.rstrip(b"\r\n") for picture in found] == [JPEG] * 3


@pytest.mark.parametrize(
    "kind",
    [
        "multipart/x-mixed-replace;boundary=frame",
        'multipart/x-mixed-replace; boundary="frame"',
        "multipart/x-mixed-replace; boundary=--frame",
        "Multipart/X-Mixed-Replace; charset=x; Boundary=frame",
    ],
)
def test_boundaries_are_written_in_several_ways(kind: str) -> None:
    head = f"HTTP/1.1 200 OK\nServer: x\nContent-Type: {kind}\n\n".encode()
    assert taken(head + b"--frame\n\n" + JPEG + b"\n--frame\n") == [JPEG + b"\n"]


@pytest.mark.parametrize(
    ("headers", "scheme"),
    [
        (['Basic realm="a, Digest b"'], "Basic"),
        (["basic"], "Basic"),
        (['Basic realm="a"', 'Digest realm="b", nonce="1"'], 'Digest username="u", realm="b"'),
        (['Basic realm="a", digest realm="b", nonce="1"'], 'Digest username="u", realm="b"'),
        (["Digest realm=b, nonce=1, algorithm=SHA-512-256", "Basic realm=a"], "Basic"),
        (
            ['Digest realm="s", nonce="1", algorithm=MD5-sess', 'Digest realm = "m", nonce="1"'],
            'Digest username="u", realm="m"',
        ),
        (["Negotiate", "NTLM TlRMTQ=="], ""),
        (["Bearer realm=x"], ""),
        (["", ",=,", "="], ""),
    ],
)
def test_a_login_is_answered_by_the_best_scheme_that_is_known(
    headers: list[str], scheme: str
) -> None:
    parser = Parser()
    lines = "".join(f"WWW-Authenticate: {header}\r\n" for header in headers)
    with pytest.raises(LinkError, match="user and a password"):
        parser.receive(f"HTTP/1.1 401 Unauthorized\r\n{lines}\r\n".encode())
    answer = mjpeg.authorization(
        parse_url("http://cam/"), mjpeg.Credentials("u", "p"), parser.challenge, "0"
    )
    assert answer.startswith(scheme)
    assert bool(answer) == bool(scheme)


@given(st.text(max_size=60))
def test_any_question_for_a_login_is_answered_or_not(challenge: str) -> None:
    answer = mjpeg.authorization(
        parse_url("http://cam/"), mjpeg.Credentials("u", "p"), challenge, "0"
    )
    assert answer == "" or answer.startswith(("Basic ", "Digest "))


def test_a_part_that_is_no_picture_is_counted_and_left_out() -> None:
    parser = Parser()
    parts = [b"no picture", JPEG[:-2], JPEG]
    found = parser.receive(mjpeg.stream_head() + b"".join(map(mjpeg.part, parts)))
    assert found == [Frame(JPEG, None)]
    assert (parser.pictures, parser.broken) == (1, 2)


@given(st.binary(max_size=400), st.lists(st.integers(0, 400), max_size=5))
def test_noise_is_refused_or_waited_for(noise: bytes, cuts: list[int]) -> None:
    parser = Parser()
    with suppress(LinkError):
        for piece in pieces(HEAD + b"--frame\r\n" + noise, cuts):
            parser.receive(piece)
    assert parser.pictures == 0


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (b"SSH-2.0-OpenSSH_9.2\r\n\r\n", "does not speak HTTP"),
        (b"HTTP/1.1 401 Unauthorized\r\n\r\n", "user and a password"),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "no such page"),
        (b"HTTP/1.1 302 Found\r\nLocation: http://there/\r\n\r\n", "http://there/"),
        (b"HTTP/1.1 503 Busy\r\n\r\n", "too many viewers"),
        (b"HTTP/1.1 500 Broken\r\n\r\n", "500 Broken"),
        (b"HTTP/1.1 200 OK\r\nContent-Type: image/jpeg\r\n\r\n", "one picture"),
        (b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", "no MJPEG stream"),
        (b"HTTP/1.1 200 OK\r\nContent-Type: multipart/mixed\r\n\r\n", "no boundary"),
        (HEAD[:-2] + b"Transfer-Encoding: chunked\r\n\r\n", "chunks"),
        (HEAD + b"--frame\r\nContent-Length: 1000000000\r\n\r\n", "the most is 8 MB"),
        (HEAD + b"--frame\r\nContent-Length: -5\r\n\r\n", "no camera"),
        (b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * 4000, "headers of more than"),
        (HEAD + b"X: y\r\n" * 4000, "headers of more than"),
    ],
)
def test_what_is_no_camera_is_refused_with_the_reason(answer: bytes, said: str) -> None:
    with pytest.raises(LinkError, match=said):
        taken(answer)


def test_a_flood_of_tiny_parts_is_refused_in_its_first_read() -> None:
    parser = Parser()
    parser.receive(HEAD)
    tiny = b"--frame\nContent-Length:4\n\n" + mjpeg.START + mjpeg.END
    assert len(parser.receive(tiny * mjpeg.MOST_PARTS)) == mjpeg.MOST_PARTS
    with pytest.raises(LinkError, match="more than 200 pictures a second"):
        parser.receive(tiny * 2000)
    assert parser.parts == 2 * mjpeg.MOST_PARTS + 1


@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_headers_may_be_as_long_as_the_most_in_any_chunks(end: bytes) -> None:
    part = b"--frame" + end + b"X: " + bytes(mjpeg.MOST_HEAD - 10 - len(end)) + 2 * end
    sent = part + JPEG + end + b"--frame"
    for cuts in ([], [mjpeg.MOST_HEAD + cut for cut in range(5)]):
        parser = Parser()
        parser.receive(HEAD)
        found = [frame for piece in pieces(sent, cuts) for frame in parser.receive(piece)]
        assert found == [Frame(JPEG + end, None)]


@pytest.mark.parametrize(
    "answer",
    [
        b"HTTP/1.1 500 \x1b[2J\x9bred\r\n\r\n",
        b"HTTP/1.1 302 Found\r\nLocation: http://\x1b]0;x\x07there/\r\n\r\n",
    ],
)
def test_control_characters_of_a_camera_are_not_shown(answer: bytes) -> None:
    with pytest.raises(LinkError) as caught:
        taken(answer)
    assert str(caught.value).isprintable()


def test_a_picture_without_end_is_refused_before_it_fills_the_memory() -> None:
    parser = Parser()
    parser.receive(HEAD + b"--frame\r\n\r\n" + mjpeg.START)
    megabyte = bytes(1 << 20)

    def endless() -> None:
        for _ in range(20):
            parser.receive(megabyte)

    with pytest.raises(LinkError, match="the most is 8 MB"):
        endless()


@pytest.mark.parametrize(
    ("text", "url"),
    [
        ("http://10.0.0.9", CameraUrl(host="10.0.0.9", port=80)),
        (
            "http://cam:8080/axis-cgi/mjpg/video.cgi?fps=5",
            CameraUrl(host="cam", port=8080, path="/axis-cgi/mjpg/video.cgi?fps=5"),
        ),
        ("https://[::1]/x", CameraUrl(host="::1", port=443, path="/x", secure=True)),
    ],
)
def test_urls_are_read(text: str, url: CameraUrl) -> None:
    assert parse_url(text) == url


@pytest.mark.parametrize(
    "text",
    [
        "",
        "cam",
        "ftp://cam/",
        "http://",
        "http://cam:99999/",
        "http://a..b/",
        f"http://{64 * 'a'}/",
        "http://cam/a b",
        "http://é/",
    ],
)
def test_wrong_urls_are_refused_with_an_example(text: str) -> None:
    with pytest.raises(ConfigError, match="axis-cgi"):
        parse_url(text)


@pytest.mark.parametrize("scheme", ["http", "ftp"])
def test_a_login_in_a_url_is_refused_and_not_shown(scheme: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_url(f"{scheme}://root:secret@cam/")
    assert "secret" not in str(caught.value)
    assert scheme != "http" or ".netrc" in str(caught.value)


@pytest.mark.parametrize(
    ("told", "view"),
    [("0.8", 0.8), ("nan", None), ("-1", None), ("9", None), ("wide", None), (None, None)],
)
def test_a_camera_may_tell_its_field_of_view(told: str | None, view: float | None) -> None:
    parser = Parser()
    line = "" if told is None else f"{mjpeg.VIEW}: {told}\r\n"
    head = f"--pioneer3picture\r\n{line}Content-Length: {len(JPEG)}\r\n\r\n"
    assert parser.receive(mjpeg.stream_head() + head.encode() + JPEG) == [Frame(JPEG, view)]
