"""Whatever takes the page from its driver: the robot stops, and the page says what happened.

Times are the simulation's. The bar is 0.7 s; a shared machine may add a little.
"""

import functools
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Page, expect

from pioneer3.sim.server.start import simulator
from tests.browser.support import (
    SLACK,
    Product,
    hold,
    in_thread,
    later,
    speed,
    until,
    wait_for_the_robot,
)
from tests.browser.tabs import DESKTOP, PHONE, Tabs
from tests.browser.views import drive, stopped_after
from tests.browser.visit import visit
from tests.e2e.processes import free_port

BAR = 0.7 + SLACK
WATCHDOG = 2.0
"""Of the robot itself [s]."""


def still_stands(page: Page, product: Product) -> None:
    """Check that a key which was held all the time moves nothing."""
    later(page)
    assert speed(product) == 0.0


REASONS = {
    "blur": "Let go: the window lost the focus.",
    "pagehide": "Let go: the page was left.",
    "touchcancel": "Let go: the touch was taken away.",
    "orientationchange": "Let go: the screen turned.",
    "freeze": "Let go: the page was put to sleep.",
}


def test_the_page_says_why_it_let_go(page: Page, product: Product) -> None:
    for event, words in REASONS.items():
        drive(page, product)
        target = "document" if event == "freeze" else "window"
        act = f"{target}.dispatchEvent(new Event('{event}'))"
        assert stopped_after(product, functools.partial(page.evaluate, act)) < BAR, event
        expect(page.locator("#toast")).to_have_text(words)
        still_stands(page, product)
        page.keyboard.up("ArrowUp")


def test_another_tab_in_front_stops_the_robot(page: Page, product: Product) -> None:
    drive(page, product)
    hide = """() => {
        Object.defineProperty(document, "hidden", { value: true, configurable: true });
        document.dispatchEvent(new Event("visibilitychange"));
    }"""
    assert stopped_after(product, lambda: page.evaluate(hide)) < BAR
    expect(page.locator("#toast")).to_have_text("Let go: the page was hidden.")
    still_stands(page, product)


def test_a_touch_that_the_system_takes_away_stops_the_robot(tabs: Tabs, product: Product) -> None:
    with visit(tabs, product.address, size=PHONE, phone=True) as phone:
        phone.page.locator("#way-keys").tap()
        place = phone.middle("#pad-forward")

        def stops_in_time() -> bool:
            phone.touch_until(
                lambda: phone.touch("touchStart", place), lambda: speed(product) > 0.25
            )
            return stopped_after(product, lambda: phone.touch("touchCancel")) < BAR

        until(stops_in_time)  # a busy machine may bring the news of the finger late
        expect(phone.page.locator("#toast")).to_have_text("Let go: the touch was taken away.")


def test_a_device_that_goes_offline_stops_the_robot(page: Page, product: Product) -> None:
    drive(page, product)
    assert stopped_after(product, lambda: page.context.set_offline(True)) < BAR
    expect(page.locator("#toast")).to_have_text("Let go: this device has no network.")
    page.context.set_offline(False)
    until(lambda: page.evaluate("window.pioneer3.state.live"))
    still_stands(page, product)
    page.keyboard.up("ArrowUp")
    drive(page, product)
    page.keyboard.up("ArrowUp")


def _is_refused(page: Page) -> bool:
    """Press the key, and return whether the page says that somebody else has control."""
    page.keyboard.up("ArrowUp")
    page.keyboard.down("ArrowUp")
    later(page, 2)
    return "has control" in page.locator("#toast").inner_text()


def test_two_pages_that_fight_for_control_do_not_mix(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    drive(page, product)
    second.keyboard.down("ArrowDown")
    expect(second.locator("#toast")).to_contain_text("has control")
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)
    assert product.simulation.body.speeds[0] > 0.25
    second.keyboard.up("ArrowDown")
    second.locator("#driver").click()
    second.locator("#lease-take-over").click()
    until(lambda: speed(product) == 0.0)
    expect(page.locator("#toast")).to_contain_text("took over")
    still_stands(page, product)  # though the first still holds its key
    second.locator("#people-close").click()
    hold(second, "ArrowDown", lambda: product.simulation.body.speeds[0] < -0.25)
    until(lambda: _is_refused(page))  # and presses again, in vain
    hold(second, "ArrowDown", lambda: product.simulation.body.speeds[0] < -0.25)
    assert stopped_after(product, lambda: second.keyboard.press("Space")) < BAR


# the server ends


@contextmanager
def serving(robot: str, port: int) -> Iterator[subprocess.Popen[str]]:
    """Run `pioneer3 run` until it serves, and end it after the block."""
    command = [sys.executable, "-m", "pioneer3", "run", "--port", robot, "--web-port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ) as process:
        assert process.stdout is not None
        try:
            while "Drive it at" not in process.stdout.readline():
                assert process.poll() is None
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize(
    ("how", "bar"),
    [(signal.SIGTERM, BAR), (signal.SIGKILL, WATCHDOG + BAR)],
    ids=["ended", "killed"],
)
def test_a_server_that_ends_stops_the_robot_and_the_page_comes_back(
    tabs: Tabs, how: signal.Signals, bar: float
) -> None:
    """What is killed cannot stop the robot: its own watchdog does."""
    with in_thread(simulator(port=0)) as simulation, tabs.open(size=DESKTOP) as page:
        body, port = simulation.body, free_port()
        with serving(simulation.url, port) as server:
            page.goto(f"http://127.0.0.1:{port}")
            wait_for_the_robot(page)
            hold(page, "ArrowUp", lambda: body.speeds[0] > 0.25)
            began = simulation.world.time
            server.send_signal(how)
            until(lambda: body.speeds[0] == 0.0)
            assert simulation.world.time - began < bar
            expect(page.locator("#overlay-title")).to_have_text("Connection lost")
            expect(page.locator("#overlay-text")).to_contain_text("stops by itself")
            server.wait(10)
        with serving(simulation.url, port):
            until(lambda: page.evaluate("window.pioneer3.state.live"), 20.0)
            later(page)
            assert body.speeds[0] == 0.0  # the key that was held all the time
            page.keyboard.up("ArrowUp")
            hold(page, "ArrowUp", lambda: body.speeds[0] > 0.25)
            page.keyboard.up("ArrowUp")
