"""Driving by tilting a phone: the mathematics by hand, then the page."""

import json
from math import sqrt
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from pioneer3.web.access.hosts import lan_addresses
from pioneer3.web.access.sessions import Role
from tests.browser.bench import Bench
from tests.browser.hands import Hands
from tests.browser.support import SLACK, Product, later, running_product, speed, until
from tests.browser.tabs import PHONE, Tabs
from tests.browser.visit import visit

ADDRESS = next(iter(lan_addresses("0.0.0.0")), "")
FLAT = (0.0, 0.0, 0.0)
HEARD = 100
"""The sensor tells every 20 ms, and the page sends every 66 ms [ms]."""
ZEROS = [{"type": "drive", "v": 0, "w": 0, "input": "tilt"}] * 3
Angles = tuple[float, float, float]


def run(page: Page, module: str, expression: str) -> Any:
    """Return what an expression gives with `m`, a module of the page."""
    return page.evaluate(
        f"async () => {{ const m = await import('/static/{module}'); return {expression}; }}"
    )


def turned(page: Page, start: Angles, end: Angles, screen: int = 0) -> dict[str, float]:
    """Return tip, turn and flip [degrees] from one attitude to another."""
    a, b = (f"m.attitude(...{json.dumps(angles)})" for angles in (start, end))
    result = run(page, "drive/tilt.js", f"m.meaning(m.rotation({a}, {b}), {screen})")
    return {name: round(value, 6) + 0.0 for name, value in result.items()}


# By hand, from the W3C's rule: about z by alpha, then the new x by beta, then the new y by gamma.
# Beta lifts the far edge, gamma pushes the right edge down, alpha turns to the left.
BY_HAND = {
    "nothing": (FLAT, FLAT, 0, (0, 0, 0)),
    "far edge down": (FLAT, (0, -20, 0), 0, (20, 0, 0)),
    "far edge up": (FLAT, (0, 20, 0), 0, (-20, 0, 0)),
    "to the left": (FLAT, (30, 0, 0), 0, (0, 30, 0)),
    "to the right, past north": ((10, 0, 0), (350, 0, 0), 0, (0, -20, 0)),
    "right edge down": (FLAT, (0, 0, 25), 0, (0, 0, 25)),
    "upright: beta and alpha are as good as flat": ((0, 45, 0), (0, 30, 0), 0, (15, 0, 0)),
    # at beta 90 the new y is the vertical: gamma turns about it exactly as alpha does
    "the gimbal's lock is no turn": ((20, 90, 0), (0, 90, 20), 0, (0, 0, 0)),
    # each attitude has a second triple: alpha + 180, 180 - beta, gamma + 180
    "the same in other angles": ((0, 80, 0), (180, 100, 180), 0, (0, 0, 0)),
    "over the top of the lock": ((0, 85, 0), (180, 75, 180), 0, (-20, 0, 0)),
    # standing upright, a turn about the vertical is about the phone's own long axis: a flip
    "upright, about the vertical": ((0, 90, 0), (40, 90, 0), 0, (0, 0, 40)),
    # leaning back by 45 degrees, half of a small turn about the vertical is a turn, half a flip
    "leaning, about the vertical": ((0, 45, 0), (2, 45, 0), 0, (0, sqrt(2), sqrt(2))),
    # phone's top to the left: the far edge is the phone's right one, gamma pushes it down
    "landscape, far edge down": (FLAT, (0, 0, 20), 90, (20, 0, 0)),
    # the left edge is the phone's top, beta lifts it
    "landscape, left edge up": (FLAT, (0, 20, 0), 90, (0, 0, 20)),
    "landscape, to the left": (FLAT, (20, 0, 0), 90, (0, 20, 0)),
    "landscape the other way, far edge down": (FLAT, (0, 0, -20), 270, (20, 0, 0)),
    "upside down, far edge down": (FLAT, (0, 20, 0), 180, (20, 0, 0)),
}


def test_turns_are_what_they_are_by_hand(desk_bench: Bench) -> None:
    for name, (start, end, screen, expected) in BY_HAND.items():
        got = turned(desk_bench.page, start, end, screen)
        assert tuple(got.values()) == pytest.approx(expected, abs=1e-3), name


