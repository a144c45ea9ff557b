"""The page over real sockets."""

import asyncio
import gzip
import json
import re
import socket
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from email.message import Message
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus

from pioneer3 import LinkError, PortBusyError, Robot, connect_async
from pioneer3.web import app
from pioneer3.web.access import certificate
from pioneer3.web.app import STATIC, index, modules, version
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import FRAME_LIMIT, _bind, serve
from tests.support import SimulatedRobot

pytestmark = pytest.mark.realtime

PATIENCE = 20.0


@asynccontextmanager
async def serve_page(
    robot: Robot, scene: RobotScene, *, host: str = "127.0.0.1", port: int = 8080
) -> AsyncIterator[str]:
    """Serve a page of one robot; yield its address."""
    page = Page()
    async with page.hosting(robot, scene), serve(page, host=host, port=port) as served:
        yield served.http


@asynccontextmanager
async def served() -> AsyncIterator[tuple[SimulatedRobot, str]]:
    """Serve the page of a simulated robot; yield the robot, and `host:port` of the page."""
    async with (
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
        serve_page(robot, RobotScene(), port=0) as address,
    ):
        yield sim, urlsplit(address).netloc


async def get(where: str, path: str, host: str | None = None) -> tuple[int, dict[str, str], str]:
    """Return status, headers and body."""
    reader, writer = await asyncio.open_connection(*where.split(":"))
    named = "" if host == "" else f"Host: {host or where}\r\n"
    writer.write(f"GET {path} HTTP/1.1\r\n{named}Connection: close\r\n\r\n".encode())
    async with asyncio.timeout(PATIENCE):
        head, _, body = (await reader.read()).decode().partition("\r\n\r\n")
    writer.close()
    await writer.wait_closed()
    first, *rest = head.split("\r\n")
    headers = dict(line.lower().split(": ", 1) for line in rest)
    return int(first.split()[1]), headers, body


async def until_standing(sim: SimulatedRobot) -> None:
    async with asyncio.timeout(PATIENCE):
        while sim.speed:  # noqa: ASYNC110  the world tells nobody
            await asyncio.sleep(0.02)


async def until_driving(sim: SimulatedRobot, page: ClientConnection) -> None:
    async with asyncio.timeout(PATIENCE):
        while sim.speed < 0.2:
            await page.send('{"type":"drive","v":0.3,"w":0}')
            await asyncio.sleep(0.05)


async def closing_code(page: ClientConnection) -> int | None:
    """Wait until the server closes; return the code it closes with."""
    async with asyncio.timeout(PATIENCE):
        await page.wait_closed()
    return page.close_code


async def test_every_answer_carries_the_security_headers() -> None:
    async with served() as (_, where):
        for path, status in (("/", 200), ("/static/main.js", 200), ("/static/none.js", 404)):
            answered, headers, _ = await get(where, path)
            assert answered == status
            assert "default-src 'self'" in headers["content-security-policy"]
            assert "frame-ancestors 'none'" in headers["content-security-policy"]
            assert headers["x-content-type-options"] == "nosniff"
            assert headers["referrer-policy"] == "no-referrer"
            assert headers["cache-control"] == "no-cache"


async def test_the_page_loads_nothing_from_elsewhere() -> None:
    async with served() as (_, where):
        _, _, page = await get(where, "/")
        assert "<title>" in page
        assert "http://" not in page.replace("http://www.w3.org", "")
        assert "https://" not in page


@pytest.mark.parametrize("host", ["evil.example", "[", "", "localhost.evil.example:80"])
async def test_a_name_that_is_not_ours_is_answered_with_421_or_400(host: str) -> None:
    async with served() as (_, where):
        status, _, body = await get(where, "/", host)
        assert status == (421 if host else 400)
        assert "<title>" not in body


@pytest.mark.parametrize("host", ["localhost:1", "127.0.0.1", "[::1]:8080", "LocalHost"])
async def test_local_names_are_ours_on_any_port(host: str) -> None:
    async with served() as (_, where):
        status, _, _ = await get(where, "/", host)
        assert status == 200


@pytest.mark.parametrize("path", ["/static/../app.py", "/static/%2e%2e/app.py", "/../etc/passwd"])
async def test_nothing_beside_the_page_is_served(path: str) -> None:
    async with served() as (_, where):
        status, _, body = await get(where, path)
        assert status == 404
        assert "import" not in body


@pytest.mark.parametrize("origin", ["http://evil.example", "http://[", "null"])
async def test_a_foreign_page_gets_no_socket(origin: str) -> None:
    async with served() as (_, where):
        with pytest.raises(InvalidStatus) as refused:
            await connect(f"ws://{where}/ws", additional_headers={"Origin": origin})
        assert refused.value.response.status_code == 403


async def test_the_page_itself_gets_one() -> None:
    async with served() as (_, where):
        headers = {"Origin": f"http://{where}"}
        async with connect(f"ws://{where}/ws", additional_headers=headers) as page:
            hello = json.loads(await page.recv())
            assert hello["type"] == "hello"
            assert hello["robots"][0]["shape"]["model"] == "p3at-sh"


async def test_a_frame_that_is_too_long_ends_the_visit_and_stops_the_robot() -> None:
    async with served() as (sim, where), connect(f"ws://{where}/ws") as page:
        await until_driving(sim, page)
        await page.send("x" * (FRAME_LIMIT + 1))
        assert await closing_code(page) == 1009
        await until_standing(sim)


