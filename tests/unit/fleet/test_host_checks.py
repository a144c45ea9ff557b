"""The findings about a robot's computer, each from the facts that make it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pioneer3.doctor.facts import Level
from pioneer3.fleet.host_checks import Patient, findings
from pioneer3.fleet.host_facts import HostFacts, parsed, question
from pioneer3.fleet.spec import Fleet, FleetRobot, OperatorComputer

ROBOTS = tuple(
    FleetRobot(name=f"p3at-{n}", host=f"p3at-{n}", address=f"192.168.1.11{n}", node="n", ros="1")
    for n in (1, 2)
)
FLEET = Fleet(
    path=Path("fleet.toml"),
    operator=OperatorComputer(name="laptop", address="192.168.1.10"),
    robots=ROBOTS,
)
HOSTS = {"laptop": "192.168.1.10", "p3at-1": "192.168.1.111", "p3at-2": "192.168.1.112"}
WELL = HostFacts(
    hostname="p3at-1",
    free=20_000_000_000,
    groups=("pioneer", "dialout"),
    device=True,
    device_allowed=True,
    ros=("noetic",),
    environment={"ROS_MASTER_URI": "http://192.168.1.10:11311", "ROS_IP": "192.168.1.111"},
    names={name: (address,) for name, address in HOSTS.items()},
    addresses={address: (name,) for name, address in HOSTS.items()},
    own_addresses=("192.168.1.111",),
    open_ports=True,
    version="0.2.0-aa",
    service="active",
    clock_offset=0.02,
    clock_error=0.01,
    passwords=False,
)


def found(facts: HostFacts, other: HostFacts = WELL) -> dict[str, tuple[Level, str]]:
    both = {"p3at-1": facts, "p3at-2": other}
    patient = Patient(robot=ROBOTS[0], fleet=FLEET, facts=facts, all_facts=both)
    return {each.check: (each.level, each.found) for each in findings(patient)}


def test_nothing_is_wrong_with_a_computer_that_is_well() -> None:
    assert {level for level, _ in found(WELL).values()} == {Level.OK}
    assert len(found(WELL)) == 10


@pytest.mark.parametrize(
    ("change", "check", "level", "words"),
    [
        ({"clock_offset": -0.5}, "clock", Level.WARN, "0.50 s behind"),
        ({"clock_offset": 3.0}, "clock", Level.FAIL, "3.00 s ahead"),
        ({"clock_offset": 3.0, "clock_error": 2.95}, "clock", Level.OK, "3.00 s ahead"),
        ({"device": False}, "serial port", Level.FAIL, "/dev/ttyUSB0 does not exist"),
        ({"device_allowed": False}, "serial port", Level.FAIL, "pioneer may not open"),
        ({"hostname": "ubuntu"}, "own name", Level.WARN, "calls itself ubuntu"),
        ({"names": {}}, "names", Level.WARN, "laptop is unknown, not 192.168.1.10"),
        ({"addresses": {}}, "names", Level.WARN, "no name for 192.168.1.112, 192.168.1.10"),
        (
            {"names": {**WELL.names, "p3at-2": ("10.0.0.1",)}},
            "names",
            Level.WARN,
            "p3at-2 is 10.0.0.1, not 192.168.1.112",
        ),
        ({"environment": {}}, "ROS variables", Level.WARN, "ROS_MASTER_URI is not set"),
        (
            {"environment": {**WELL.environment, "ROS_MASTER_URI": "192.168.1.10"}},
            "ROS variables",
            Level.WARN,
            "is not as http://HOST:11311",
        ),
        (
            {"environment": {**WELL.environment, "ROS_MASTER_URI": "http://other:11311"}},
            "ROS variables",
            Level.WARN,
            "other is no computer of this fleet",
        ),
        (
            {"environment": {**WELL.environment, "ROS_IP": "10.0.0.9"}},
            "ROS variables",
            Level.WARN,
            "ROS_IP=10.0.0.9, its address is 192.168.1.111",
        ),
        ({"open_ports": False}, "firewall", Level.FAIL, "cannot be reached"),
        ({"free": 50_000_000}, "disk", Level.FAIL, "0.1 GB free"),
        ({"free": 500_000_000}, "disk", Level.WARN, "0.5 GB free"),
        ({"version": "0.1.0-bb"}, "version", Level.WARN, "p3at-2 has 0.2.0-aa"),
        ({"ros": ("melodic",)}, "ROS version", Level.WARN, "melodic"),
        ({"service": "failed"}, "service", Level.FAIL, "has failed"),
        ({"passwords": True}, "passwords", Level.WARN, "passwords let people in"),
    ],
)
def test_each_fault_is_found_and_nothing_else(
    change: dict[str, Any], check: str, level: Level, words: str
) -> None:
    told = found(replace(WELL, **change))
    assert told[check][0] is level
    assert words in told[check][1]
    assert all(other is Level.OK for name, (other, _) in told.items() if name != check)


def test_a_name_on_the_loopback_matters_only_without_ros_ip() -> None:
    lonely = replace(WELL, own_addresses=("127.0.1.1",))
    assert found(lonely)["own name"][0] is Level.OK
    alone = replace(lonely, environment={"ROS_MASTER_URI": "http://laptop:11311"})
    assert found(alone)["own name"] == (Level.WARN, "its own name is 127.0.1.1 there")


def test_an_answer_becomes_facts_and_garbage_becomes_nothing() -> None:
    answer = "hostname=p3at-1 \nfree=1024 \nup=12.5\ndevice=yes \nname laptop=192.168.1.10 \nload=x"
    facts = parsed(ROBOTS[0], f"Welcome!\n{answer}\n")
    assert (facts.hostname, facts.free, facts.up, facts.load) == ("p3at-1", 1 << 20, 12.5, None)
    assert (facts.device, facts.device_allowed) == (True, False)
    assert facts.names == {"laptop": ("192.168.1.10",)}
    assert parsed(ROBOTS[0], "") == HostFacts(device=False)


def test_names_in_the_question_cannot_become_commands() -> None:
    robot = replace(ROBOTS[0], port="/dev/x'; touch /tmp/oops #")
    assert "'/dev/x'\"'\"'; touch /tmp/oops #'" in question(robot, FLEET)
