"""Findings about a robot's computer, from its facts, as the notes of lab manuals warn of them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final
from urllib.parse import urlsplit

from pioneer3.doctor.facts import FORBIDDEN, Finding, Level, failure, ok, warning
from pioneer3.fleet.host_facts import ROS_VARIABLES, HostFacts
from pioneer3.fleet.key import WITHOUT_PASSWORDS
from pioneer3.fleet.ros_graph import MASTER_PORT
from pioneer3.fleet.spec import Fleet, FleetRobot

CLOCKS_DIFFER = 0.1
"""Offset from which transforms of two computers differ visibly [s]."""
CLOCKS_WRONG = 1.0
"""Offset from which tf refuses transforms [s]."""
DISK_LOW = 1_000_000_000
"""Free space below which recordings soon stop [bytes]."""
DISK_FULL = 100_000_000
"""Free space below which nothing can be installed [bytes]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Patient:
    """A robot's computer with its facts, among those of its fleet."""

    robot: FleetRobot
    fleet: Fleet
    facts: HostFacts
    all_facts: Mapping[str, HostFacts]


def check_clock(patient: Patient) -> Iterator[Finding]:
    """Do the clocks agree?"""
    offset, error = patient.facts.clock_offset, patient.facts.clock_error
    if offset is None:
        return
    found = f"{abs(offset):.2f} s {'ahead of' if offset > 0 else 'behind'} this computer"
    if abs(offset) - error > CLOCKS_DIFFER:
        wrong = abs(offset) - error > CLOCKS_WRONG
        yield Finding(
            check="clock",
            level=Level.FAIL if wrong else Level.WARN,
            found=found,
            meaning="ROS compares times of two computers: transforms and scans are refused.",
            advice="On it run: sudo apt-get install -y chrony; without internet let it follow this "
            "computer (server ADDRESS iburst in /etc/chrony/chrony.conf).",
        )
    else:
        yield ok("clock", f"{found} (to {error:.2f} s)")


def check_serial(patient: Patient) -> Iterator[Finding]:
    """May the user open the robot's port?"""
    facts, port, user = patient.facts, patient.robot.port, patient.robot.user
    if facts.device is None:
        return
    if not facts.device:
        yield failure(
            check="serial port",
            found=f"{port} does not exist",
            meaning="The cable or its adapter is not plugged in, or has another name there.",
            advice="On it run: pioneer3 find-port; then mend port in the fleet file.",
        )
    elif not facts.device_allowed:
        yield failure(
            check="serial port",
            found=f"{user} may not open {port}",
            meaning="Serial ports belong to the group dialout"
            + ("; the login is older than the membership." if "dialout" in facts.groups else "."),
            advice=f"On it run: sudo usermod -aG dialout {user}; then log in anew.",
            code=FORBIDDEN,
        )
    else:
        yield ok("serial port", f"{user} may open {port}")


def check_names(patient: Patient) -> Iterator[Finding]:
    """Does it know the other computers by name, and itself by its address?"""
    facts, robot, operator = patient.facts, patient.robot, patient.fleet.operator
    wanted = {each.host: each.address for each in patient.fleet.robots}
    if operator.name and operator.address:
        wanted[operator.name] = operator.address
    wrong = [
        f"{name} is {' '.join(facts.names.get(name, ())) or 'unknown'}, not {address}"
        for name, address in wanted.items()
        if name != robot.host and address not in facts.names.get(name, ())
    ]
    without_name = [
        address
        for name, address in wanted.items()
        if name not in facts.addresses.get(address, ()) and name != robot.host
    ]
    if wrong or without_name:
        reverse = [f"no name for {', '.join(without_name)}"] if without_name and not wrong else []
        yield warning(
            check="names",
            found="; ".join([*wrong, *reverse]),
            meaning="ROS nodes call each other by name: topics are listed, but nothing arrives.",
            advice="pioneer3 fleet hosts shows the lines for /etc/hosts there.",
        )
    else:
        yield ok("names", "knows all by name and by address")


def check_own_name(patient: Patient) -> Iterator[Finding]:
    """Is its own name the one that others use, and does it lead to it?"""
    facts, robot = patient.facts, patient.robot
    if facts.hostname and facts.hostname != robot.host:
        yield warning(
            check="own name",
            found=f"it calls itself {facts.hostname}, the fleet file {robot.host}",
            meaning="ROS tells other computers its own name, which they do not know.",
            advice=f"On it run: sudo hostnamectl set-hostname {robot.host}",
        )
        return
    loopback = [each for each in facts.own_addresses if each.startswith("127.")]
    says_address = facts.environment.get("ROS_IP") or facts.environment.get("ROS_HOSTNAME")
    if loopback and loopback == list(facts.own_addresses) and not says_address:
        yield Finding(
            check="own name",
            level=Level.WARN if robot.ros else Level.OK,
            found=f"its own name is {', '.join(loopback)} there",
            meaning="Programs that ask for their address hear one that only they can reach.",
            advice=f"Let its /etc/hosts say: {robot.address} {robot.host}; or set ROS_IP.",
        )
    else:
        yield ok("own name", facts.hostname)


