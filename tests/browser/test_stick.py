"""The stick on the screen and the choice of what to drive with, on a phone with fingers."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from tests.browser.bench import Bench
from tests.browser.drawn import repaint
from tests.browser.support import SLACK, Product, later, speed, until
from tests.browser.tabs import PHONE, Tabs
from tests.browser.visit import Visit, visit

PHONES = {"upright": (320, 568), "on its side": (568, 320), "larger": (390, 844)}
PERIOD = 66
"""Between two requests while the stick is held [ms]."""
ZERO = {"type": "drive", "v": 0, "w": 0, "input": "touch"}


def test_the_stick_drives_the_way_it_points(phone_bench: Bench) -> None:
    ways = {(1, 0): (0.3, 0.0), (0, 1): (0.0, 0.6), (0, -1): (0.0, -0.6), (-1, 0): (-0.3, 0.0)}
    for (forward, left), wanted in ways.items():
        phone_bench.push(forward, left)
        phone_bench.wait(PERIOD)
        assert phone_bench.asks() == pytest.approx(wanted, abs=1e-3)
        phone_bench.touch("touchEnd")
        phone_bench.wait(PERIOD)
        assert phone_bench.sent[-1] == ZERO


def test_a_finger_that_comes_down_off_the_middle_moves_nothing_by_itself(
    phone_bench: Bench,
) -> None:
    x, y = phone_bench.middle("#stick")
    phone_bench.touch("touchStart", (x + 40, y - 50))
    phone_bench.wait(300)
    assert phone_bench.source == "touch"
    assert all(message["v"] == message["w"] == 0 for message in phone_bench.sent)
    phone_bench.touch("touchEnd")


def test_the_stick_sends_15_times_a_second_and_three_zeros_at_the_end(phone_bench: Bench) -> None:
    phone_bench.push(1.0)
    phone_bench.wait(15 * PERIOD)
    assert phone_bench.sent[0] == ZERO
    ahead = phone_bench.sent[2:]  # first with the finger where it came down
    assert len(ahead) == 15
    assert [message["v"] for message in ahead] == pytest.approx([0.3] * 15, abs=1e-3)
    phone_bench.touch("touchEnd")
    phone_bench.wait(1000)
    assert phone_bench.sent[17:] == [ZERO] * 3


def test_the_knob_follows_the_finger_and_returns(phone_bench: Bench) -> None:
    knob = phone_bench.page.locator("#stick i")
    before = knob.bounding_box()
    assert before is not None
    phone_bench.push(1.0)
    until(lambda: (knob.bounding_box() or before)["y"] < before["y"] - 20)
    phone_bench.touch("touchEnd")
    until(lambda: knob.bounding_box() == before)


def test_a_second_finger_on_the_stick_does_not_disturb(phone_bench: Bench) -> None:
    finger = phone_bench.push(1.0)
    x, y = phone_bench.middle("#stick")
    phone_bench.touch("touchStart", finger, (x + 30, y + 30))
    phone_bench.touch("touchMove", finger, (x + 30, y + 60))
    phone_bench.touch("touchMove", finger)  # lifts the other
    phone_bench.wait(300)
    assert phone_bench.source == "touch"
    assert phone_bench.asks() == pytest.approx((0.3, 0.0), abs=1e-3)
    phone_bench.touch("touchEnd")
    assert phone_bench.source is None


@pytest.mark.parametrize("way", ["touchCancel", "blur", "orientationchange", "pagehide"])
def test_losing_the_finger_or_the_page_stops(phone_bench: Bench, way: str) -> None:
    phone_bench.push(1.0)
    phone_bench.wait(PERIOD)
    assert phone_bench.asks() == pytest.approx((0.3, 0.0), abs=1e-3)
    if way == "touchCancel":
        phone_bench.touch(way)
    else:
        phone_bench.tell(way)
    sent = phone_bench.sent
    assert sent[-1] == {"type": "stop"}
    phone_bench.wait(1000)
    assert phone_bench.sent == sent
    assert phone_bench.source is None


def test_a_mouse_drives_with_the_stick_too(desk_bench: Bench) -> None:
    page = desk_bench.page
    page.click("#way-stick")
    x, y = desk_bench.middle("#stick")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 80)
    desk_bench.wait(PERIOD)
    assert desk_bench.asks() == pytest.approx((0.3, 0.0), abs=1e-3)
    page.mouse.up()
    desk_bench.wait(PERIOD)
    assert desk_bench.sent[-1] == ZERO


def test_the_choice_between_stick_and_keys_is_remembered(desk_bench: Bench) -> None:
    page = desk_bench.page
    assert page.locator("#keys").is_visible()
    page.click("#way-stick")
    assert page.locator("#stick").is_visible()
    assert not page.locator("#keys").is_visible()
    page.reload()
    expect(page.locator("#stick")).to_be_visible()


# with the whole of it


@pytest.fixture
def phone(tabs: Tabs, product: Product) -> Iterator[Visit]:
    """Hold a phone with the page."""
    with visit(tabs, product.address, size=PHONE, phone=True) as phone:
        yield phone


def test_everything_fits_and_nothing_covers_the_stops(phone: Visit) -> None:
    for size in PHONES.values():
        phone.page.set_viewport_size({"width": size[0], "height": size[1]})
        repaint(phone.page)
        for name in ("#stick", "#stop", "#estop", "#way-stick", "#way-keys", "#way-tilt"):
            box = phone.page.locator(name).bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["y"] >= 0
            assert box["x"] + box["width"] <= size[0]
            assert box["y"] + box["height"] <= size[1]
            x, y = phone.middle(name)
            assert phone.page.evaluate(
                "([x, y, name]) => document.elementFromPoint(x, y).closest(name) !== null",
                [x, y, name],
            )
        stick = phone.page.locator("#stick").bounding_box()
        assert stick is not None
        assert min(stick["width"], stick["height"]) >= 100


def test_the_stick_drives_in_proportion_up_to_the_sliders(phone: Visit, product: Product) -> None:
    phone.push_until(1.0, lambda: speed(product) == pytest.approx(0.3))
    phone.touch("touchEnd")
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    phone.push_until(0.5, lambda: 0.04 < speed(product) < 0.15)  # gentle near the middle
    later(phone.page, 8)
    assert speed(product) < 0.15
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)
    assert {message.get("input") for message in phone.drives()} <= {"touch", None}  # or a stop


def test_a_second_finger_elsewhere_does_not_disturb(phone: Visit, product: Product) -> None:
    def holds_while_the_map_is_panned() -> bool:
        finger = phone.push_until(1.0, lambda: speed(product) > 0.25)
        x, y = phone.middle("#canvas")
        before = phone.page.evaluate("window.pioneer3.state.camera.x")
        for step in range(5):
            phone.touch("touchMove" if step else "touchStart", finger, (x + 10 * step, y))
        phone.touch("touchMove", finger)  # lifts the other
        later(phone.page)
        assert phone.page.evaluate("window.pioneer3.state.camera.x") != before
        held = phone.source == "touch" and speed(product) > 0.25
        phone.touch("touchEnd")
        return held

    until(holds_while_the_map_is_panned)  # not at once where the page has no news meanwhile
    until(lambda: speed(product) == 0.0)


def test_a_stopped_stick_must_be_touched_anew(phone: Visit, product: Product) -> None:
    x, y = phone.push_until(1.0, lambda: speed(product) > 0.25)
    product.call(product.robot.stop)
    until(lambda: speed(product) == 0.0)
    later(phone.page, 3)
    phone.touch("touchMove", (x, y - 3))
    later(phone.page)
    assert phone.source is None
    assert speed(product) == 0.0
    phone.touch("touchEnd")
    phone.push_until(1.0, lambda: speed(product) > 0.25)
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)


def test_the_stick_lets_go_when_somebody_takes_over(
    phone: Visit, tabs: Tabs, product: Product
) -> None:
    with visit(tabs, product.address) as bob:
        phone.push_until(1.0, lambda: speed(product) > 0.25)
        bob.page.click("#driver")
        bob.page.click("#lease-take-over")
        until(lambda: speed(product) == 0.0)
        expect(phone.page.locator("#toast")).to_be_visible()
        bob.page.click("#lease-release")
        later(phone.page, 6)  # the finger is still out
        assert phone.source is None
        assert speed(product) == 0.0
        phone.touch("touchEnd")
