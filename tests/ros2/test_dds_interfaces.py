"""What DDS listens on: loopback alone, or the interfaces that were asked for."""

import logging
import socket
import sys
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path

import pytest

from pioneer3.ros.dds.settings import SETTINGS, DdsOptions, Domains
from pioneer3.ros.dds.sockets import LOOPBACK, allow, index_of, open_to_all
from pioneer3.ros.ros2.network import BackendName
from tests.ros2.conftest import robot_on
from tests.ros2.networks import DOMAINS, network_of

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux has such filters"),
]
SO_GET_FILTER = 26
NOWHERE = 1_000_000
"""Index of an interface that no computer has."""


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Return a socket, and one that sends to it."""
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(0.3)
        sender.connect(receiver.getsockname())
        yield receiver, sender


def test_a_socket_takes_only_what_comes_by_interfaces_that_it_allows(
    pair: tuple[socket.socket, socket.socket],
) -> None:
    receiver, sender = pair
    allow(receiver, [NOWHERE])
    sender.send(b"from elsewhere")
    with pytest.raises(TimeoutError):
        receiver.recv(100)
    allow(receiver, [NOWHERE, index_of(LOOPBACK), NOWHERE + 1])
    sender.send(b"from here")
    assert receiver.recv(100) == b"from here"
    assert index_of("127.0.0.1") == index_of(LOOPBACK)


def filters(domain: int) -> list[int]:
    """Return the length of the filter of each socket that is open to all interfaces."""
    found = []
    for each in open_to_all(DdsOptions(domain=domain).ports):
        with closing(each):
            # the kernel counts instructions of 8 bytes, not bytes
            found.append(len(each.getsockopt(socket.SOL_SOCKET, SO_GET_FILTER, 512)))
    return found


@pytest.mark.parametrize(("interfaces", "length"), [((), 4), (("lo",), 4), (("127.0.0.1",), 4)])
def test_all_sockets_of_a_domain_have_filters(interfaces: tuple[str, ...], length: int) -> None:
    domains, options = Domains(), DdsOptions(domain=next(DOMAINS), interfaces=interfaces)
    domains.join(options)
    try:
        lengths = filters(options.domain)
        assert lengths
        assert set(lengths) == {length}
    finally:
        domains.leave(options)


def test_a_system_without_filters_is_warned_of(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("sys.platform", "win32")
    domains, options = Domains(), DdsOptions(domain=next(DOMAINS))
    with caplog.at_level(logging.WARNING):
        domains.join(options)
    domains.leave(options)
    assert "a firewall must close its UDP ports" in caplog.text


TRACING = (
    "<Domain><Tracing><Verbosity>severe</Verbosity><OutputFile>stderr</OutputFile></Tracing>"
    "</Domain>"
)
"""Settings of somebody that have nothing to do with interfaces."""


def test_settings_of_somebody_are_warned_of_and_nothing_is_promised(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    assert DdsOptions().reach == ", this computer only"
    assert DdsOptions(interfaces=("eth0",)).reach == ""
    monkeypatch.setenv(SETTINGS, TRACING)
    domains, options = Domains(), DdsOptions(domain=next(DOMAINS))
    assert options.reach == ", as CYCLONEDDS_URI says"
    domains.join(options)
    try:
        assert set(filters(options.domain)) == {4}
    finally:
        domains.leave(options)
    assert "CYCLONEDDS_URI is set" in caplog.text


@pytest.mark.parametrize("inline", [True, False])
def test_interfaces_of_somebody_are_not_filtered(
    *, inline: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """In a file, too."""
    file = tmp_path / "cyclonedds.xml"
    file.write_text(f"<CycloneDDS>{TRACING}</CycloneDDS>")
    own = TRACING.replace("<Tracing>", "<!-- NetworkInterface --><Tracing>")
    monkeypatch.setenv(SETTINGS, own if inline else f"file://{file}")
    domains, options = Domains(), DdsOptions(domain=next(DOMAINS))
    domains.join(options)
    try:
        assert set(filters(options.domain)) == {0}
    finally:
        domains.leave(options)


def sockets_of(process: int) -> list[tuple[str, int]]:
    """Return the local addresses of a process's UDP sockets."""
    inodes = set()
    for each in Path(f"/proc/{process}/fd").iterdir():
        with suppress(OSError):
            inodes.add(str(each.readlink()).removeprefix("socket:[").removesuffix("]"))
    rows = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    own = [row[1].split(":") for row in rows if row[9] in inodes]
    return [(socket.inet_ntoa(bytes.fromhex(host)[::-1]), int(port, 16)) for host, port in own]


def groups() -> set[str]:
    """Return the multicast groups that this computer has joined."""
    rows = Path("/proc/net/igmp").read_text().splitlines()[1:]
    return {row.split()[0] for row in rows if row.startswith("\t")}


async def test_a_node_is_on_loopback_only_unless_asked() -> None:
    """What is open to all interfaces are the sockets with the filter, and multicast is off."""
    before = groups()
    async with network_of(BackendName.DDS) as network, robot_on(network) as robot:
        domain = network.network.domain
        assert domain is not None
        ports = DdsOptions(domain=domain).ports
        addresses = sockets_of(robot.node.process.pid)
        assert addresses
        for host, port in addresses:
            assert host == "127.0.0.1" or port in ports
        assert groups() == before
