"""Announcements: nothing is sent for loopback, and a network that refuses stops nobody."""

import socket

import pytest
import zeroconf.asyncio
from zeroconf import NonUniqueNameException

from pioneer3.fleet.announce import Announcement, announced, of_page, of_simulation
from pioneer3.sim.server.start import simulator


def robot(address: str) -> Announcement:
    return Announcement(robot="bob", kind="simulator", model="p3dx", address=address, port=8101)


def forbid(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    """Let zeroconf fail when it is to be used."""

    def refuse(*arguments: object, **named: object) -> None:
        raise error

    monkeypatch.setattr(zeroconf.asyncio, "AsyncZeroconf", refuse)


@pytest.mark.realtime
async def test_robots_on_loopback_are_not_announced(monkeypatch: pytest.MonkeyPatch) -> None:
    forbid(monkeypatch, AssertionError("it was announced"))
    said: list[str] = []
    async with simulator(map_name="empty", port=0) as here:
        found = of_simulation(here)
        async with announced(found, said.append):
            pass
    assert [(one.kind, one.address) for one in found] == [("simulator", "127.0.0.1")]
    assert said == []


async def test_a_network_that_refuses_is_told_and_the_block_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    forbid(monkeypatch, OSError(101, "Network is unreachable"))
    said: list[str] = []
    went_on = False
    async with announced([robot("192.0.2.1")], said.append):
        went_on = True
    assert went_on
    assert said == ["not announced in the network: [Errno 101] Network is unreachable"]


async def test_a_name_that_others_have_is_told_too(monkeypatch: pytest.MonkeyPatch) -> None:
    class Taken:
        closed = False

        def __init__(self, interfaces: object) -> None:
            self.interfaces = interfaces

        async def async_register_service(self, info: object, *, allow_name_change: bool) -> None:
            raise NonUniqueNameException

        async def async_close(self) -> None:
            Taken.closed = True

    monkeypatch.setattr(zeroconf.asyncio, "AsyncZeroconf", Taken)
    said: list[str] = []
    async with announced([robot("192.0.2.1")], said.append):
        assert not Taken.closed
    assert Taken.closed
    assert said == ["not announced in the network: NonUniqueNameException"]


async def test_an_error_of_the_block_is_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    forbid(monkeypatch, OSError("no network"))
    with pytest.raises(OSError, match="mine"):
        async with announced([robot("192.0.2.1")], lambda text: None):
            raise OSError("mine")


def test_a_page_has_the_address_that_others_see(monkeypatch: pytest.MonkeyPatch) -> None:
    (one,) = of_page("192.0.2.7", "https://127.0.0.1:8081")
    assert (one.kind, one.address, one.port) == ("https page", "192.0.2.7", 8081)
    monkeypatch.setattr(
        "pioneer3.fleet.announce.machine_address", lambda: socket.gethostname() + ".invalid"
    )
    assert of_page("0.0.0.0", "http://127.0.0.1:8080") == ()
