"""`pioneer3 run` on a network: addresses, https, files, and `pioneer3 access`. Real sockets."""

import asyncio
import os
import re
import ssl
import stat
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from pioneer3 import connect_async
from pioneer3.cli.main import execute
from pioneer3.errors import ConfigError
from pioneer3.web.access.certificate import certificate_for
from pioneer3.web.access.hosts import lan_addresses, others_urls
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import Served, serve
from tests.support import SimulatedRobot

pytestmark = pytest.mark.realtime

PATIENCE = 20.0
ADDRESS = next(iter(lan_addresses("0.0.0.0")), "")
needs_network = pytest.mark.skipif(not ADDRESS, reason="this machine has no network")


@asynccontextmanager
async def shared() -> AsyncIterator[tuple[Page, Served]]:
    """Serve a robot on every address of this machine."""
    certificate = certificate_for("0.0.0.0", None, None)
    async with (
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
        (page := Page()).hosting(robot, RobotScene()),
        serve(page, host="0.0.0.0", port=0, certificate=certificate) as all_,
    ):
        yield page, all_


def port(url: str | None) -> int:
    assert url is not None
    return int(url.rpartition(":")[2])


async def status(
    host: str, tcp_port: int, path: str, tls: ssl.SSLContext | None = None, **headers: str
) -> int:
    """Return the status that a GET is answered with."""
    reader, writer = await asyncio.open_connection(host, tcp_port, ssl=tls)
    named = {"Host": f"{host}:{tcp_port}", "Connection": "close", **headers}
    lines = "".join(f"{name}: {value}\r\n" for name, value in named.items())
    writer.write(f"GET {path} HTTP/1.1\r\n{lines}\r\n".encode())
    async with asyncio.timeout(PATIENCE):
        answer = await reader.read()
    writer.close()
    await writer.wait_closed()
    return int(answer.split()[1])


@needs_network
async def test_from_the_network_only_who_is_paired_gets_in() -> None:
    async with shared() as (page, served):
        _, secret = page.access.sessions.open("Ann", Role.DRIVER, SessionKind.BROWSER)
        http = port(served.http)
        assert await status("127.0.0.1", http, "/api/me") == 200
        assert await status(ADDRESS, http, "/") == 200
        assert await status(ADDRESS, http, "/api/me") == 401
        assert await status(ADDRESS, http, "/api/me", Host="localhost") == 401
        forged = {"X-Forwarded-For": "127.0.0.1"}
        assert await status(ADDRESS, http, "/api/me", None, **forged) == 401
        assert await status("127.0.0.1", http, "/api/me", None, **forged) == 401
        cookie = f"pioneer3-{http}={secret}"
        assert await status(ADDRESS, http, "/api/me", Cookie=cookie) == 200
        with pytest.raises(InvalidStatus) as refused:
            await connect(f"ws://{ADDRESS}:{http}/ws")
        assert refused.value.response.status_code == 403
        async with connect(
            f"ws://{ADDRESS}:{http}/ws", additional_headers={"Cookie": cookie}
        ) as ann:
            assert '"hello"' in str(await ann.recv())


@needs_network
async def test_https_is_trusted_by_who_trusts_the_authority() -> None:
    async with shared() as (page, served):
        https = port(served.https)
        trusting = ssl.create_default_context(cafile=str(page.access.authority))
        assert await status(ADDRESS, https, "/", trusting) == 200
        assert await status(ADDRESS, https, "/api/me", trusting) == 401
        assert await status("127.0.0.1", https, "/api/me", trusting) == 200
        with pytest.raises(ssl.SSLCertVerificationError):
            await status(ADDRESS, https, "/", ssl.create_default_context())
        _, secret = page.access.sessions.open("Ann", Role.DRIVER, SessionKind.BROWSER)
        for name, code in ((f"__Host-pioneer3-{https}", 200), (f"pioneer3-{https}", 401)):
            cookie = f"{name}={secret}"
            assert await status(ADDRESS, https, "/api/me", trusting, Cookie=cookie) == code
        assert await status(ADDRESS, port(served.http), "/ca.crt") == 200


@needs_network
async def test_at_one_address_this_computer_comes_in_without_a_token() -> None:
    async with (
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
        (page := Page()).hosting(robot, RobotScene()),
        serve(page, host=ADDRESS, port=0) as served,
    ):
        assert await status("127.0.0.1", port(served.http), "/api/me") == 200
        assert await status(ADDRESS, port(served.http), "/api/me") == 401


def test_invitations_lead_to_http_unless_the_certificate_is_the_owners() -> None:
    own = others_urls("192.168.0.7", 8080, 8081, trusted=False)
    assert own == ("http://192.168.0.7:8080", "https://192.168.0.7:8081")
    assert others_urls("192.168.0.7", 8080, 8081, trusted=True) == own[::-1]
    assert others_urls("127.0.0.1", 8080, None, trusted=False) == ()
    assert others_urls("fd00::7", 80, None, trusted=False) == ("http://[fd00::7]:80",)


@needs_network
async def test_access_lists_invites_and_revokes(capsys: pytest.CaptureFixture[str]) -> None:
    async def p3(*arguments: str) -> str:
        at = ("--web-port", str(port(served.http)))
        assert await asyncio.to_thread(execute, ["access", *arguments, *at]) == 0
        return capsys.readouterr().out

    async with shared() as (page, served):
        assert await p3("list") == "Nobody but this computer.\n"
        printed = await p3("invite", "--role", "viewer")
        assert "█" in printed
        token = re.findall(r"/pair#([\w-]+)", printed)[0]
        paired = page.access.pair(token, "Vera", None)
        assert paired is not None
        assert paired[0].role is Role.VIEWER
        assert "Vera" in await p3("list")
        await p3("revoke", paired[0].id)
        assert page.access.sessions.listed() == []


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["list", "--web-port", "1"], 3, "is pioneer3 run running"),
        (["revoke", "../me"], 2, "sessions have numbers"),
    ],
)
def test_access_says_what_is_wrong(
    arguments: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["access", *arguments]) == code
    assert says in capsys.readouterr().err


async def test_nothing_that_is_kept_can_be_read_by_others() -> None:
    async with shared() as (page, _):
        assert page.access.authority is not None
        folder = page.access.authority.parent
        assert Path(os.environ["XDG_STATE_HOME"]) in folder.parents
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        kept = {path.name: path.read_bytes() for path in folder.iterdir()}
        secret = page.access.invitations.invite(Role.DRIVER).encode()
    assert sorted(kept) == ["ca.key", "ca.pem", "server.key", "server.pem"]
    assert all(secret not in data for data in kept.values())


def test_a_certificate_without_its_key_is_refused() -> None:
    with pytest.raises(ConfigError, match="--key"):
        certificate_for("0.0.0.0", Path("chain.pem"), None)
