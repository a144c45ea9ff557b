"""Another program on the network: `zenoh_peer.py ROLE OPTIONS`, the options of Zenoh as JSON.

It prints a line for each thing that happens, and ends when its input does.
"""

import asyncio
import json
import logging
import sys
import threading
import time
from pathlib import Path

from pioneer3.ros.ros2.backend import LATCHED, MessageType, NodeName, Qos, ServiceType, Writer
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.zenoh.backend import ZenohBackend
from pioneer3.ros.zenoh.settings import ZenohOptions, serve_router

STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
TEXT = MessageType("std_msgs/msg/String", STRING)
SETBOOL = "RIHS01_abe9e4bbd6b36e1b1fa3bc5d4a4a2d7bb6b3d6a2a7d3ab0ed9a1b0f6c0ffee00"
SWITCH = ServiceType(
    "std_srvs/srv/SetBool",
    SETBOOL,
    MessageType("std_srvs/srv/SetBool_Request"),
    MessageType("std_srvs/srv/SetBool_Response"),
)
"""The hash is none of ROS's: services are found by it, whatever it is."""
LARGE = bytes(1_000_000)


def options_of(text: str) -> ZenohOptions:
    given = json.loads(text)
    for name in ("connect", "listen"):
        if name in given:
            given[name] = tuple(given[name])
    for name in ("config", "ca", "certificate", "key", "credentials"):
        if given.get(name):
            given[name] = Path(given[name])
    return ZenohOptions(**given)


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def node(role: str, options: ZenohOptions) -> None:
    kind, _, name = role.partition(":")
    backend = ZenohBackend(NodeName(name or kind), MessageTypes(distro_of("jazzy")), options)
    if kind == "talk":
        writer = backend.advertise("/chat", TEXT, Qos())
        threading.Thread(target=talk, args=(writer,), daemon=True).start()
    elif kind == "latch":
        backend.advertise("/small", TEXT, LATCHED).write(b"latched")
        backend.advertise("/large", TEXT, LATCHED).write(LARGE)
    elif kind == "listen":
        backend.subscribe(
            "/chat", TEXT, Qos(), lambda cdr, gid: say(f"got {len(cdr)}"), lambda gid: None
        )
    elif kind == "serve":
        backend.serve("/switch", SWITCH, lambda request: request[::-1])
    say("ready")
    sys.stdin.read()
    backend.close()


def talk(writer: Writer) -> None:
    while True:
        writer.write(b"hello")
        time.sleep(0.05)


def main(role: str, options: ZenohOptions) -> None:
    logging.basicConfig(level=logging.WARNING, stream=sys.stdout)
    if role == "router":
        asyncio.run(serve_router(options, say))
    else:
        node(role, options)


if __name__ == "__main__":
    main(sys.argv[1], options_of(sys.argv[2]))
