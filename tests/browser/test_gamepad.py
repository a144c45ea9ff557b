"""A gamepad at the page: deadman, turbo, stops, and every way of losing it."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from pioneer3.teleop.gamepad import SCHEME
from tests.browser.support import SLACK, Product, hold, later, speed, until
from tests.browser.visit import DEADMAN, ESTOP, RESET, STOP, TURBO, Visit, visit

FORWARD = (0.0, -1.0)


@pytest.fixture
def player(browser: Browser, product: Product) -> Iterator[Visit]:
    """Sit at the page with a gamepad that is plugged in."""
    with visit(browser, product.address) as player:
        player.plug()
        yield player


def go(player: Visit, product: Product) -> None:
    """Drive ahead until it goes."""
    player.stick(*FORWARD)
    player.button(DEADMAN)
    until(lambda: speed(product) > 0.3)


def stands(player: Visit, product: Product) -> None:
    """Check that the robot stops soon, and stays so although the stick is still out."""
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    later(player.page)
    assert speed(product) == 0.0
    assert player.source is None


def test_the_page_says_that_a_gamepad_is_there_and_what_to_hold(player: Visit) -> None:
    expect(player.page.locator("#gamepad")).to_have_text("Gamepad: hold L1")
    player.unplug()
    expect(player.page.locator("#gamepad")).to_be_hidden()


def test_the_stick_alone_moves_nothing(player: Visit, product: Product) -> None:
    player.stick(*FORWARD)
    later(player.page)
    assert player.drives() == []
    assert not product.simulation.body.drive.powered


def test_it_drives_while_the_deadman_is_held(player: Visit, product: Product) -> None:
    go(player, product)
    until(lambda: speed(product) == pytest.approx(SCHEME.speed))
    player.button(DEADMAN, pressed=False)
    stands(player, product)
    driven = player.drives()
    assert {message["input"] for message in driven} == {"gamepad"}
    assert driven[-3:] == [{"type": "drive", "v": 0, "w": 0, "input": "gamepad"}] * 3


def test_turbo_is_faster_and_needs_the_deadman_as_well(player: Visit, product: Product) -> None:
    player.stick(-1.0, 0.0)
    player.button(TURBO)
    later(player.page, 2)
    assert player.drives() == []
    player.button(DEADMAN)
    until(lambda: player.drives()[-1]["w"] == pytest.approx(SCHEME.turbo_turn_rate))
    player.button(TURBO, pressed=False)
    until(lambda: player.drives()[-1]["w"] == pytest.approx(SCHEME.turn_rate))
    player.button(DEADMAN, pressed=False)


@pytest.mark.parametrize(("x", "y"), [(0.09, -0.09), (-0.05, 0.0)])
def test_a_worn_stick_that_is_not_quite_in_the_middle_asks_for_nothing(
    player: Visit, x: float, y: float
) -> None:
    player.stick(x, y)
    player.button(DEADMAN)
    later(player.page, 3)
    assert all(message["v"] == message["w"] == 0 for message in player.drives())
    player.button(DEADMAN, pressed=False)


def test_its_stop_button_stops_while_the_deadman_is_held(player: Visit, product: Product) -> None:
    go(player, product)
    player.button(STOP)
    stands(player, product)
    player.button(STOP, pressed=False)
    player.button(DEADMAN, pressed=False)
    player.button(DEADMAN)
    until(lambda: speed(product) > 0.3)
    player.button(DEADMAN, pressed=False)


def test_its_emergency_stop_latches_until_reset(player: Visit, product: Product) -> None:
    go(player, product)
    player.button(ESTOP)
    expect(player.page.locator("#reset")).to_be_visible()
    stands(player, product)
    player.button(ESTOP, DEADMAN, pressed=False)
    player.button(RESET)
    expect(player.page.locator("#reset")).to_be_hidden()
    assert not product.simulation.body.drive.powered


@pytest.mark.parametrize("told", [True, False])
def test_a_gamepad_that_goes_is_a_release_and_is_said(
    player: Visit, product: Product, told: bool
) -> None:
    go(player, product)
    player.unplug(event=told)
    stands(player, product)
    expect(player.page.locator("#toast")).to_have_text("The gamepad is gone: the robot stops.")
    player.plug()  # with the button still held, it says
    player.button(DEADMAN)
    player.stick(*FORWARD)
    player.button(DEADMAN, pressed=False)
    player.button(DEADMAN)
    until(lambda: speed(product) > 0.3)
    player.button(DEADMAN, pressed=False)


def test_a_gamepad_that_comes_with_its_button_held_moves_nothing(
    player: Visit, product: Product
) -> None:
    player.unplug()
    player.page.evaluate(
        "() => { const buttons = Array.from({ length: 17 }, (_, n) => ({ pressed: n === 4 }));"
        " window.fakePads = [{ index: 0, id: 'Held', mapping: 'standard', connected: true,"
        " axes: [0, -1, 0, 0], buttons }];"
        " dispatchEvent(new Event('gamepadconnected')); }"
    )
    later(player.page)
    assert player.source is None
    assert speed(product) == 0.0


def test_a_gamepad_that_says_it_is_not_connected_counts_as_gone(
    player: Visit, product: Product
) -> None:
    go(player, product)
    player.page.evaluate("window.fakePads[0].connected = false")
    stands(player, product)


@pytest.mark.parametrize("event", ["blur", "pagehide"])
def test_losing_the_page_stops_and_wants_a_fresh_press(
    player: Visit, product: Product, event: str
) -> None:
    go(player, product)
    player.page.evaluate("(name) => dispatchEvent(new Event(name))", event)
    stands(player, product)


def test_a_hidden_page_stops(player: Visit, product: Product) -> None:
    go(player, product)
    player.page.evaluate(
        "() => { Object.defineProperty(document, 'hidden', { value: true, configurable: true });"
        " document.dispatchEvent(new Event('visibilitychange')); }"
    )
    stands(player, product)


def test_a_page_without_the_focus_does_not_listen_to_it(player: Visit, product: Product) -> None:
    player.page.evaluate("() => { document.hasFocus = () => false; }")
    player.stick(*FORWARD)
    player.button(DEADMAN)
    later(player.page)
    assert player.source is None
    assert speed(product) == 0.0


def test_sticks_that_are_not_read_any_more_end_by_themselves(
    player: Visit, product: Product
) -> None:
    """The page's timers go on, but the browser fails to say how the gamepad stands."""
    go(player, product)
    player.page.evaluate("() => { navigator.getGamepads = () => { throw new Error('gone'); }; }")
    assert until(lambda: speed(product) == 0.0) < 0.7 + SLACK
    assert player.source is None
    player.page.evaluate("() => { navigator.getGamepads = () => []; }")
    later(player.page, 1)
    assert set(player.complaints) == {"gone"}
    player.complaints.clear()


