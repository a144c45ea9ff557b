"""The rules of a bridge: who has the robot, who watches, and what stops it."""

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import encode
from pioneer3.bridge.client import BridgeClient
from tests.support import frame
from tests.unit.bridge.rig import IDENTITY, FakePort, Rig, payloads

GO = commands.Vel(speed=0.3)
ON = commands.Enable(on=True)


def driving(rig: Rig) -> tuple[FakePort, BridgeClient]:
    port, client = rig.open_host("first")
    rig.say(client, ON, GO)
    rig.wait(0.2)
    assert rig.speed_mm == 300
    return port, client


def test_all_hosts_get_the_robots_own_identity() -> None:
    rig = Rig()
    for name in ("first", "second"):
        port, _ = rig.open_host(name)
        answers = [reports.from_payload(payload) for payload in payloads(port.received)[:3]]
        assert answers[:2] == [reports.SyncEcho(0), reports.SyncEcho(1)]
        assert isinstance(answers[2], reports.SyncIdentity)
        assert answers[2].name == IDENTITY.name


def test_the_robot_is_not_disturbed_until_a_host_shakes_hands() -> None:
    rig = Rig()
    port, client = rig.host("scanner")
    rig.send(client, b"GET / HTTP/1.0\r\n\r\n")
    rig.wait(5)
    assert rig.commands == []
    assert rig.relay.holder is None
    rig.wait(6)
    assert port.closed


def test_the_holders_packets_arrive_as_they_are() -> None:
    rig = Rig()
    _, client = rig.open_host("first")
    before = len(rig.commands)
    odd = [commands.from_payload(bytes([200, 0x2B, 3, 1, 2, 3])), commands.Sonar(on=True), ON, GO]
    rig.say(client, *odd)
    assert rig.since(before) == odd


def test_a_watcher_gets_reports_and_cannot_drive() -> None:
    rig = Rig()
    driving(rig)
    before = len(rig.commands)
    port, watcher = rig.open_host("second")
    rig.say(watcher, commands.Vel(speed=-0.2), commands.Enable(on=False), commands.Pulse())
    rig.say(watcher, commands.Sonar(on=False), commands.Move(distance=1.0), commands.SetO())
    rig.wait(0.5)
    assert rig.since(before) == []
    assert any(payload[0] in {0x32, 0x33} for payload in payloads(port.received))


def test_a_watcher_may_ask_for_the_settings() -> None:
    rig = Rig()
    rig.open_host("first")
    before = len(rig.commands)
    port, watcher = rig.open_host("second")
    rig.say(watcher, *[commands.RequestConfig()] * 50)
    assert rig.since(before) == [commands.RequestConfig()]
    assert any(payload[0] == 0x20 for payload in payloads(port.received))


@pytest.mark.parametrize("stop", [commands.Stop(), commands.EStop()])
def test_a_stop_of_a_watcher_takes_the_power_and_holds_back_the_holder(
    stop: commands.Command,
) -> None:
    rig = Rig()
    _, holder = driving(rig)
    _, watcher = rig.open_host("teacher")
    rig.say(watcher, stop)
    assert rig.speed_mm == 0
    for _ in range(20):
        rig.say(holder, GO)
        rig.wait(0.1)
    assert (rig.speed_mm, rig.motors) == (0, False)
    rig.say(holder, ON, GO)
    assert (rig.speed_mm, rig.motors) == (300, True)


def test_an_enable_that_was_under_way_does_not_lift_a_stop() -> None:
    rig = Rig()
    _, holder = driving(rig)
    _, watcher = rig.open_host("teacher")
    rig.say(watcher, commands.Stop())
    rig.say(holder, ON, GO)
    rig.wait(1.0)
    assert (rig.speed_mm, rig.motors) == (0, False)


def test_the_stops_at_the_ends_of_a_watchers_session_are_routine() -> None:
    rig = Rig()
    driving(rig)
    before = len(rig.commands)
    _, watcher = rig.open_host("monitor")
    rig.say(watcher, commands.Stop(), commands.Enable(on=False), commands.RequestConfig())
    rig.say(watcher, commands.Stop(), commands.SetV(speed=0.7), commands.Sonar(on=True))
    rig.say(watcher, commands.Stop(), commands.Enable(on=False), commands.Close())
    rig.wait(0.3)
    assert commands.Stop() not in rig.since(before)
    assert rig.speed_mm == 300


def test_a_stop_counts_with_other_packets_of_a_driver_behind_it() -> None:
    rig = Rig()
    driving(rig)
    _, watcher = rig.open_host("teacher")
    rig.say(watcher, commands.Stop(), commands.SetA(acceleration=0.3), commands.Enable(on=False))
    assert rig.speed_mm == 0


def test_a_stop_counts_if_it_comes_in_one_piece_with_the_beginning_of_a_session() -> None:
    rig = Rig()
    driving(rig)
    _, watcher = rig.open_host("teacher")
    rig.say(watcher, commands.Stop(), commands.Sonar(on=True), commands.Stop())
    assert rig.speed_mm == 0


def test_when_the_holder_leaves_the_robot_stops_and_watchers_are_disconnected() -> None:
    rig = Rig()
    _, holder = driving(rig)
    port, _ = rig.open_host("second")
    rig.relay.leave(holder, rig.now)
    rig.exchange()
    assert rig.speed_mm == 0
    assert port.closed
    rig.wait(0.5)
    assert rig.commands[-1] == commands.Close()
    assert not rig.motors
    _, second = rig.open_host("second")
    assert rig.relay.holder is second


