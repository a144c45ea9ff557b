"""Discovery: what bytes of a bridge mean, what is offered, and two hosts that find each other."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.fleet.discovery import (
    BRIDGE_QUERY,
    FindingKind,
    Found,
    addresses_in,
    bridge_answer,
    discover,
    offers,
)
from pioneer3.fleet.inventory import parse_fleet
from pioneer3.sim.server.start import simulator

LAB = parse_fleet(Path("f.toml"), '[[robot]]\nname = "p3at-1"\naddress = "10.0.0.1"\n')


def test_addresses_are_single_ones_and_networks() -> None:
    assert addresses_in(["10.0.0.9", "10.0.0.1/30", "10.0.0.9"]) == (
        "10.0.0.9",
        "10.0.0.1",
        "10.0.0.2",
    )
    assert len(addresses_in(["10.0.0.0/24"])) == 254


@pytest.mark.parametrize(
    ("word", "words"), [("lab", "expected an address or a network"), ("10.0.0.0/8", "16777216")]
)
def test_what_is_no_address_or_too_many_is_refused(word: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        addresses_in([word])


def test_a_bridge_is_known_by_its_answer() -> None:
    answer = b"\0\0\0\xf7" + bytes(26)
    robot = b"\0\0\0\xf7" + bytes(4) + b"\xfa\xfb" + bytes(20)
    assert bridge_answer(answer, "10.0.0.7") == Found(
        kind=FindingKind.BRIDGE, address="10.0.0.7", detail="its device is not told"
    )
    assert "a robot is behind it" in getattr(bridge_answer(robot, "10.0.0.7"), "detail", "")
    assert bridge_answer(BRIDGE_QUERY, "10.0.0.7") is None


@given(st.binary(max_size=40))
def test_other_bytes_are_no_bridge(data: bytes) -> None:
    found = bridge_answer(data, "10.0.0.7")
    assert (found is not None) == (data[:4] == b"\0\0\0\xf7")


def test_what_is_offered_is_a_fleet_file_with_new_robots_alone() -> None:
    found = [
        Found(kind=FindingKind.COMPUTER, address="10.0.0.1", name="p3at-1", detail="OpenSSH_9.2"),
        Found(kind=FindingKind.COMPUTER, address="10.0.0.2", name="P3AT_1", detail="OpenSSH_9.2"),
        Found(
            kind=FindingKind.SIMULATOR, address="10.0.0.2", port=8101, detail="P3-DX", model="p3dx"
        ),
        Found(
            kind=FindingKind.SIMULATOR, address="10.0.0.2", port=8102, detail="P3-AT", model="p3at"
        ),
        Found(kind=FindingKind.BRIDGE, address="10.0.0.3", detail="a robot\nname = 1"),
        Found(kind=FindingKind.COMPUTER, address="fd00::9", detail="OpenSSH"),
    ]
    text = "\n".join(offers(found, LAB)) + "\n"
    robots = parse_fleet(Path("new.toml"), text).robots
    assert [(robot.name, robot.address, robot.port, robot.model) for robot in robots] == [
        ("P3AT-1-2", "10.0.0.2", "tcp://10.0.0.2:8101", "p3dx"),
        ("robot-3", "10.0.0.3", "/dev/ttyUSB0", ""),
        ("robot-9", "fd00::9", "/dev/ttyUSB0", ""),
    ]
    assert "# simulator at port 8102: P3-AT" in text


TEXTS = st.text(max_size=30)


@pytest.mark.parametrize("told", ["p3at-sh-/../secret.toml", "p3at-sh-.p", 'p3at-sh-"'])
def test_a_model_that_the_network_tells_is_a_name_and_no_path(told: str) -> None:
    found = Found(
        kind=FindingKind.ROBOT, address="10.0.0.9", port=8101, name="a", detail="", model=told
    )
    assert not any("model" in line for line in offers([found], None))


@given(
    st.lists(
        st.builds(
            Found,
            kind=st.sampled_from(FindingKind),
            address=st.ip_addresses()
            .filter(lambda ip: not (ip.is_unspecified or ip.is_multicast))
            .map(str),
            port=st.none() | st.integers(1, 65535),
            name=TEXTS,
            detail=TEXTS,
            model=TEXTS | st.just("p3dx"),
        ),
        max_size=5,
    )
)
def test_whatever_the_network_says_the_offer_is_a_fleet_file(found: list[Found]) -> None:
    found = [one for one in found if one.address not in {"255.255.255.255", "10.0.0.1"}]
    robots = parse_fleet(Path("new.toml"), "\n".join(offers(found, LAB))).robots
    assert {robot.address for robot in robots} == {one.address for one in found}


@pytest.mark.realtime
async def test_a_simulator_at_an_address_is_found_and_named() -> None:
    async with simulator(map_name="empty", port=8101, host="127.0.0.77") as here:
        found = await discover(["127.0.0.77"], seconds=0.5, broadcast=False)
        model = here.robots[0].model.name
    assert [(one.kind, one.address, one.port, one.model) for one in found] == [
        (FindingKind.SIMULATOR, "127.0.0.77", 8101, model)
    ]