def check_ros(patient: Patient) -> Iterator[Finding]:
    """Do terminals there have the variables of ROS 1 that fit this network?"""
    robot, facts = patient.robot, patient.facts
    if robot.ros != "1":
        return
    wrong = list(_wrong_variables(patient))
    if wrong:
        yield warning(
            check="ROS variables",
            found="; ".join(wrong),
            meaning="Its nodes look for another master, or tell others a wrong address.",
            advice=f"In its ~/.bashrc: export ROS_IP={robot.address}, and the ROS_MASTER_URI that "
            "you mean; not both ROS_IP and ROS_HOSTNAME.",
        )
    else:
        master = f"{ROS_VARIABLES[0]}={facts.environment.get(ROS_VARIABLES[0])}"
        yield ok("ROS variables", master)


def _wrong_variables(patient: Patient) -> Iterator[str]:
    environment, robot, fleet = patient.facts.environment, patient.robot, patient.fleet
    uri, ip, name = (environment.get(each, "") for each in ROS_VARIABLES)
    known = {each for robot in fleet.robots for each in (robot.host, robot.name, robot.address)}
    known |= {fleet.operator.name, fleet.operator.address, "localhost", "127.0.0.1"}
    try:
        master = urlsplit(uri)
        host, port = master.hostname or "", master.port
    except ValueError:
        host, port = "", None
    if not uri:
        yield "ROS_MASTER_URI is not set"
    elif master.scheme != "http" or not host or port is None:
        yield f"ROS_MASTER_URI={uri} is not as http://HOST:{MASTER_PORT}"
    elif host not in known:
        yield f"ROS_MASTER_URI={uri}: {host} is no computer of this fleet"
    if ip and ip != robot.address:
        yield f"ROS_IP={ip}, its address is {robot.address}"
    if name and name not in {robot.host, robot.address}:
        yield f"ROS_HOSTNAME={name}, its name is {robot.host}"


def check_firewall(patient: Patient) -> Iterator[Finding]:
    """Do we reach programs there?"""
    facts = patient.facts
    if facts.open_ports is None:
        return
    if facts.open_ports:
        yield ok("firewall", "its programs can be reached")
    else:
        source = patient.fleet.operator.address or "YOUR-ADDRESS"
        yield failure(
            check="firewall",
            found="a port that a program opens there cannot be reached from here",
            meaning="ROS nodes and robots' ports are on ports of any number."
            + (" Its firewall ufw is on." if facts.firewall else ""),
            advice=f"On it run: sudo ufw allow from {source}",
        )


def check_disk(patient: Patient) -> Iterator[Finding]:
    """Is there room on its disk?"""
    free = patient.facts.free
    if free is None:
        return
    level = Level.FAIL if free < DISK_FULL else Level.WARN if free < DISK_LOW else Level.OK
    yield Finding(
        check="disk",
        level=level,
        found=f"{free / 1e9:.1f} GB free",
        meaning="" if level is Level.OK else "Recordings and installations fail soon.",
        advice="" if level is Level.OK else "On it run: du -xh ~ | sort -h | tail",
    )


def check_versions(patient: Patient) -> Iterator[Finding]:
    """Has it the same pioneer3 and the same ROS as the others?"""
    others = {name: facts for name, facts in patient.all_facts.items() if facts.version}
    mine = patient.facts.version
    differing = sorted(name for name, facts in others.items() if facts.version != mine)
    if mine and differing:
        shown = ", ".join(f"{name} has {others[name].version}" for name in differing)
        yield warning(
            check="version",
            found=f"pioneer3 {mine}; {shown}",
            advice="pioneer3 fleet deploy puts the same on all.",
        )
    elif mine:
        yield ok("version", f"pioneer3 {mine}")
    same_ros = {facts.ros for facts in patient.all_facts.values() if facts.ros}
    if patient.facts.ros and len(same_ros) > 1:
        yield warning(
            check="ROS version",
            found=f"{', '.join(patient.facts.ros)}; others have another",
            meaning="Messages of the same name may differ between distributions.",
        )


def check_service(patient: Patient) -> Iterator[Finding]:
    """Does our service run, where it is installed?"""
    state = patient.facts.service
    if state == "failed":
        yield failure(
            check="service",
            found="the service that drives the robot has failed",
            advice=f"pioneer3 fleet logs --on {patient.robot.name}",
        )
    elif patient.facts.version and state:
        yield ok("service", f"the service is {state}")


def check_passwords(patient: Patient) -> Iterator[Finding]:
    """Does a shared password let people in?"""
    if patient.facts.passwords is None:
        return
    if patient.facts.passwords:
        yield warning(
            check="passwords",
            found="passwords let people in",
            meaning="Whoever knows the shared one can drive this robot.",
            advice=f"pioneer3 fleet key for every user; then on it: {WITHOUT_PASSWORDS}",
        )
    else:
        yield ok("passwords", "keys only")


CHECKS: Final[tuple[Callable[[Patient], Iterator[Finding]], ...]] = (
    check_disk,
    check_own_name,
    check_names,
    check_firewall,
    check_clock,
    check_serial,
    check_ros,
    check_versions,
    check_service,
    check_passwords,
)
"""The checks in the order of repair."""


def findings(patient: Patient) -> tuple[Finding, ...]:
    """Return the findings about one robot's computer, in the order of repair."""
    return tuple(finding for check in CHECKS for finding in check(patient))