def test_a_phone_that_is_turned_as_a_whole_means_the_same(desk_bench: Bench) -> None:
    """Which way somebody faces changes nothing: alpha is added at both ends."""
    for heading in range(0, 360, 45):
        got = turned(desk_bench.page, (heading, 30, 5), (heading, 10, 5))
        assert tuple(got.values()) == pytest.approx(
            tuple(turned(desk_bench.page, (0, 30, 5), (0, 10, 5)).values()), abs=1e-6
        )


def test_small_changes_of_angles_are_small_turns_everywhere(desk_bench: Bench) -> None:
    for beta in (-179, -91, -90, -89, 0, 89, 90, 91, 179):
        for gamma in (-89, -45, 0, 45, 89):
            step = turned(desk_bench.page, (123, beta, gamma), (123.1, beta + 0.1, gamma - 0.1))
            assert max(map(abs, step.values())) < 0.31


def test_five_degrees_are_nothing_and_a_flip_is_a_stop(desk_bench: Bench) -> None:
    commands = (
        ([4.9, 0, 4.9], {"forward": 0, "left": 0}),
        ([-40, 0, 0], {"forward": 1, "left": 0}),
        ([40, 0, 0], {"forward": -1, "left": 0}),
        ([-80, 0, 0], {"forward": 1, "left": 0}),
        ([0, 0, 50], {"forward": 0, "left": 1}),
        ([0, 61, 0], None),
        ([0, -61, 0], None),
        ([-125, 0, 0], None),
    )
    for vector, command in commands:
        got = run(desk_bench.page, "drive/tilt.js", f"m.commandOf({vector}, 0)")
        assert got == (None if command is None else pytest.approx(command)), vector


def test_the_response_is_even_monotonic_and_bounded(desk_bench: Bench) -> None:
    values = [n / 50 for n in range(-60, 61)]
    for dead, gentle in ((0.1, 0), (0.12, 0.6), (0.125, 0.3)):
        got = run(
            desk_bench.page,
            "drive/stick.js",
            f"{values}.map((v) => m.response(v, {dead}, {gentle}))",
        )
        assert got == sorted(got)
        assert got == pytest.approx([-value for value in reversed(got)])
        assert (got[0], got[-1]) == (-1, 1)
        assert all(out == 0 for value, out in zip(values, got, strict=True) if abs(value) <= dead)
    nothing = run(
        desk_bench.page, "drive/stick.js", "[NaN, undefined, 'x'].map((v) => m.response(v, 0.1))"
    )
    assert nothing == [0, 0, 0]


@pytest.fixture
def bench(phone_bench: Bench) -> Bench:
    """Hold a phone flat, with the inputs of the page and tilting chosen."""
    choose(phone_bench)
    phone_bench.turn_phone(*FLAT)
    phone_bench.wait(HEARD)
    return phone_bench


def choose(hands: Hands) -> None:
    """Choose tilting."""
    hands.page.tap("#way-tilt")
    expect(hands.page.locator("#tilt-hold")).to_be_visible()


def hold(hands: Hands) -> None:
    """Put a finger on the button."""
    hands.touch("touchStart", hands.middle("#tilt-hold"))


def turn(bench: Bench, *angles: float) -> None:
    """Turn the phone, and wait until it has sent what that means."""
    bench.turn_phone(*angles)
    bench.wait(HEARD)


def go(bench: Bench) -> None:
    """Hold the button and tip the phone."""
    turn(bench, *FLAT)
    hold(bench)
    turn(bench, 0, -45, 0)
    assert bench.source == "tilt"
    assert bench.asks() == pytest.approx((0.3, 0.0))


def assert_over(bench: Bench, *, stopped: bool = True) -> None:
    """Check that a stop was sent last, or three zeros, and nothing more however the phone tips."""
    sent = bench.sent
    assert sent[-1]["type"] == "stop" if stopped else sent[-3:] == ZEROS
    turn(bench, 0, -45, 0)
    bench.wait(1000)
    assert bench.sent == sent
    assert bench.source is None


def test_tilting_without_the_button_moves_nothing(bench: Bench) -> None:
    turn(bench, 0, -40, 0)
    assert bench.sent == []


def test_each_way_of_turning_the_phone_drives_its_way(bench: Bench) -> None:
    ways = {
        (0.0, -45.0, 0.0): (0.3, 0.0),
        (0.0, 45.0, 0.0): (-0.3, 0.0),
        (45.0, 0.0, 0.0): (0.0, 0.6),
        (315.0, 0.0, 0.0): (0.0, -0.6),
    }
    for angles, wanted in ways.items():
        turn(bench, *FLAT)
        hold(bench)
        turn(bench, *angles)
        assert bench.asks() == pytest.approx(wanted)
        bench.touch("touchEnd")
        bench.wait(300)
        assert bench.sent[-3:] == ZEROS


