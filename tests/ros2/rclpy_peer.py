"""A program with rclpy, as any user may write it: `rclpy_peer.py`.

It takes commands as lines of JSON, and prints one for each message, response and mismatch. It ends
with its input.
"""

import contextlib
import importlib
import json
import sys
import threading
import time
from typing import Any

rclpy = importlib.import_module("rclpy")
events = importlib.import_module("rclpy.event_handler")
executors = importlib.import_module("rclpy.executors")
qos_of = importlib.import_module("rclpy.qos")


def kind_of(name: str) -> Any:
    """Return the class of a type such as `nav_msgs/msg/Odometry`."""
    package, kind, last = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), last)


def filled(message: Any, fields: dict[str, Any]) -> Any:
    """Fill a message, or a part of it."""
    for name, value in fields.items():
        there = getattr(message, name)
        if isinstance(value, dict):
            filled(there, value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            inner = message.get_fields_and_field_types()[name].partition("<")[2].rstrip(">")
            package, _, last = inner.partition("/")
            setattr(message, name, [filled(kind_of(f"{package}/msg/{last}")(), v) for v in value])
        else:
            setattr(message, name, type(there)(value) if isinstance(there, float) else value)
    return message


def told(value: Any) -> Any:
    """Return a message or a part of it for JSON."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: told(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, str | int | float):
        return value
    return value.hex() if isinstance(value, bytes) else [told(each) for each in value]


def profile(*, reliable: bool = True, latched: bool = False, depth: int = 10) -> Any:
    """Return a quality of service."""
    reliability, durability = qos_of.ReliabilityPolicy, qos_of.DurabilityPolicy
    return qos_of.QoSProfile(
        depth=depth,
        reliability=reliability.RELIABLE if reliable else reliability.BEST_EFFORT,
        durability=durability.TRANSIENT_LOCAL if latched else durability.VOLATILE,
    )


def say(**line: Any) -> None:
    """Print what happened; times are those of the monotonic clock [s]."""
    sys.stdout.write(json.dumps({"at": time.monotonic(), **line}) + "\n")
    sys.stdout.flush()


class Peer:
    """A node with publishers and subscribers by topic."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("peer")
        self.entities: dict[str, Any] = {}
        self.timers: dict[str, Any] = {}
        say(ready=True)

    def listen(self, *, topic: str, kind: str, **qos: Any) -> None:
        """Subscribe."""
        told_of = events.SubscriptionEventCallbacks(
            incompatible_qos=lambda event: say(mismatch=topic, policy=str(event.last_policy_kind))
        )
        self.entities[topic] = self.node.create_subscription(
            kind_of(kind),
            topic,
            lambda message: say(topic=topic, message=told(message)),
            profile(**qos),
            event_callbacks=told_of,
        )

    def publish(self, *, topic: str, kind: str, fields: Any, rate: float, **qos: Any) -> None:
        """Send the message again and again, at a rate [Hz]; 0 sends nothing yet."""
        message = filled(kind_of(kind)(), fields)
        told_of = events.PublisherEventCallbacks(
            incompatible_qos=lambda event: say(mismatch=topic, policy=str(event.last_policy_kind))
        )
        made = self.node.create_publisher(
            type(message), topic, profile(**qos), event_callbacks=told_of
        )
        self.entities[topic] = made
        if rate:
            self.timers[topic] = self.node.create_timer(1 / rate, lambda: made.publish(message))

    def send(self, *, topic: str, fields: Any) -> None:
        """Send one message on a topic that is published already, and tell when."""
        publisher = self.entities[topic]
        message = filled(publisher.msg_type(), fields)
        began = time.monotonic()
        publisher.publish(message)
        say(sent=topic, began=began)

    def close(self, *, topic: str) -> None:
        """Leave a topic."""
        entity, timer = self.entities.pop(topic), self.timers.pop(topic, None)
        if timer is None:
            self.node.destroy_subscription(entity)
            return
        self.node.destroy_timer(timer)
        self.node.destroy_publisher(entity)

    def call(self, *, number: int, service: str, kind: str, fields: Any) -> None:
        """Call a service, once it is there."""
        client = self.node.create_client(kind_of(kind), service)
        request = filled(kind_of(kind).Request(), fields)

        def look() -> None:
            if client.service_is_ready():
                self.node.destroy_timer(timer)
                client.call_async(request).add_done_callback(done)

        def done(future: Any) -> None:
            say(number=number, response=told(future.result()))
            self.node.destroy_client(client)

        timer = self.node.create_timer(0.02, look)

    def look(self, *, number: int) -> None:
        """Tell the nodes, the endpoints and the services that are known."""
        node, endpoints = self.node, []
        for name, _ in node.get_topic_names_and_types():
            for reads, found in (
                (False, node.get_publishers_info_by_topic(name)),
                (True, node.get_subscriptions_info_by_topic(name)),
            ):
                endpoints += [
                    {
                        "topic": name,
                        "reads": reads,
                        "node": each.node_namespace.rstrip("/") + "/" + each.node_name,
                        "kind": each.topic_type,
                        "hash": str(each.topic_type_hash),
                        "reliable": each.qos_profile.reliability.name == "RELIABLE",
                        "latched": each.qos_profile.durability.name == "TRANSIENT_LOCAL",
                    }
                    for each in found
                ]
        nodes = [
            (space.rstrip("/") + "/" + name) for name, space in node.get_node_names_and_namespaces()
        ]
        services = dict(node.get_service_names_and_types())
        say(number=number, response={"nodes": nodes, "endpoints": endpoints, "services": services})


def main() -> None:
    rclpy.init()
    peer = Peer()
    executor = executors.SingleThreadedExecutor()
    executor.add_node(peer.node)

    def obey() -> None:
        for line in sys.stdin:
            command = json.loads(line)
            executor.create_task(lambda c=command: getattr(peer, c.pop("do"))(**c))
        rclpy.shutdown()

    threading.Thread(target=obey, daemon=True).start()
    with contextlib.suppress(executors.ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
