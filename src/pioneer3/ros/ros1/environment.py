"""Checks the variables that tell programs of ROS 1 where the master and this computer are."""

import os
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Final
from urllib.parse import urlsplit

from pioneer3.doctor.facts import Finding, warning
from pioneer3.errors import ConfigError, Symptom
from pioneer3.links.hosts import SOMEWHERE, address_towards, is_address, is_loopback, is_own
from pioneer3.ros.addresses import LOCAL, LOOPBACK, PORT

MASTER: Final = "ROS_MASTER_URI"
ADDRESS: Final = "ROS_IP"
NAME: Final = "ROS_HOSTNAME"


def resolve(host: str) -> tuple[str, ...]:
    """Return the addresses of a name; none if it has none."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return ()
    return tuple(dict.fromkeys(str(each[4][0]) for each in found))


def own_address(master: str) -> str:
    """Return the address of this computer that the master's computer sees; nothing is sent."""
    for host in (SOMEWHERE if master in LOOPBACK else master, SOMEWHERE):
        with suppress(OSError):
            return address_towards(host)
    return LOCAL


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkProbe:
    """The questions to this computer and its network, which may take seconds."""

    resolve: Callable[[str], tuple[str, ...]] = resolve
    is_own: Callable[[str], bool] = is_own
    own_address: Callable[[str], str] = own_address


THIS: Final = NetworkProbe()


def check_environment(
    environment: Mapping[str, str] = os.environ, network: NetworkProbe = THIS
) -> Iterator[Finding]:
    """Yield a finding for each variable of ROS 1 that is wrong; ROS_HOSTNAME hides ROS_IP."""
    uri = environment.get(MASTER, "")
    yield from _check_master(uri)
    master = _host_of(uri) or LOCAL
    if environment.get(NAME):
        yield from _check_name(environment[NAME], master, network)
    elif environment.get(ADDRESS):
        yield from _check_address(environment[ADDRESS], master, network)


def environment_warnings(environment: Mapping[str, str] = os.environ) -> list[str]:
    """Return a sentence for each variable that is wrong, in a thread."""
    found = check_environment(environment)
    return [f"{each.found}: {each.meaning}; {each.advice}" for each in found]


def checked_master(uri: str) -> str:
    """Return the address of a master; ConfigError if no program could find it by that."""
    for finding in _check_master(uri):
        raise ConfigError(f"{finding.found}: {finding.meaning}; {finding.advice}")
    return uri


def _check_master(uri: str) -> Iterator[Finding]:
    if uri and _host_of(uri) is None:
        host = uri.rpartition("//")[2].strip("/").partition("/")[0]
        name, _, port = host.partition(":")
        right = f"http://{name or 'localhost'}:{port if port.isdigit() else PORT}"
        yield _finding(
            f"{MASTER}={uri}",
            "the address of a master begins with http:// and ends with its port",
            f"export {MASTER}={right}",
        )


def _check_name(name: str, master: str, network: NetworkProbe) -> Iterator[Finding]:
    found = network.resolve(name)
    if not any(map(network.is_own, found)):
        problem = "nobody finds this computer by that name: it has no address"
        if found:
            problem = f"that name is {found[0]}, no address of this computer"
        advice = f"unset {NAME}; export {ADDRESS}={network.own_address(master)}"
        yield _finding(f"{NAME}={name}", problem, advice)


def _check_address(address: str, master: str, network: NetworkProbe) -> Iterator[Finding]:
    if not is_address(address):
        problem = f"that is no address in numbers; names are for {NAME}"
    elif not network.is_own(address):
        problem = "this computer does not have that address, so no program reaches its nodes"
    elif is_loopback(address) and master not in LOOPBACK:
        problem = f"only this computer reaches that address, and the master is at {master}"
    else:
        return
    advice = f"export {ADDRESS}={network.own_address(master)}"
    yield _finding(f"{ADDRESS}={address}", problem, advice)


def _finding(found: str, meaning: str, advice: str) -> Finding:
    return warning(
        check="ROS 1", found=found, meaning=meaning, advice=advice, symptom=Symptom.ROS_TOPIC_SILENT
    )


def _host_of(uri: str) -> str | None:
    """Return the host of a master's address; `None` if that is none."""
    try:
        parts = urlsplit(uri)
        is_whole = parts.scheme == "http" and bool(parts.port)
    except ValueError:
        return None
    return parts.hostname if is_whole else None
