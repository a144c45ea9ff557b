"""A host that is as quiet as ARIA: it sends a velocity every 0.6 s, and reads all that comes.

python -m tests.fleet.quiet_host ADDRESS PORT SPEED
"""

import socket
import sys
import time

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode

EVERY = 0.6


def frame(command: Command) -> bytes:
    """Return `command` as it is on the wire."""
    return encode(commands.to_payload(command))


def shake_hands(connection: socket.socket) -> None:
    """Open a session."""
    reader = PacketReader()
    for number in (0, 1, 2):
        connection.sendall(encode(bytes([number])))
        while not reader.feed(connection.recv(4096)):
            pass
    connection.sendall(frame(commands.Open()) + frame(commands.Enable(on=True)))


def drive(connection: socket.socket, speed: float) -> None:
    """Drive for ever; say once that the robot moves."""
    reader, due, told = PacketReader(), time.monotonic(), False
    while True:
        if time.monotonic() >= due:
            due += EVERY
            connection.sendall(frame(commands.Vel(speed=speed)))
        connection.settimeout(max(0.01, due - time.monotonic()))
        try:
            data = connection.recv(4096)
        except TimeoutError:
            continue
        if not data:
            return
        for payload in reader.feed(data):
            report = reports.from_payload(payload)
            if isinstance(report, reports.Sip) and report.left_speed_raw > 200 and not told:
                told = True
                sys.stdout.write("moves\n")
                sys.stdout.flush()


if __name__ == "__main__":
    with socket.create_connection((sys.argv[1], int(sys.argv[2])), timeout=10) as opened:
        shake_hands(opened)
        drive(opened, float(sys.argv[3]))
