"""The client finds a simulated LMS-2xx in any state (lms2xx.md 3.1)."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, radians

import pytest

from pioneer3.lasers.client import (
    Event,
    Identified,
    Measured,
    Patience,
    ScanSettings,
    ScansLost,
)
from pioneer3.lasers.lms2xx import LmsClient, LmsDevice, commands
from pioneer3.lasers.lms2xx.blocks import UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.commands import CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import Units, Variant
from pioneer3.lasers.lms2xx.telegram import encode
from pioneer3.models.lasers import LASERS
from tests.unit.lasers.lms_support import (
    LMS200,
    SPEEDS,
    WRITTEN,
    Cable,
    first_scan,
    ready,
    remarks,
    run,
    scans,
    speeds,
)

STREAM = commands.mode(OperatingMode.ALL_VALUES)
PATIENT = Patience(give_up=90.0)


@pytest.mark.parametrize("order", [SPEEDS, SPEEDS[::-1]])
@pytest.mark.parametrize("before", ["idle", "streams", "streams turns", "installation"])
@pytest.mark.parametrize("start", SPEEDS)
def test_a_unit_in_any_state_is_found_at_any_speed(
    start: int, before: str, order: Sequence[int]
) -> None:
    cable = ready(start)
    cable.send(
        {
            "idle": b"",
            "streams": STREAM,
            "streams turns": commands.mode(OperatingMode.PARTIAL_SCANS),
            "installation": commands.mode(OperatingMode.INSTALLATION, commands.PASSWORD),
        }[before]
    )
    cable.listen(1.234)  # in the middle of a telegram
    events = run(cable, LmsClient(cable.now, order), Measured, 3.0)
    assert scans(events)[0].ranges == (2.0,) * 181
    assert speeds(events)[-1] == cable.device.speed == 38400
    assert cable.device.unit.config_writes == 0


@pytest.mark.parametrize("start", [9600, 38400])
@pytest.mark.parametrize("phase", range(10))
def test_any_place_in_a_telegram_is_as_good(start: int, phase: int) -> None:
    cable = ready(start)
    cable.send(STREAM)
    cable.listen(1.0 + 0.0781 * phase)
    assert first_scan(cable, LmsClient(cable.now, SPEEDS)).far == pytest.approx(32.758)


@pytest.mark.parametrize("address", range(0x80, 0x85))
def test_any_address_answers(address: int) -> None:
    cable = ready(9600, address=address)
    first_scan(cable, LmsClient(cable.now, SPEEDS))


@pytest.mark.parametrize("delay", [0.3, 1.5, 2.9])
@pytest.mark.parametrize("streams", [False, True])
def test_late_answers_mislead_nobody(delay: float, streams: bool) -> None:
    cable = ready(19200, delays={CommandCode.MODE: delay})
    cable.device.unit.config = UnitConfig()
    if streams:
        cable.send(STREAM)
        cable.listen(delay + 1)
    # 20 25 while searching and after, 20 40, 20 00, 20 24: each waits for its answer
    events = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0 + 5 * delay)
    assert cable.device.unit.config == WRITTEN
    assert cable.device.unit.mode is OperatingMode.ALL_VALUES
    assert speeds(events)[-1] == cable.device.speed == 38400
    assert scans(events)[0].ranges == (2.0,) * 181


def test_an_answer_beyond_all_limits_is_not_taken_for_another() -> None:
    cable = Cable(LmsDevice(LMS200, delays={CommandCode.MODE: 4.0}))
    client = LmsClient(cable.now, (9600,), patience=Patience(give_up=20.0))
    events = run(cable, client, ScansLost, 60.0)
    assert cable.device.unit.config_writes == 0
    assert scans(events) == []


def test_a_slow_eeprom_is_waited_for() -> None:
    cable = Cable(LmsDevice(LMS200, delays={CommandCode.CONFIGURE: 7.0}))
    client = LmsClient(cable.now, SPEEDS)
    first_scan(cable, client, 10.0)
    assert cable.device.unit.config_writes == 1


@pytest.mark.parametrize("boot", [3.0, 58.0])
def test_a_unit_that_starts_is_found_when_it_is_ready(boot: float) -> None:
    cable = ready(9600, boot=boot)
    cable.device.switch_on(cable.now)
    client = LmsClient(cable.now, SPEEDS, patience=PATIENT)
    run(cable, client, Measured, boot + 3.0, step=0.005)


def test_the_configuration_is_written_once_and_its_rest_is_kept() -> None:
    cable = Cable(LmsDevice(LMS200))
    before = UnitConfig(stop_threshold=60, rest=bytes(range(25)))
    cable.device.unit.config = before
    events = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0)
    assert cable.device.unit.config == replace(before, measuring_mode=5, units=Units.MILLIMETRES)
    assert "it had mode 0 in centimetres" in remarks(events)
    again = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0)
    assert remarks(again) == ""
    assert cable.device.unit.config_writes == 1


def test_the_variant_is_set_only_if_it_differs() -> None:
    cable = ready()
    settings = ScanSettings(step=radians(0.5))
    client = LmsClient(cable.now, SPEEDS, settings)
    sent = b""
    while cable.device.unit.mode is not OperatingMode.ALL_VALUES:
        heard = cable.step()
        events = client.receive(heard, cable.now) + client.tick(cable.now)
        cable.speed = speeds(events)[-1] if speeds(events) else cable.speed
        out = client.outgoing()
        sent += out
        cable.send(out)
    assert encode(CommandCode.TYPE) in sent
    assert encode(CommandCode.VARIANT, commands.variant_data(Variant(180, 50))) not in sent
    assert encode(CommandCode.CONFIG) not in sent


def test_the_unit_says_who_it_is() -> None:
    cable = ready()
    events = run(cable, LmsClient(cable.now, SPEEDS), Identified, 3.0)
    (event,) = [event for event in events if isinstance(event, Identified)]
    assert event.identity.vendor == "SICK"
    assert event.identity.product == "LMS200-301061"
    assert event.identity.firmware == "V02.30"
    other = Cable(LmsDevice(LASERS["lms-291"]))
    events = run(other, LmsClient(other.now, SPEEDS), Identified, 3.0)
    (event,) = [event for event in events if isinstance(event, Identified)]
    assert event.identity.product == "LMS291-S05"


def test_500000_baud_is_taken_only_if_told() -> None:
    for target, speed, period in ((38400, 38400, 8 / 75), (500000, 500000, 1 / 75)):
        cable = ready(9600)
        client = LmsClient(cable.now, SPEEDS, target_speed=target)
        assert first_scan(cable, client).period == pytest.approx(period)
        assert cable.device.speed == speed


def test_a_link_without_speeds_changes_none() -> None:
    cable = ready(9600)
    cable.speed = None
    client = LmsClient(cable.now, (), round_trip=0.1)
    scan = first_scan(cable, client, 4.0)
    assert cable.device.speed == 9600
    assert scan.period == pytest.approx(30 / 75)  # it knows the speed from the status
    client.leave(cable.now)
    assert client.outgoing() == commands.mode(OperatingMode.ON_REQUEST)


def test_leaving_stops_the_stream_and_goes_back_to_9600() -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS)
    first_scan(cable, client)
    client.leave(cable.now)
    assert client.deadline == inf
    cable.send(client.outgoing())
    cable.listen(0.5)
    assert (cable.device.speed, cable.device.turn) == (9600, None)
    client.leave(cable.now)
    assert client.outgoing() == b""


def test_who_has_sent_nothing_leaves_in_silence() -> None:
    client = LmsClient(0.0, SPEEDS)
    client.leave(0.0)
    assert client.outgoing() == b""


def test_silence_loses_the_unit() -> None:
    cable = ready(38400)
    client = LmsClient(cable.now, SPEEDS)
    first_scan(cable, client)
    cable.device.switch_on(cable.now)
    began = cable.now
    (event,) = [e for e in run(cable, client, ScansLost, 2.0) if isinstance(e, ScansLost)]
    assert "no scan has come for 1.06667 s" in event.reason
    assert cable.now - began == pytest.approx(1.07, abs=0.12)
    assert client.tick(cable.now + 99) == []


def test_a_power_cycle_at_9600_is_noticed() -> None:
    cable = ready(9600, boot=0.1)
    client = LmsClient(cable.now, (9600,))
    first_scan(cable, client)
    cable.device.switch_on(cable.now)
    (event,) = [e for e in run(cable, client, ScansLost, 1.0) if isinstance(e, ScansLost)]
    assert "started anew" in event.reason


def test_an_empty_line_is_given_up() -> None:
    cable = ready(9600, boot=inf)
    cable.device.switch_on(cable.now)
    began = cable.now
    (event,) = [
        e
        for e in run(cable, LmsClient(cable.now, SPEEDS), ScansLost, 10.0)
        if isinstance(e, ScansLost)
    ]
    assert event.reason.startswith("nothing answers at 9600, 19200, 38400, 500000 baud")
    assert 8.0 <= cable.now - began < 9.0


def test_noise_is_told_from_silence() -> None:
    client = LmsClient(0.0, (9600,), patience=Patience(give_up=3.0))
    events: list[Event] = []
    now = 0.0
    while not any(isinstance(event, ScansLost) for event in events):
        now += 0.01
        events += client.receive(b"\x00\xff\x55", now) + client.tick(now)
    assert events[-1] == ScansLost("something sends, but not as an LMS-2xx does")


def test_a_speed_that_the_line_does_not_carry_is_given_up() -> None:
    cable = ready(9600)

    class Deaf(Cable):
        def send(self, data: bytes) -> None:
            if self.speed != 500000:
                super().send(data)

    deaf = Deaf(cable.device, 9600)
    client = LmsClient(deaf.now, (9600, 500000), target_speed=500000)
    (event,) = [e for e in run(deaf, client, ScansLost, 20.0) if isinstance(e, ScansLost)]
    assert "nothing answers" in event.reason  # the unit is deaf at 500000 now


def test_a_refused_variant_and_configuration_are_done_without() -> None:
    cable = ready(38400)
    unit = cable.device.unit
    unit.config = UnitConfig()
    answer = unit.answer

    def refuses(code: int, data: bytes) -> bytes | None:
        refused = code == CommandCode.VARIANT or data == bytes((0,)) + commands.PASSWORD
        return None if refused else answer(code, data)

    unit.answer = refuses  # type: ignore[method-assign]
    events = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0)
    told = remarks(events)
    assert "refuses 180 degrees in steps of 1 and goes on with 180 degrees in steps of 0.5" in told
    assert "refuses to be configured" in told
    scan = scans(events)[0]
    assert (len(scan.ranges), scan.ranges[0]) == (361, 2.0)
    assert scan.far == pytest.approx(81.82)


def test_a_variant_that_is_answered_too_late_is_asked_for_again() -> None:
    cable = ready(38400, delays={CommandCode.VARIANT: 1.5})
    scan = first_scan(cable, LmsClient(cable.now, (38400,)), 8.0)
    assert len(scan.ranges) == 181


def test_a_refused_speed_is_done_without() -> None:
    cable = Cable(LmsDevice(replace(LMS200, speeds=(9600, 19200))), 9600)
    events = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0)
    assert "refuses 38400 baud and stays at 9600" in remarks(events)
    assert cable.device.speed == 9600


def test_a_defect_is_told() -> None:
    cable = ready(38400)
    unit = cable.device.unit
    answer = unit.answer

    def defective(code: int, data: bytes) -> bytes | None:
        body = answer(code, data)
        if code == CommandCode.STATUS and body is not None:
            return replace(UnitStatus.from_bytes(body), defective=1).to_bytes()
        return body

    unit.answer = defective  # type: ignore[method-assign]
    events = run(cable, LmsClient(cable.now, SPEEDS), Measured, 3.0)
    assert "it is defective" in remarks(events)


def test_spoilt_requests_and_answers_cost_a_try() -> None:
    cable = ready(38400)
    spoil = [3, 8]  # requests of the set-up

    class Noisy(Cable):
        sent = 0

        def send(self, data: bytes) -> None:
            self.sent += bool(data)
            spoilt = data and self.sent in spoil
            super().send(data[:-1] + bytes((data[-1] ^ 1,)) if spoilt else data)

    noisy = Noisy(cable.device, 38400)
    first_scan(noisy, LmsClient(noisy.now, (38400,)))
    assert noisy.sent > 6
