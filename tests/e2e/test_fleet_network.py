"""`pioneer3 fleet discover` between two hosts of their own."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(not shutil.which("ip"), reason="ip is not installed"),
]
PIONEER3 = [sys.executable, "-m", "pioneer3"]
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


def serve(stack: ExitStack, command: list[str]) -> None:
    """Run a command until the end of `stack`; it has said its first line."""
    process = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
    stack.callback(process.kill)
    assert process.stdout is not None
    assert process.stdout.readline()


def test_another_host_finds_simulator_bridge_and_computer(
    two_hosts: tuple[list[str], list[str]], tmp_path: Path
) -> None:
    first, second = two_hosts
    environment = {**os.environ, "HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path)}
    servers = [
        [*PIONEER3, "sim", "--nomap", "--bind", "10.77.0.2", "-r", "p3dx:bob"],
        [sys.executable, "-c", BRIDGE],
        [sys.executable, "-c", SSH],
        [*PIONEER3, "run", "--host", "10.77.0.2", "--sim-port", "0", "--web-port", "8080"],
    ]
    with ExitStack() as stack:
        for command in servers:
            process = stack.enter_context(
                subprocess.Popen(
                    [*second, *command],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    env=environment,
                    text=True,
                )
            )
            stack.callback(process.kill)
            assert process.stdout is not None
            assert process.stdout.readline()

        def found(*words: str) -> list[tuple[str, str, int | None, str]]:
            done = subprocess.run(
                [*first, *PIONEER3, "fleet", "discover", *words, "--json", "--seconds", "2"],
                capture_output=True,
                text=True,
                cwd=tmp_path,
                env=environment,
                check=False,
            )
            assert done.returncode == 0, done.stderr
            rows = json.loads(done.stdout)
            return [(row["kind"], row["address"], row["port"], row["name"]) for row in rows]

        # zeroconf tells the name; the bridge that answers the broadcast is at the robot's address
        told = found()
        assert ("simulator", "10.77.0.2", 8101, "bob") in told
        assert [kind for kind, *_ in told] == ["page", "simulator"]
        scanned = found("10.77.0.2", "--no-broadcast")
        assert ("computer", "10.77.0.2", None, "") in scanned
        assert ("simulator", "10.77.0.2", 8101, "MobileSim") in scanned
