"""A gamepad at the page: deadman, turbo, stops, and every way of losing it."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Error, expect

from pioneer3.teleop.gamepad import SCHEME
from tests.browser.bench import Bench
from tests.browser.hands import DEADMAN, ESTOP, RESET, STOP, TURBO
from tests.browser.support import SLACK, Product, later, speed, until
from tests.browser.tabs import Tabs
from tests.browser.visit import Visit, visit

FORWARD = (0.0, -1.0)
ZEROS = [{"type": "drive", "v": 0, "w": 0, "input": "gamepad"}] * 3
PERIOD = 66
"""Between two requests while the deadman is held [ms]."""
RELEASE = 5 * PERIOD
"""Longest time of the zeros of a release, and of the life of an input that is not moved [ms]."""


@pytest.fixture
def bench(desk_bench: Bench) -> Bench:
    """Sit at the inputs of the page with a gamepad that is plugged in."""
    desk_bench.plug()
    return desk_bench


def ahead(bench: Bench) -> None:
    """Drive ahead."""
    bench.stick(*FORWARD)
    bench.button(DEADMAN)
    bench.wait(100)
    assert bench.source == "gamepad"
    assert bench.asks() == pytest.approx((SCHEME.speed, 0.0))


def assert_over(bench: Bench, *, stopped: bool = False) -> None:
    """Check that the last thing sent was a stop, or the zeros of a release, whatever is held."""
    bench.wait(RELEASE)
    sent = bench.sent
    assert sent[-3:] == ZEROS if not stopped else sent[-1]["type"] == "stop"
    bench.wait(1000)
    assert bench.sent == sent
    assert bench.source is None


def test_the_page_says_that_a_gamepad_is_there_and_what_to_hold(bench: Bench) -> None:
    expect(bench.page.locator("#gamepad")).to_have_text("Gamepad: hold L1")
    bench.unplug()
    expect(bench.page.locator("#gamepad")).to_be_hidden()


def test_the_stick_alone_moves_nothing(bench: Bench) -> None:
    bench.stick(*FORWARD)
    bench.wait(500)
    assert bench.sent == []


def test_turbo_is_faster_and_needs_the_deadman_as_well(bench: Bench) -> None:
    bench.stick(-1.0, 0.0)
    bench.button(TURBO)
    bench.wait(200)
    assert bench.sent == []
    bench.button(DEADMAN)
    bench.wait(100)
    assert bench.asks() == pytest.approx((0.0, SCHEME.turbo_turn_rate))
    bench.button(TURBO, pressed=False)
    bench.wait(100)
    assert bench.asks() == pytest.approx((0.0, SCHEME.turn_rate))


@pytest.mark.parametrize(("x", "y"), [(0.09, -0.09), (-0.05, 0.0)])
def test_a_worn_stick_that_is_not_quite_in_the_middle_asks_for_nothing(
    bench: Bench, x: float, y: float
) -> None:
    bench.stick(x, y)
    bench.button(DEADMAN)
    bench.wait(300)
    assert bench.source == "gamepad"
    assert all(message["v"] == message["w"] == 0 for message in bench.sent)


def test_its_stop_button_stops_while_the_deadman_is_held(bench: Bench) -> None:
    ahead(bench)
    bench.button(STOP)
    assert_over(bench, stopped=True)
    bench.button(STOP, pressed=False)
    bench.button(DEADMAN, pressed=False)
    ahead(bench)


@pytest.mark.parametrize("told", [True, False])
def test_a_gamepad_that_goes_is_a_release_and_is_said(bench: Bench, told: bool) -> None:
    ahead(bench)
    bench.unplug(event=told)
    assert_over(bench)
    assert bench.told == ["The gamepad is gone: the robot stops."]
    bench.plug("standard", DEADMAN)  # with the button still held, it says
    bench.stick(*FORWARD)
    bench.wait(300)
    assert bench.source is None
    bench.button(DEADMAN, pressed=False)
    ahead(bench)


def test_a_gamepad_that_comes_with_its_button_held_moves_nothing(desk_bench: Bench) -> None:
    desk_bench.plug("standard", DEADMAN)
    desk_bench.stick(*FORWARD)
    desk_bench.wait(500)
    assert desk_bench.source is None
    assert desk_bench.sent == []


def test_a_gamepad_that_says_it_is_not_connected_counts_as_gone(bench: Bench) -> None:
    ahead(bench)
    bench.page.evaluate("window.fakePads[0].connected = false")
    assert_over(bench)


@pytest.mark.parametrize("event", ["blur", "pagehide"])
def test_losing_the_page_stops_and_wants_a_fresh_press(bench: Bench, event: str) -> None:
    ahead(bench)
    bench.tell(event)
    assert_over(bench, stopped=True)
    bench.button(DEADMAN, pressed=False)
    ahead(bench)


def test_a_hidden_page_stops(bench: Bench) -> None:
    ahead(bench)
    bench.hide()
    assert_over(bench, stopped=True)


def test_a_page_without_the_focus_does_not_listen_to_it(bench: Bench) -> None:
    bench.page.evaluate("() => { document.hasFocus = () => false; }")
    bench.stick(*FORWARD)
    bench.button(DEADMAN)
    bench.wait(500)
    assert bench.source is None
    assert bench.sent == []


def test_sticks_that_are_not_read_any_more_end_by_themselves(bench: Bench) -> None:
    """The browser no longer tells how the gamepad stands."""
    ahead(bench)
    bench.page.evaluate("() => { navigator.getGamepads = () => { throw new Error('gone'); }; }")
    with pytest.raises(Error, match="gone"):  # all timers have run by then
        bench.wait(RELEASE + 3 * PERIOD)
    bench.page.evaluate("() => { navigator.getGamepads = () => []; }")
    assert_over(bench)


def test_one_of_an_unknown_layout_is_shown_and_not_used(desk_bench: Bench) -> None:
    desk_bench.plug("")
    expect(desk_bench.page.locator("#gamepad")).to_have_text("Gamepad of an unknown layout")
    desk_bench.stick(*FORWARD)
    desk_bench.button(*range(17))
    desk_bench.wait(300)
    assert desk_bench.sent == []


def test_the_gamepad_goes_before_keys_and_leaves_none_behind(bench: Bench) -> None:
    keyboard = bench.page.keyboard
    keyboard.down("ArrowDown")
    bench.wait(100)
    assert bench.asks() == (-0.3, 0.0)
    ahead(bench)
    bench.button(DEADMAN, pressed=False)
    assert_over(bench)  # although the key is still held
    keyboard.up("ArrowDown")
    ahead(bench)
    keyboard.down("ArrowDown")
    bench.wait(300)
    assert bench.source == "gamepad"
    assert bench.asks()[0] > 0
    bench.button(DEADMAN, pressed=False)
    assert_over(bench)


# with the whole of it


@pytest.fixture
def player(tabs: Tabs, product: Product) -> Iterator[Visit]:
    """Sit at the page of a robot with a gamepad that is plugged in."""
    with visit(tabs, product.address) as player:
        player.plug()
        yield player


def go(player: Visit, product: Product) -> None:
    """Drive ahead until it goes; a busy page may refuse or release, as `hold` in `support` says."""
    player.stick(*FORWARD)

    def held() -> bool:
        if player.source is None:
            player.button(DEADMAN, pressed=False)
            player.button(DEADMAN)
        return speed(product) > 0.3

    until(held)


def stands(player: Visit, product: Product) -> None:
    """Check that the robot stops soon, and stays so although the stick is still out."""
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    later(player.page)
    assert speed(product) == 0.0
    assert player.source is None


def test_it_drives_while_the_deadman_is_held(player: Visit, product: Product) -> None:
    player.stick(*FORWARD)
    later(player.page)
    assert player.drives() == []
    assert not product.simulation.body.drive.powered
    go(player, product)
    until(lambda: speed(product) == pytest.approx(SCHEME.speed))
    player.button(DEADMAN, pressed=False)
    stands(player, product)
    driven = player.drives()
    assert {message["input"] for message in driven} == {"gamepad"}
    assert driven[-3:] == ZEROS


def test_its_emergency_stop_latches_until_reset(player: Visit, product: Product) -> None:
    go(player, product)
    player.button(ESTOP)
    expect(player.page.locator("#reset")).to_be_visible()
    stands(player, product)
    player.button(ESTOP, DEADMAN, pressed=False)
    player.button(RESET)
    expect(player.page.locator("#reset")).to_be_hidden()
    assert not product.simulation.body.drive.powered


def test_it_lets_go_when_somebody_takes_over(player: Visit, tabs: Tabs, product: Product) -> None:
    with visit(tabs, product.address) as bob:
        go(player, product)
        bob.page.click("#driver")
        bob.page.click("#lease-take-over")
        until(lambda: speed(product) == 0.0)
        bob.page.click("#lease-release")
        later(player.page, 6)  # the button is still held
        assert player.source is None
        assert speed(product) == 0.0