def test_one_of_an_unknown_layout_is_shown_and_not_used(browser: Browser, product: Product) -> None:
    with visit(browser, product.address) as player:
        player.plug("")
        expect(player.page.locator("#gamepad")).to_have_text("Gamepad of an unknown layout")
        player.stick(*FORWARD)
        player.button(*range(17))
        later(player.page, 3)
        assert player.drives() == []
        assert speed(product) == 0.0


def test_the_gamepad_goes_before_keys_and_leaves_none_behind(
    player: Visit, product: Product
) -> None:
    hold(player.page, "ArrowDown", lambda: product.simulation.body.speeds[0] < -0.25)
    player.stick(*FORWARD)
    player.button(DEADMAN)
    until(lambda: product.simulation.body.speeds[0] > 0.25)
    assert player.source == "gamepad"
    player.button(DEADMAN, pressed=False)
    stands(player, product)  # although the key is still held
    player.page.keyboard.up("ArrowDown")
    player.button(DEADMAN)
    until(lambda: speed(product) > 0.25)
    player.page.keyboard.down("ArrowDown")
    later(player.page, 3)
    assert player.source == "gamepad"
    assert product.simulation.body.speeds[0] > 0.25
    player.button(DEADMAN, pressed=False)
    stands(player, product)
    player.page.keyboard.up("ArrowDown")


def test_it_lets_go_when_somebody_takes_over(
    player: Visit, browser: Browser, product: Product
) -> None:
    with visit(browser, product.address) as bob:
        go(player, product)
        bob.page.click("#driver")
        bob.page.click("#lease-take-over")
        until(lambda: speed(product) == 0.0, 2.0)
        bob.page.click("#lease-release")
        later(player.page, 6)  # the button is still held
        assert player.source is None
        assert speed(product) == 0.0