def test_the_power_is_taken_from_a_robot_that_stands_only() -> None:
    rig = Rig()
    _, holder = driving(rig)
    before = len(rig.commands)
    rig.brakes = False
    rig.relay.leave(holder, rig.now)
    rig.exchange()
    rig.wait(0.8)  # it does not stop at once
    assert commands.Enable(on=False) not in rig.since(before)
    assert rig.since(before).count(commands.Stop()) > 2
    rig.wait(0.5)
    assert commands.Enable(on=False) in rig.since(before)


def test_a_host_gives_way_to_another_one_but_not_to_its_like() -> None:
    rig = Rig()
    page, _ = rig.open_host("page", gives_way=True)
    other, _ = rig.open_host("other page", gives_way=True)
    assert rig.relay.holder is not None
    assert rig.relay.holder.port is page
    student, _ = rig.open_host("student")
    assert page.closed
    assert other.closed
    assert rig.relay.holder.port is student
    assert rig.relay.holder.is_open


def test_a_holder_that_acknowledges_nothing_is_cut_off() -> None:
    rig = Rig()
    _, holder = driving(rig)
    rig.say(holder, GO)
    began = rig.now
    while rig.speed_mm > 0:
        rig.wait(0.05)
        rig.relay.unacknowledged(1000, 90, rig.now)
        rig.exchange()
        assert rig.now < began + 0.6
    assert rig.now - began >= 0.5
    assert rig.told[-1].endswith("is cut off; the robot stops")
    rig.say(holder, GO)
    rig.wait(0.2)
    rig.say(holder, GO)
    assert rig.speed_mm == 0  # these may be from before
    rig.wait(0.2)
    rig.say(holder, GO)
    assert rig.speed_mm == 300


def test_a_quiet_holder_that_acknowledges_is_not_stopped() -> None:
    rig = Rig()
    _, holder = driving(rig)
    for round_ in range(40):
        rig.wait(0.05)
        rig.relay.unacknowledged(1000 * round_, 90, rig.now)
        if round_ % 20 == 0:  # once a second: ARIA's longest silence is shorter
            rig.say(holder, commands.Pulse())
    assert rig.speed_mm == 300


def test_a_silent_holder_is_stopped_once_and_drives_on_with_its_next_command() -> None:
    rig = Rig()
    _, holder = driving(rig)
    before = len(rig.commands)
    rig.wait(1.2)
    assert rig.speed_mm == 300
    rig.wait(5)
    assert rig.since(before) == [commands.Stop()]
    rig.say(holder, GO)
    assert rig.speed_mm == 300


def test_both_can_be_switched_off() -> None:
    rig = Rig(expiry=0, silence=0)
    driving(rig)
    for _ in range(100):
        rig.wait(0.1)
        rig.relay.unacknowledged(1000, 90, rig.now)
    assert rig.speed_mm == 300


def test_a_stop_of_this_program_stops_and_the_next_command_counts() -> None:
    rig = Rig()
    _, holder = driving(rig)
    rig.relay.stop("the teacher put the robot back", rig.now)
    rig.exchange()
    assert rig.speed_mm == 0
    rig.wait(0.5)
    rig.say(holder, GO)
    assert rig.speed_mm == 300


def test_a_pause_stops_and_withholds_until_a_command_after_it() -> None:
    rig = Rig()
    _, holder = driving(rig)
    rig.relay.pause(rig.now, on=True)
    rig.exchange()
    assert rig.speed_mm == 0
    rig.say(holder, GO, commands.Sonar(on=True))
    assert rig.speed_mm == 0
    assert rig.commands[-1] == commands.Sonar(on=True)
    rig.relay.pause(rig.now, on=False)
    rig.wait(1.0)
    assert rig.speed_mm == 0
    rig.say(holder, GO)
    assert rig.speed_mm == 300


def test_a_pause_holds_for_the_next_holder_too() -> None:
    rig = Rig()
    rig.relay.pause(rig.now, on=True)
    _, holder = rig.open_host("first")
    rig.say(holder, ON, GO)
    assert rig.speed_mm == 0


def test_too_many_hosts_are_turned_away() -> None:
    rig = Rig()
    for number in range(9):
        rig.open_host(str(number))
    late = FakePort("late")
    assert rig.relay.join(late, rig.now) is None
    assert late.closed


def test_a_stop_goes_before_what_waits_and_motion_that_waits_is_dropped() -> None:
    rig = Rig()
    _, holder = rig.open_host("first")
    _, watcher = rig.open_host("second")
    rig.relay.receive(holder, frame(commands.Sonar(on=True)) + frame(GO), rig.now)
    rig.relay.receive(watcher, frame(commands.Stop()), rig.now)
    waiting = [commands.from_payload(p) for p in payloads(rig.relay.robot.outgoing())]
    assert waiting == [commands.Stop(), commands.Sonar(on=True)]


def test_a_robot_that_does_not_answer_disconnects_its_host() -> None:
    rig = Rig()
    rig.device.receive = lambda data, now: []  # type: ignore[method-assign]
    port, client = rig.host("first")
    rig.send(client, b"".join(encode(bytes([number])) for number in (0, 1, 2)))
    rig.wait(13)
    assert port.closed
    assert any("nothing answers" in told for told in rig.told)