def test_the_pose_at_the_press_is_the_reference(bench: Bench) -> None:
    turn(bench, 200, 50, 10)
    hold(bench)
    turn(bench, 200, 52, 10)
    assert all(message["v"] == message["w"] == 0 for message in bench.sent)
    turn(bench, 200, 5, 10)
    assert bench.asks()[0] == pytest.approx(0.3)
    bench.touch("touchEnd")


def test_a_flip_stops_until_the_button_is_held_anew(bench: Bench) -> None:
    go(bench)
    turn(bench, 0, 0, 80)
    assert bench.told == ["Flipped: the robot stops."]
    assert_over(bench)
    bench.touch("touchEnd")
    go(bench)


def test_a_sensor_that_falls_silent_is_a_release(bench: Bench) -> None:
    go(bench)
    bench.turn_phone()
    bench.wait(1200)  # its life of 15 periods, and three zeros
    assert_over(bench, stopped=False)  # it is back, but the finger has not been lifted
    bench.touch("touchEnd")


@pytest.mark.parametrize("event", ["orientationchange", "blur", "pagehide"])
def test_losing_the_page_or_turning_the_screen_stops(bench: Bench, event: str) -> None:
    go(bench)
    bench.tell(event)
    assert_over(bench)
    bench.touch("touchEnd")


def test_a_finger_that_is_taken_away_stops(bench: Bench) -> None:
    go(bench)
    bench.touch("touchCancel")
    assert_over(bench)


def test_a_device_without_the_sensor_says_so(phone_bench: Bench) -> None:
    choose(phone_bench)
    hold(phone_bench)
    assert "sensor of this device is silent" in phone_bench.told[0]
    phone_bench.touch("touchEnd")
    assert phone_bench.sent == []


@pytest.mark.parametrize("answer", ["granted", "denied"])
def test_an_iphone_is_asked_inside_the_tap(phone_bench: Bench, answer: str) -> None:
    page = phone_bench.page
    page.evaluate(
        "(answer) => { DeviceOrientationEvent.requestPermission = async () => {"
        " window.asked = navigator.userActivation.isActive; return answer; }; }",
        answer,
    )
    assert page.evaluate("window.asked === undefined")
    page.tap("#way-tilt")
    granted = answer == "granted"
    expect(page.locator("#tilt-hold")).to_be_visible(visible=granted)
    expect(page.locator("#tilt-why")).to_be_visible(visible=not granted)
    assert page.evaluate("window.asked") is True


# with the whole of it


def test_tipping_drives_and_letting_go_stops(tabs: Tabs, product: Product) -> None:
    with visit(tabs, product.address, size=PHONE, phone=True) as phone:
        choose(phone)

        def press() -> None:
            phone.turn_phone(*FLAT)
            later(phone.page, 1)  # the sensor has said so
            hold(phone)
            phone.turn_phone(0, -45, 0)

        phone.touch_until(press, lambda: speed(product) == pytest.approx(0.3))
        assert phone.source == "tilt"
        phone.touch("touchEnd")
        assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
        phone.sends_zeros("tilt")


@pytest.mark.skipif(not ADDRESS, reason="this machine has no network")
def test_without_https_it_says_so_and_leads_there(tabs: Tabs) -> None:
    with running_product(host="0.0.0.0") as shared:
        access = shared.web.access
        secure = f"https://{ADDRESS}:8081"
        access.urls = (*access.urls, secure)
        token = shared.call(lambda: access.invitations.invite(Role.DRIVER))
        link = f"{access.urls[0]}/pair#{token}"
        with tabs.open(link, size=PHONE, touch=True, mobile=True) as page:
            page.click("#drive")
            page.wait_for_url("**/")
            page.tap("#way-tilt")
            why = page.locator("#tilt-why")
            expect(why).to_contain_text("needs https")
            assert why.get_by_role("link").first.get_attribute("href") == secure
            assert why.get_by_role("link").nth(1).get_attribute("href") == "/ca.crt"
            assert not page.locator("#tilt-hold").is_visible()
