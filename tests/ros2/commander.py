"""A program that commands 0.3 m/s: `commander.py BACKEND DOMAIN TOPIC RATE [ROUTER...]`.

RATE is in messages per second, 0 for a single one. It prints a line when somebody listens and one
when it has sent, and leaves when its input ends.
"""

import sys
import threading
import time

from pioneer3.ros.ros2.backend import NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.network import BackendName, Network, open_backend
from pioneer3.ros.ros2.types import MessageTypes

SPEED = 0.3


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(backend: str, domain: str, topic: str, rate: str, *routers: str) -> None:
    network = Network(backend=BackendName(backend), domain=int(domain), connect=routers)
    types = MessageTypes(distro_of("jazzy"))
    node = open_backend(network, NodeName("commander"), types)
    writer = node.advertise(topic, types.message_type("geometry_msgs/Twist"), Qos())
    message = types.make("geometry_msgs/Twist")
    message.linear.x = SPEED
    cdr = types.encode(message)
    while not writer.matched:
        time.sleep(0.01)
    say("matched")
    over = threading.Event()

    def command() -> None:
        while not over.is_set():
            writer.write(cdr)
            over.wait(1 / float(rate) if float(rate) else None)

    commanding = threading.Thread(target=command)
    commanding.start()
    sys.stdin.read()
    over.set()
    commanding.join()
    node.close()
    say("left")


if __name__ == "__main__":
    main(*sys.argv[1:])
