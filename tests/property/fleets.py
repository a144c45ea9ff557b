"""Fleets at random, for property tests."""

from ipaddress import IPv4Address, IPv6Address
from pathlib import Path
from types import MappingProxyType

from hypothesis import strategies as st

from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import Defaults, Fleet, FleetRobot, OperatorComputer, usual_node

PATH = Path("lab/fleet.toml")
LABELS = st.from_regex(r"\A[a-z0-9]([a-z0-9-]{0,8}[a-z0-9])?\Z").filter(
    lambda name: name not in {"all", "localhost"}
)
ADDRESSES = st.one_of(
    st.integers(0x0B000000, 0xDF000000).map(lambda number: str(IPv4Address(number))),
    st.integers(1 << 125, 1 << 126).map(lambda number: str(IPv6Address(number))),
)
USERS = st.from_regex(r"\A[a-z_][a-z0-9_.-]{0,12}\Z")
MODELS = st.sampled_from(["p3at", "p3dx-sh", "peoplebot-sh"])
LASERS = st.sampled_from(["", "auto", "/dev/ttyACM0", "lms-111@tcp:192.168.1.200"])
ROS = st.sampled_from(["", "1", "2"])
DEVICES = st.sampled_from(["/dev/ttyUSB0", "/dev/ttyS0", "serial:/dev/pioneer3/robot", "COM3"])
NETWORKS = st.one_of(
    st.builds(
        FleetNetwork,
        name=LABELS,
        backend=st.just("dds"),
        distro=st.sampled_from(["", "humble", "jazzy", "kilted", "lyrical"]),
        domain=st.none() | st.integers(0, 232),
        interface=st.tuples(st.just("wlan0")) | st.just(()),
        peer=st.tuples(ADDRESSES) | st.just(()),
        dds_services=st.booleans(),
    ),
    st.builds(
        FleetNetwork,
        name=LABELS,
        backend=st.just("zenoh"),
        connect=st.just(("tls/fleet.example.org:7447", "tcp/[::1]:7447")) | st.just(()),
        ca=st.just("tls/ca.pem"),
        certificate=st.just("tls/laptop.pem"),
        key=st.just("~/laptop.key"),
        credentials=st.sampled_from(["", "login"]),
    ),
)
PRINTABLE = st.text(st.characters(exclude_categories=["C", "Z"], include_characters=" \"\\'#[]="))


@st.composite
def fleets(draw: st.DrawFn, at_least: int = 0) -> Fleet:
    """Return a fleet that may be in a file."""
    size = draw(st.integers(at_least, 6))
    labels = draw(st.lists(LABELS, min_size=2 * size + 3, max_size=2 * size + 3, unique=True))
    addresses = draw(st.lists(ADDRESSES, min_size=size + 1, max_size=size + 1, unique=True))
    names, hosts = labels[:size], labels[size : 2 * size]
    networks = tuple(draw(st.lists(NETWORKS, unique_by=lambda each: each.name, max_size=2)))
    defaults = Defaults(
        user=draw(USERS),
        port=draw(DEVICES),
        model=draw(MODELS),
        laser=draw(LASERS),
        ros=draw(ROS),
        network=draw(st.sampled_from(["", *(each.name for each in networks)])),
    )
    robots = []
    for name, host, address in zip(names, hosts, addresses, strict=False):
        reached = f"tcp://{host}:{draw(st.integers(1, 65535))}"
        ros = draw(ROS)
        robot = FleetRobot(
            name=name,
            host=draw(st.sampled_from([name, host, f"{host}.local"])),
            address=address,
            port=(port := draw(DEVICES | st.just(reached))),
            bridge=0 if ros or port == reached else draw(st.integers(0, 65535)),
            user=draw(USERS | st.just(defaults.user)),
            model=draw(MODELS),
            laser=draw(LASERS),
            ros=ros,
            network=draw(st.sampled_from(["", *(each.name for each in networks)])),
            node=usual_node(name, ros) if draw(st.booleans()) else f"Own_{name.replace('-', '_')}",
            note=draw(PRINTABLE),
        )
        robots.append(robot)
    operator = OperatorComputer(
        name=draw(st.sampled_from(["", labels[-1]])),
        address=draw(st.sampled_from(["", addresses[-1]])),
        user=draw(st.just("") | USERS),
    )
    groups = {
        name: tuple(draw(st.lists(st.sampled_from(names), unique=True))) if names else ()
        for name in labels[2 * size : -1]
    }
    return Fleet(
        path=PATH,
        operator=operator,
        defaults=defaults,
        networks=networks,
        robots=tuple(robots),
        groups=MappingProxyType(groups),
    )
