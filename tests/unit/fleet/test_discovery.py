"""Discovery: what bytes of a bridge mean, what is offered, and two hosts that find each other."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.fleet.discovery import (
    BRIDGE_QUERY,
    Found,
    Kind,
    addresses_in,
    bridge_answer,
    discover,
)
from pioneer3.fleet.inventory import parse_fleet
from pioneer3.fleet.offers import offers
from pioneer3.sim.server.start import simulator

LAB = parse_fleet(Path("f.toml"), '[[robot]]\nname = "p3at-1"\naddress = "10.0.0.1"\n')


def test_addresses_are_single_ones_and_networks() -> None:
    assert addresses_in(["10.0.0.9", "10.0.0.1/30", "10.0.0.9"]) == (
        "10.0.0.9",
        "10.0.0.1",
        "10.0.0.2",
    )
    assert len(addresses_in(["10.0.0.0/24"])) == 254


@pytest.mark.parametrize(
    ("word", "words"), [("lab", "expected an address or a network"), ("10.0.0.0/8", "16777216")]
)
def test_what_is_no_address_or_too_many_is_refused(word: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        addresses_in([word])


def test_a_bridge_is_known_by_its_answer() -> None:
    answer = b"\0\0\0\xf7" + bytes(26)
    robot = b"\0\0\0\xf7" + bytes(4) + b"\xfa\xfb" + bytes(20)
    assert bridge_answer(answer, "10.0.0.7") == Found(
        kind=Kind.BRIDGE, address="10.0.0.7", detail="its device is not told"
    )
    assert "a robot is behind it" in getattr(bridge_answer(robot, "10.0.0.7"), "detail", "")
    assert bridge_answer(BRIDGE_QUERY, "10.0.0.7") is None


@given(st.binary(max_size=40))
def test_other_bytes_are_no_bridge(data: bytes) -> None:
    found = bridge_answer(data, "10.0.0.7")
    assert (found is not None) == (data[:4] == b"\0\0\0\xf7")


def test_what_is_offered_is_a_fleet_file_with_new_robots_alone() -> None:
    found = [
        Found(kind=Kind.COMPUTER, address="10.0.0.1", name="p3at-1", detail="OpenSSH_9.2"),
        Found(kind=Kind.COMPUTER, address="10.0.0.2", name="P3AT_1", detail="OpenSSH_9.2"),
        Found(kind=Kind.SIMULATOR, address="10.0.0.2", port=8101, detail="P3-DX", model="p3dx"),
        Found(kind=Kind.SIMULATOR, address="10.0.0.2", port=8102, detail="P3-AT", model="p3at"),
        Found(kind=Kind.BRIDGE, address="10.0.0.3", detail="a robot\nname = 1"),
        Found(kind=Kind.COMPUTER, address="fd00::9", detail="OpenSSH"),
    ]
    text = "\n".join(offers(found, LAB)) + "\n"
    robots = parse_fleet(Path("new.toml"), text).robots
    assert [(robot.name, robot.address, robot.port, robot.model) for robot in robots] == [
        ("P3AT-1-2", "10.0.0.2", "tcp://10.0.0.2:8101", "p3dx"),
        ("robot-3", "10.0.0.3", "/dev/ttyUSB0", "p3at"),
        ("robot-9", "fd00::9", "/dev/ttyUSB0", "p3at"),
    ]
    assert "# simulator at port 8102: P3-AT" in text


TEXTS = st.text(max_size=30)


@given(
    st.lists(
        st.builds(
            Found,
            kind=st.sampled_from(Kind),
            address=st.ip_addresses()
            .filter(lambda ip: not (ip.is_unspecified or ip.is_multicast))
            .map(str),
            port=st.none() | st.integers(1, 65535),
            name=TEXTS,
            detail=TEXTS,
            model=TEXTS | st.just("p3dx"),
        ),
        max_size=5,
    )
)
def test_whatever_the_network_says_the_offer_is_a_fleet_file(found: list[Found]) -> None:
    found = [one for one in found if one.address not in {"255.255.255.255", "10.0.0.1"}]
    robots = parse_fleet(Path("new.toml"), "\n".join(offers(found, LAB))).robots
    assert {robot.address for robot in robots} == {one.address for one in found}


@pytest.mark.realtime
async def test_a_simulator_at_an_address_is_found_and_named() -> None:
    async with simulator(map_name="empty", port=8101, host="127.0.0.77") as here:
        found = await discover(["127.0.0.77"], seconds=0.5, broadcast=False)
        model = here.robots[0].model.name
    assert [(one.kind, one.address, one.port, one.model) for one in found] == [
        (Kind.SIMULATOR, "127.0.0.77", 8101, model)
    ]


HERE = f"p3d{os.getpid() % 10_000}"
BRIDGE = """
import socket
listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
listener.bind(("", 30718))
print("listens", flush=True)
while True:
    data, sender = listener.recvfrom(99)
    if data == bytes.fromhex("000000f6"):
        listener.sendto(bytes.fromhex("000000f7") + bytes(26), sender)
