"""The stick on the screen and the choice of what to drive with, on a phone with fingers."""

from collections.abc import Iterator
from functools import partial

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.drawn import repaint
from tests.browser.support import SLACK, Product, later, speed, until
from tests.browser.visit import Visit, visit

PHONES = {"upright": (320, 568), "on its side": (568, 320), "larger": (390, 844)}


@pytest.fixture
def phone(browser: Browser, product: Product) -> Iterator[Visit]:
    """Hold a phone with the page."""
    with visit(browser, product.address, size=(390, 844), phone=True) as phone:
        yield phone


def push(phone: Visit, forward: float, left: float = 0.0) -> tuple[float, float]:
    """Put a finger on the stick and move it, in parts of all the way; return where it is."""
    x, y = phone.middle("#stick")
    box = phone.page.locator("#stick").bounding_box()
    assert box is not None
    reach = 0.36 * min(box["width"], box["height"])
    phone.touch("touchStart", (x, y))
    phone.touch("touchMove", (x - left * reach, y - forward * reach))
    return x - left * reach, y - forward * reach


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
    push(phone, 1.0)
    until(lambda: speed(product) == pytest.approx(0.3))
    phone.touch("touchEnd")
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    push(phone, 0.5)
    until(lambda: speed(product) > 0.03)
    later(phone.page, 8)  # until the robot has that speed
    half = speed(product)
    assert 0.04 < half < 0.15  # gentle near the middle
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)
    assert {message.get("input") for message in phone.drives()} == {"touch"}


def test_the_stick_drives_the_way_it_points(phone: Visit, product: Product) -> None:
    body = product.simulation.body

    def goes(forward: int, left: int) -> bool:
        return body.speeds[0] * forward > 0.2 or body.speeds[1] * left > 0.4

    for forward, left in ((0, 1), (0, -1), (-1, 0)):
        push(phone, forward, left)
        until(partial(goes, forward, left))
        phone.touch("touchEnd")
        until(lambda: body.speeds == (0.0, 0.0))


def test_a_finger_that_comes_down_off_the_middle_moves_nothing_by_itself(
    phone: Visit, product: Product
) -> None:
    x, y = phone.middle("#stick")
    phone.touch("touchStart", (x + 40, y - 50))
    later(phone.page, 3)
    assert all(message["v"] == message["w"] == 0 for message in phone.drives())
    phone.touch("touchEnd")


def test_letting_go_sends_three_zeros_and_then_nothing(phone: Visit) -> None:
    push(phone, 1.0)
    until(lambda: 8 <= phone.rate() <= 20)  # 15 where the machine is not busy
    held = len(phone.drives())
    phone.touch("touchEnd")
    phone.sends_zeros("touch")
    later(phone.page)
    after = phone.drives()[held:]
    zeros = [m for m in after if m == {"type": "drive", "v": 0, "w": 0, "input": "touch"}]
    assert after[-3:] == zeros
    assert len(zeros) == 3


def test_the_knob_follows_the_finger_and_returns(phone: Visit) -> None:
    knob = phone.page.locator("#stick i")
    before = knob.bounding_box()
    assert before is not None
    push(phone, 1.0)
    until(lambda: (knob.bounding_box() or before)["y"] < before["y"] - 20)
    phone.touch("touchEnd")
    until(lambda: knob.bounding_box() == before)


def test_a_second_finger_elsewhere_does_not_disturb(phone: Visit, product: Product) -> None:
    finger = push(phone, 1.0)
    until(lambda: speed(product) > 0.25)
    x, y = phone.middle("#canvas")
    for step in range(5):  # pans the map
        phone.touch("touchMove" if step else "touchStart", finger, (x + 10 * step, y))
    phone.touch("touchMove", finger)  # lifts the other
    later(phone.page)
    assert phone.source == "touch"
    assert speed(product) > 0.25
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)


def test_a_second_finger_on_the_stick_does_not_disturb(phone: Visit, product: Product) -> None:
    finger = push(phone, 1.0)
    until(lambda: speed(product) > 0.25)
    x, y = phone.middle("#stick")
    phone.touch("touchStart", finger, (x + 30, y + 30))
    phone.touch("touchMove", finger, (x + 30, y + 60))
    phone.touch("touchMove", finger)  # lifts the other
    later(phone.page, 3)
    assert phone.source == "touch"
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)


@pytest.mark.parametrize("way", ["touchCancel", "blur", "orientationchange", "pagehide"])
def test_losing_the_finger_or_the_page_stops(phone: Visit, product: Product, way: str) -> None:
    push(phone, 1.0)
    until(lambda: speed(product) > 0.25)
    if way == "touchCancel":
        phone.touch(way)
    else:
        phone.page.evaluate("(name) => dispatchEvent(new Event(name))", way)
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    assert phone.source is None
    later(phone.page, 3)
    assert speed(product) == 0.0


def test_a_stopped_stick_must_be_touched_anew(phone: Visit, product: Product) -> None:
    x, y = push(phone, 1.0)
    until(lambda: speed(product) > 0.25)
    product.call(product.robot.stop)
    until(lambda: speed(product) == 0.0)
    later(phone.page, 3)
    phone.touch("touchMove", (x, y - 3))
    later(phone.page)
    assert phone.source is None
    assert speed(product) == 0.0
    phone.touch("touchEnd")
    push(phone, 1.0)
    until(lambda: speed(product) > 0.25)
    phone.touch("touchEnd")
    until(lambda: speed(product) == 0.0)


def test_the_stick_lets_go_when_somebody_takes_over(
    phone: Visit, browser: Browser, product: Product
) -> None:
    with visit(browser, product.address) as bob:
        push(phone, 1.0)
        until(lambda: speed(product) > 0.25)
        bob.page.click("#driver")
        bob.page.click("#lease-take-over")
        until(lambda: speed(product) == 0.0, 2.0)
        expect(phone.page.locator("#toast")).to_be_visible()
        bob.page.click("#lease-release")
        later(phone.page, 6)  # the finger is still out
        assert phone.source is None
        assert speed(product) == 0.0
        phone.touch("touchEnd")


def test_the_choice_between_stick_and_keys_is_remembered(page: Page, product: Product) -> None:
    assert page.locator("#keys").is_visible()
    page.click("#way-stick")
    assert page.locator("#stick").is_visible()
    assert not page.locator("#keys").is_visible()
    page.reload()
    expect(page.locator("#stick")).to_be_visible()


def test_a_mouse_drives_with_the_stick_too(page: Page, product: Product) -> None:
    page.click("#way-stick")
    box = page.locator("#stick").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 80)
    until(lambda: speed(product) > 0.25)
    page.mouse.up()
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
