"""Who may load the page, and from where."""

import asyncio

import pytest

from pioneer3.web.access.hosts import LOCAL_NAMES, is_ours, own_names
from tests.support import STAYED
from tests.unit.web.browser import Browser, product

POLICY_VIOLATION = 1008
OURS = [
    "localhost",
    "localhost:8080",
    "LOCALHOST:8080",
    "127.0.0.1:8080",
    "[::1]:8080",
    "192.168.0.7:8080",
]
FOREIGN = [
    "evil.example",
    "evil.example:8080",
    "localhost.evil.example",
    "127.0.0.1.evil.example",
    "",
    "[",
    "[::1",
    ":8080",
    "@",
    "local host",
]


@pytest.mark.parametrize("host", OURS)
def test_local_names_and_numbers_are_ours(host: str) -> None:
    assert is_ours(host, LOCAL_NAMES)


@pytest.mark.parametrize("host", FOREIGN)
def test_other_names_are_not(host: str) -> None:
    assert not is_ours(host, LOCAL_NAMES)


def test_a_request_without_a_host_is_not_ours() -> None:
    assert not is_ours(None, LOCAL_NAMES)


def test_beyond_loopback_the_machine_goes_by_its_own_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("socket.gethostname", lambda: "Lab-PC")
    assert own_names("0.0.0.0") == LOCAL_NAMES | {"0.0.0.0", "lab-pc", "lab-pc.local"}
    assert own_names("127.0.0.1") == LOCAL_NAMES


@pytest.mark.parametrize("origin", [None, "http://localhost:8080", "https://localhost:8080"])
async def test_the_page_itself_and_programs_may_connect(origin: str | None) -> None:
    async with product() as the, Browser(the.app, origin=origin) as ann:
        assert ann.closed is None
        assert ann.latest("hello")["robots"][0]["shape"]["model"] == "p3at-sh"


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "http://localhost:9999",
        "http://localhost",
        "http://localhost:8080.evil.example",
        "http://evil@localhost:8080",
        "ftp://localhost:8080",
        "null",
        "",
        "http://[",
    ],
)
async def test_a_page_from_elsewhere_may_not_drive(origin: str) -> None:
    async with product() as the, Browser(the.app, origin=origin) as mallory:
        mallory.drive(0.3)
        await asyncio.sleep(1.0)
        assert mallory.closed == POLICY_VIOLATION
        assert mallory.heard == []
        assert the.travelled < STAYED


@pytest.mark.parametrize("host", ["evil.example:8080", "["])
async def test_a_rebound_name_may_not_drive(host: str) -> None:
    async with product() as the, Browser(the.app, host=host, origin=f"http://{host}") as mallory:
        mallory.drive(0.3)
        await asyncio.sleep(1.0)
        assert mallory.closed == POLICY_VIOLATION
        assert the.travelled < STAYED