"""
SSH = """
import socket
listener = socket.create_server(("", 22))
print("listens", flush=True)
while True:
    connection, _ = listener.accept()
    connection.sendall(b"SSH-2.0-OpenSSH_9.2p1 Debian\\r\\n")
    connection.close()
"""


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)


@pytest.fixture
def two_hosts() -> Iterator[tuple[list[str], list[str]]]:
    """Return what runs a command on each of two hosts with a cable between them, and no other."""
    hosts = [f"{HERE}a", f"{HERE}b"]
    with ExitStack() as stack:
        try:
            for host in hosts:
                ip("netns", "add", host)
                stack.callback(subprocess.run, ["ip", "netns", "del", host], check=True)
                ip("-n", host, "link", "set", "lo", "up")
            ip("-n", hosts[0], "link", "add", "v", "type", "veth", "peer", "v", "netns", hosts[1])
            for number, host in enumerate(hosts, 1):
                ip("-n", host, "address", "add", f"10.77.0.{number}/24", "brd", "+", "dev", "v")
                ip("-n", host, "link", "set", "v", "up")
                ip("-n", host, "route", "add", "default", "dev", "v")
        except (OSError, subprocess.CalledProcessError) as error:
            pytest.skip(f"network namespaces cannot be made here: {error}")
        first, second = (["ip", "netns", "exec", host] for host in hosts)
        yield first, second


@pytest.mark.realtime
@pytest.mark.skipif(not shutil.which("ip"), reason="ip is not installed")
def test_another_host_finds_simulator_bridge_and_computer(
    two_hosts: tuple[list[str], list[str]], tmp_path: Path
) -> None:
    first, second = two_hosts
    pioneer3 = [sys.executable, "-m", "pioneer3"]
    servers = [
        [*pioneer3, "sim", "--nomap", "--bind", "10.77.0.2", "-r", "p3dx:bob"],
        [sys.executable, "-c", BRIDGE],
        [sys.executable, "-c", SSH],
    ]
    with ExitStack() as stack:
        for command in servers:
            process = stack.enter_context(
                subprocess.Popen(
                    [*second, *command],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                )
            )
            stack.callback(process.kill)
            assert process.stdout is not None
            assert process.stdout.readline()

        def found(*words: str) -> list[tuple[str, str, int | None, str]]:
            done = subprocess.run(
                [*first, *pioneer3, "fleet", "discover", *words, "--json", "--seconds", "2"],
                capture_output=True,
                text=True,
                cwd=tmp_path,
                env={**os.environ, "HOME": str(tmp_path)},
                check=False,
            )
            assert done.returncode == 0, done.stderr
            rows = json.loads(done.stdout)
            return [(row["kind"], row["address"], row["port"], row["name"]) for row in rows]

        # zeroconf tells the name; the broadcast finds the bridge at the same address
        assert found() == [("simulator", "10.77.0.2", 8101, "bob")]
        scanned = found("10.77.0.2", "--no-broadcast")
        assert ("computer", "10.77.0.2", None, "") in scanned
        assert ("simulator", "10.77.0.2", 8101, "MobileSim") in scanned
