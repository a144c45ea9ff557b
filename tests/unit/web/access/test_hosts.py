"""Which requests are from this machine, and from our own page."""

import pytest

from pioneer3.links.hosts import is_loopback
from pioneer3.web.access import hosts
from pioneer3.web.access.hosts import is_from_here, is_own_origin

HERE = {"host": "localhost:8080"}


@pytest.mark.parametrize("peer", ["127.0.0.1", "127.3.2.1", "::1", "::ffff:127.0.0.1"])
@pytest.mark.parametrize("host", ["localhost:8080", "127.0.0.1", "[::1]:8080"])
def test_this_machine_is_known_by_its_address_and_the_name_it_used(peer: str, host: str) -> None:
    assert is_from_here(peer, {"host": host})


@pytest.mark.parametrize("peer", ["", "192.168.0.9", "::ffff:10.0.0.1", "fe80::1", "localhost.x"])
def test_others_are_not(peer: str) -> None:
    assert not is_from_here(peer, HERE)


@pytest.mark.parametrize("host", ["192.168.0.7:8080", "lab-pc", "evil.example", ""])
def test_nor_is_who_uses_another_name(host: str) -> None:
    assert not is_from_here("127.0.0.1", {"host": host})


@pytest.mark.parametrize(
    "name", ["forwarded", "x-forwarded-for", "x-forwarded-host", "x-real-ip", "via"]
)
def test_nor_is_who_comes_through_a_proxy(name: str) -> None:
    assert not is_from_here("127.0.0.1", {**HERE, name: "x"})


def test_loopback_is_known() -> None:
    assert all(map(is_loopback, ("localhost", "LOCALHOST", "127.0.0.1", "::1")))
    assert not any(map(is_loopback, ("0.0.0.0", "::", "192.168.0.7", "lab-pc", "")))


@pytest.mark.parametrize(
    ("headers", "own"),
    [
        ({}, True),
        ({"origin": "http://localhost:8080"}, True),
        ({"origin": "https://localhost:8080"}, True),
        ({"origin": "http://localhost:3000"}, False),
        ({"origin": "http://evil.example"}, False),
        ({"origin": "null"}, False),
        ({"origin": ""}, False),
        ({"sec-fetch-site": "same-origin"}, True),
        ({"sec-fetch-site": "none", "sec-fetch-mode": "navigate"}, True),
        ({"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}, True),
        ({"sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"}, False),
        ({"sec-fetch-site": "same-site", "sec-fetch-mode": "cors"}, False),
    ],
)
def test_only_our_own_page_and_programs_ask(headers: dict[str, str], own: bool) -> None:
    assert is_own_origin({**HERE, **headers}) is own


LISTED = ["127.0.0.1", "::1", "169.254.7.7", "192.168.7.2", "10.0.0.3", "fd00::2", "fe80::1"]


@pytest.mark.parametrize(
    ("host", "towards", "found"),
    [
        ("0.0.0.0", [], ["192.168.7.2", "10.0.0.3", "169.254.7.7"]),
        ("0.0.0.0", ["10.0.0.3"], ["10.0.0.3", "192.168.7.2", "169.254.7.7"]),
        ("::", ["10.0.0.3"], ["10.0.0.3", "192.168.7.2", "fd00::2", "169.254.7.7"]),
        ("192.168.7.2", ["10.0.0.3"], ["192.168.7.2"]),
    ],
)
def test_others_find_this_machine_on_all_interfaces_with_or_without_a_default_route(
    monkeypatch: pytest.MonkeyPatch, host: str, towards: list[str], found: list[str]
) -> None:
    monkeypatch.setattr(hosts, "_routes", lambda: towards)
    monkeypatch.setattr(hosts, "_of_interfaces", lambda: LISTED)
    assert hosts.lan_addresses(host) == found


def test_the_interfaces_of_this_machine_are_listed() -> None:
    assert "127.0.0.1" in hosts._of_interfaces()