async def test_a_browser_that_is_killed_stops_the_robot() -> None:
    async with served() as (sim, where):
        page = await connect(f"ws://{where}/ws")
        await until_driving(sim, page)
        page.transport.abort()
        await until_standing(sim)


async def test_the_server_ends_with_pages_open_and_stops_the_robot() -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        async with serve_page(robot, RobotScene(), port=0) as address:
            page = await connect(f"ws://{urlsplit(address).netloc}/ws")
            await until_driving(sim, page)
        assert await closing_code(page) == 1012
        assert robot.arbiter.driving_action is None
        await until_standing(sim)


def test_small_messages_leave_at_once() -> None:
    with _bind("127.0.0.1", 0) as listener, socket.create_connection(listener.getsockname()):
        connection, _ = listener.accept()
        with connection:
            assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_the_page_names_all_its_modules_so_that_they_load_side_by_side() -> None:
    named = re.findall(r'(?:modulepreload" href|module" src)="/static/\w+/(.+?\.js)"', index())
    others = [f"pages/{path.name}" for path in (STATIC / "pages").glob("*.js")]
    elsewhere = {module for page in others for module in modules(page)}
    files = {path.relative_to(STATIC).as_posix() for path in STATIC.rglob("*.js")}
    files -= {f"app/{path.name}" for path in (STATIC / "app").glob("*.js")}
    opened = ("view3d/scene3d.js", "panels/camera.js")  # only once these views are
    later = {module for view in opened for module in modules(view)} - set(named)
    assert all(module.startswith(("view3d/", "vendor/three", opened[1])) for module in later)
    assert len(named) == len(set(named))
    assert not set(named) & set(others)
    assert set(named) | elsewhere | later == files


@pytest.mark.parametrize("built", [True, False])
def test_the_page_names_the_book_where_it_is_built(
    built: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pioneer3.web.app.is_built", lambda: built)
    assert ('<link rel="help" href="/book/">' in index.__wrapped__()) is built


async def test_browsers_keep_the_parts_of_the_page_under_their_version_only() -> None:
    async with served() as (_, where):
        _, headers, page = await get(where, "/")
        assert headers["cache-control"] == "no-cache"  # it names the version
        assert f'src="/static/{version()}/main.js"' in page
        assert not re.findall(rf'"/static/(?!{version()}/)', page)
        _, headers, kept = await get(where, f"/static/{version()}/main.js")
        assert headers["cache-control"] == "max-age=31536000, immutable"
        assert "content-security-policy" in headers
        _, headers, asked = await get(where, "/static/main.js")
        assert headers["cache-control"] == "no-cache"
        assert kept == asked
        for path in (f"/static/{'0' * 16}/main.js", f"/static/{version()}/none.js"):
            status, headers, _ = await get(where, path)
            assert status == 404  # a page of before an upgrade gets no module of after it
            assert headers["cache-control"] == "no-cache"


async def test_parts_of_the_page_travel_compressed_to_browsers_that_take_that() -> None:
    def ask(url: str) -> tuple[Message, bytes]:
        asked = Request(url, headers={"Accept-Encoding": "gzip, deflate, br"})
        with urlopen(asked, timeout=PATIENCE) as answer:
            return answer.headers, answer.read()

    async with served() as (_, where):
        url = f"http://{where}/static/{version()}/main.js"
        headers, body = await asyncio.to_thread(ask, url)
        assert headers["content-encoding"] == "gzip"
        assert headers["vary"] == "Accept-Encoding"
        assert headers["cache-control"] == "max-age=31536000, immutable"
        assert gzip.decompress(body) == (STATIC / "main.js").read_bytes()
        headers, _ = await asyncio.to_thread(ask, f"http://{where}/static/{version()}/favicon.svg")
        assert headers["content-encoding"] is None


def test_any_change_of_a_file_makes_another_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(app, "STATIC", tmp_path)
    seen = {version.__wrapped__()}
    for name, text in (("a.js", "1"), ("a.js", "2"), ("b.js", ""), ("b.js", "2")):
        (tmp_path / name).write_text(text)
        seen.add(version.__wrapped__())
    assert len(seen) == 5
    (tmp_path / "a.js").rename(tmp_path / "c.js")
    assert version.__wrapped__() not in seen


async def test_a_port_in_use_is_refused_with_a_way_out() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
            with pytest.raises(PortBusyError, match=rf"127\.0\.0\.1:{port}.*--web-port"):
                async with serve_page(robot, RobotScene(), port=port):
                    pass


async def test_https_takes_the_next_port_that_is_nobodys(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    ours = certificate.own(tmp_path, ["localhost"])
    async with AsyncExitStack() as stack:
        stack.enter_context(socket.create_server(("127.0.0.1", port + 2)))
        page = Page()
        taken = {port + 1}
        at = await stack.enter_async_context(serve(page, port=port, certificate=ours, taken=taken))
        assert at.https is not None
        assert urlsplit(at.https).port == port + 3


@pytest.mark.parametrize(
    ("host", "port"), [("127.0.0.1", 70000), ("127.0.0.1", -1), ("192.0.2.1", 0), ("x.invalid", 0)]
)
async def test_an_address_that_is_none_of_ours_is_refused(host: str, port: int) -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        with pytest.raises(LinkError, match=f"{host}:{port}"):
            async with serve_page(robot, RobotScene(), host=host, port=port):
                pass


async def test_the_port_is_free_again_at_once() -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        port = 0
        for _ in range(3):
            async with serve_page(robot, RobotScene(), port=port) as address:
                status, _, _ = await get(urlsplit(address).netloc, "/")
                assert status == 200
                port = int(address.rsplit(":", 1)[1])
