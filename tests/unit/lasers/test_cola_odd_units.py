"""The host's side, against lasers that refuse, know little, are dirty or answer nonsense."""

from math import radians

import pytest

from pioneer3.lasers.client import Identified, LaserIdentity, ScanSettings
from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.cola.wire import encode
from tests.unit.lasers.cola_room import losses, remarks, room, writes


@pytest.mark.parametrize("run", ["sAN Run 0", "sAN Run 1", "sAN Run"])
@pytest.mark.parametrize(
    "login", ["sAN SetAccessMode", "sAN SetAccessMode ", "sAN SetAccessMode 1"]
)
def test_units_that_answer_in_other_words_are_understood(run: str, login: str) -> None:
    at = room(wishes=ScanSettings(intensities=True))
    at.instead = {
        "sMN Run": run,
        "sMN SetAccessMode": login,
        "sWN LMDscandatacfg": "sWA LMDscandatacfg ",
    }
    at.run(1.0)
    assert len(at.scans) > 10
    assert remarks(at) == []


def test_a_laser_that_refuses_the_login_is_used_as_it_is() -> None:
    at = room(wishes=ScanSettings(skip=1))
    at.instead["sMN SetAccessMode"] = "sAN SetAccessMode 0"
    at.run(1.0)
    (remark,) = remarks(at)
    assert "password" in remark
    assert at.scans[-1].period == 0.02


def test_a_laser_that_refuses_a_setting_is_used_as_it_is() -> None:
    at = room(wishes=ScanSettings(skip=1, step=radians(0.25), last=0.0))
    at.instead["sWN LMDscandatacfg"] = "sFA A"
    at.instead["sWN LMPoutputRange"] = "sFA 77"
    at.instead["sMN mLMPsetscancfg"] = "sAN mLMPsetscancfg 2 1388 1 1388 FFF92230 225510"
    at.run(1.0)
    assert remarks(at) == [
        "the laser keeps its mLMPsetscancfg as it is:"
        " it does not have this step at this scan frequency",
        "the laser keeps its LMPoutputRange as it is: error 77",
        "the laser keeps its LMDscandatacfg as it is: this login may not write that",
    ]
    assert (at.scans[-1].period, len(at.scans[-1].ranges)) == (0.02, 541)


def test_a_unit_that_knows_little_still_sends_scans() -> None:
    at = room()
    for unknown in ("sRI0", "sRN DeviceIdent", "sRN SerialNumber", "sRN Firmw", "sRN STlms"):
        at.instead[unknown] = "sFA 3"
    at.instead["sRN SCdevicestate"] = "sFA 3"
    at.run(1.0)
    assert at.events[0] == Identified(LaserIdentity(vendor="SICK", protocol="CoLa-A"))
    assert len(at.scans) > 10
    assert writes(at) == []


def test_a_laser_that_sends_to_nobody_else_is_lost_with_advice() -> None:
    at = room()
    at.instead["sEN LMDscandata 1"] = "sEA LMDscandata 0"
    at.run(1.0)
    (reason,) = losses(at)
    assert "other programs" in reason


def test_answers_that_cannot_be_read_are_not_asked_for_endlessly() -> None:
    at = room()
    at.instead["sRN LMPscancfg"] = "sRA LMPscancfg nonsense"
    at.instead["sRN STlms"] = "sRA STlms measuring"
    at.run(5.0)
    settings, state = remarks(at)
    assert "sRN LMPscancfg" in settings
    assert "sRN STlms" in state
    assert len(at.scans) > 100
    assert at.sent.count("sRN LMPscancfg") == 3


@pytest.mark.parametrize(
    ("status", "word"), [((0, 1), "error"), ((0, 2), "getting dirty"), ((0, 4), "too dirty")]
)
def test_a_dirty_front_screen_is_told_once(status: tuple[int, int], word: str) -> None:
    at = room()
    at.laser.unit.status = status
    at.run(1.0)
    (remark,) = remarks(at)
    assert word in remark
    assert len(at.scans) > 10


def test_scans_that_are_wrong_are_dropped_and_told_once() -> None:
    at = room()
    at.run(1.0)
    before, client = len(at.scans), at.client
    assert client is not None
    for text in ("sSN LMDscandata 1 1", "sSN LMDscandata", "sSN LMDscandata x"):
        at.events += client.receive(encode(text), at.now)
    assert client.refused == 3
    assert len(remarks(at)) == 1
    assert len(at.scans) == before
    at.deaf = True
    at.run(2.0)
    assert losses(at) == ["the last 3 scans of the laser could not be read"]


def test_a_refusal_that_comes_twice_is_that_of_one_request() -> None:
    client = ColaClient(0.0)
    client.tick(0.0)
    client.receive(encode("sEA LMDscandata 0"), 0.1)
    client.tick(0.4)
    assert client.outgoing() == encode("sEN LMDscandata 0") + 2 * encode("sRI0")
    assert client.receive(2 * encode("sFA 3"), 0.6) == []
    assert client.outgoing() == encode("sRN DeviceIdent")
    client.receive(encode("sRA DeviceIdent 6 LMS111 5 V1.36"), 0.7)
    client.receive(encode("sRA SerialNumber 8 10010001"), 0.8)
    (event,) = client.receive(encode("sRA FirmwareVersion 5 V1.36"), 0.9)
    assert isinstance(event, Identified)
    assert (event.identity.product, event.identity.serial) == ("LMS111", "10010001")


def test_scans_that_nobody_has_asked_for_yet_are_passed_over() -> None:
    at = room()
    at.run(0.1)
    assert at.scans
    late = ColaClient(0.0)
    late.tick(0.0)
    words = at.laser.unit.latest_scan(at.now)
    assert late.receive(encode(f"sSN LMDscandata {words}"), 0.1) == []
    assert late.refused == 0
    assert late.deadline == 0.25
