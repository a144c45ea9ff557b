"""The variables of ROS 1, and the right value where one is wrong."""

import pytest

from pioneer3.errors import ConfigError
from pioneer3.links.hosts import is_own
from pioneer3.ros.ros1.environment import NetworkProbe, check_environment, checked_master

OWN = "192.168.0.7"
NAMES = {"me": (OWN,), "other": ("192.168.0.9",), "127.0.0.1": ("127.0.0.1",)}
NETWORK = NetworkProbe(
    resolve=lambda name: NAMES.get(name, ()),
    is_own=lambda address: address in (OWN, "127.0.0.1"),
    own_address=lambda master: OWN,
)
LAB = "http://lab:11311"


@pytest.mark.parametrize(
    "environment",
    [
        {},
        {"ROS_MASTER_URI": "http://localhost:11311", "ROS_IP": "127.0.0.1"},
        {"ROS_MASTER_URI": LAB, "ROS_IP": OWN},
        {"ROS_MASTER_URI": "http://127.0.0.1:11311/", "ROS_HOSTNAME": "me"},
        {"ROS_HOSTNAME": "me", "ROS_IP": "10.0.0.1"},  # which ROS_HOSTNAME hides
        {"ROS_MASTER_URI": "http://[fe80::1]:11311", "ROS_IP": ""},
    ],
)
def test_variables_that_fit_are_not_told_of(environment: dict[str, str]) -> None:
    assert not list(check_environment(environment, NETWORK))


@pytest.mark.parametrize(
    ("environment", "found", "advice"),
    [
        ({"ROS_IP": "10.0.0.1"}, "ROS_IP=10.0.0.1", f"export ROS_IP={OWN}"),
        ({"ROS_IP": "me"}, "ROS_IP=me", f"export ROS_IP={OWN}"),
        ({"ROS_IP": "127.0.0.1", "ROS_MASTER_URI": LAB}, "ROS_IP=127", f"export ROS_IP={OWN}"),
        ({"ROS_HOSTNAME": "no"}, "ROS_HOSTNAME=no", f"unset ROS_HOSTNAME; export ROS_IP={OWN}"),
        ({"ROS_HOSTNAME": "other"}, "ROS_HOSTNAME=other", f"export ROS_IP={OWN}"),
    ],
)
def test_an_address_that_leads_to_no_computer_is_told_with_the_right_one(
    environment: dict[str, str], found: str, advice: str
) -> None:
    (finding,) = check_environment(environment, NETWORK)
    assert finding.found.startswith(found)
    assert advice in finding.advice
    assert finding.meaning


@pytest.mark.parametrize(
    ("uri", "right"),
    [
        ("robot:11311", "http://robot:11311"),
        ("192.168.0.1", "http://192.168.0.1:11311"),
        ("http://robot", "http://robot:11311"),
        ("http://robot/", "http://robot:11311"),
        ("https://robot:11312", "http://robot:11312"),
        ("http://robot:port", "http://robot:11311"),
        ("http://", "http://localhost:11311"),
    ],
)
def test_an_address_that_is_no_masters_is_told_with_the_right_one(uri: str, right: str) -> None:
    (finding,) = check_environment({"ROS_MASTER_URI": uri}, NETWORK)
    assert finding.advice == f"export ROS_MASTER_URI={right}"
    with pytest.raises(ConfigError, match=f"export ROS_MASTER_URI={right}"):
        checked_master(uri)
    assert checked_master(right) == right


@pytest.mark.parametrize(("address", "own"), [("127.0.0.1", True), ("192.0.2.77", False)])
def test_this_computer_knows_its_own_addresses(address: str, own: bool) -> None:
    assert is_own(address) is own
