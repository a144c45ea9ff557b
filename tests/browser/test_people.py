"""Pairing, roles, and who drives, in real browsers."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, Page, expect

from pioneer3.web.access.addresses import lan_addresses
from pioneer3.web.access.role import Role
from pioneer3.web.api.routes import OPERATIONS
from tests.browser.conftest import Product, running_product, wait_for_the_robot
from tests.browser.test_page import speed, until

ADDRESS = next(iter(lan_addresses("0.0.0.0")), "")
pytestmark = pytest.mark.skipif(not ADDRESS, reason="this machine has no network")


@pytest.fixture
def shared() -> Iterator[Product]:
    """Run the product on every address."""
    with running_product(host="0.0.0.0") as product:
        yield product


@contextmanager
def visiting(browser: Browser, url: str) -> Iterator[Page]:
    """Open `url` in a browser of its own."""
    context = browser.new_context(viewport={"width": 1000, "height": 700})
    page = context.new_page()
    page.goto(url)
    yield page
    context.close()


def invitation(shared: Product, role: Role) -> str:
    """Return a fresh address to pair at."""
    token = shared.call(lambda: shared.web.access.invitations.invite(role))
    return f"{shared.web.access.urls[0]}/pair#{token}"


def come_in(page: Page, name: str) -> None:
    """Pair, and wait for the robot."""
    page.fill("#name", name)
    page.click("#drive")
    page.wait_for_url("**/")
    wait_for_the_robot(page)


def drive(page: Page, shared: Product) -> None:
    """Hold the arrow until the robot drives."""
    page.keyboard.down("ArrowUp")
    until(lambda: speed(shared) > 0.25)


def test_a_link_pairs_once_and_its_token_leaves_no_trace(browser: Browser, shared: Product) -> None:
    link = invitation(shared, Role.DRIVER)
    with visiting(browser, link) as page:
        expect(page.locator("#form")).to_be_visible()
        assert "#" not in page.evaluate("location.href")
        come_in(page, "Ann")
        page.click("#driver")
        expect(page.locator("#people-you")).to_have_text("You are Ann, a driver.")
        assert page.evaluate("document.cookie") == ""
        page.go_back()
        assert link.partition("#")[2] not in page.evaluate("location.href")
    with visiting(browser, link) as page:
        page.click("#drive")
        expect(page.locator("#lead")).to_contain_text("it was used")


def test_who_is_not_paired_is_told_how(browser: Browser, shared: Product) -> None:
    with visiting(browser, shared.web.access.urls[0]) as page:
        page.wait_for_url("**/pair")
        expect(page.locator("#lead")).to_contain_text("not paired")


def test_a_viewer_cannot_drive_but_stops_the_robot(browser: Browser, shared: Product) -> None:
    with (
        visiting(browser, shared.address) as ann,
        visiting(browser, invitation(shared, Role.VIEWER)) as vera,
    ):
        wait_for_the_robot(ann)
        come_in(vera, "Vera")
        vera.keyboard.down("ArrowUp")
        expect(vera.locator("#toast")).to_contain_text("You are a viewer")
        vera.keyboard.up("ArrowUp")
        expect(vera.locator("#motors")).to_be_disabled()
        expect(vera.locator("#edit")).to_be_hidden()
        assert speed(shared) == 0.0
        drive(ann, shared)
        vera.click("#estop")
        until(lambda: speed(shared) == 0.0, 2.0)
        expect(ann.locator("#reset")).to_be_visible()
        expect(vera.locator("#reset")).to_be_hidden()


def test_a_take_over_stops_the_robot_and_tells_who_drove(browser: Browser, shared: Product) -> None:
    with (
        visiting(browser, shared.address) as ann,
        visiting(browser, invitation(shared, Role.DRIVER)) as bob,
    ):
        wait_for_the_robot(ann)
        come_in(bob, "Bob")
        drive(ann, shared)
        expect(bob.locator("#driver")).to_have_text("laptop drives")
        bob.click("#driver")
        bob.click("#wheel-over")
        until(lambda: speed(shared) == 0.0, 2.0)
        expect(ann.locator("#driver")).to_have_text("Bob has the wheel")
        expect(ann.locator("#toast")).to_contain_text("Bob")
        bob.keyboard.down("ArrowUp")  # while ann still holds her key
        until(lambda: speed(shared) > 0.25)
        expect(bob.locator("#driver")).to_have_text("You drive")
        bob.keyboard.up("ArrowUp")
        until(lambda: speed(shared) == 0.0, 2.0)


def test_the_wheel_is_handed_over_by_name(browser: Browser, shared: Product) -> None:
    with (
        visiting(browser, shared.address) as ann,
        visiting(browser, invitation(shared, Role.DRIVER)) as bob,
    ):
        wait_for_the_robot(ann)
        come_in(bob, "Bob")
        ann.click("#driver")
        ann.click("#wheel-take")
        expect(ann.locator("#people-wheel")).to_have_text("You have the wheel.")
        ann.get_by_label("Hand the wheel to Bob").click()
        expect(ann.locator("#people-wheel")).to_have_text("Bob has the wheel.")
        expect(bob.locator("#toast")).to_have_text("laptop has handed you the wheel")
        bob.click("#driver")
        bob.click("#wheel-leave")
        expect(ann.locator("#people-wheel")).to_have_text("The wheel is free.")


def test_a_revoked_page_stops_the_robot_and_leads_to_pairing(
    browser: Browser, shared: Product
) -> None:
    with (
        visiting(browser, shared.address) as ann,
        visiting(browser, invitation(shared, Role.DRIVER)) as bob,
    ):
        wait_for_the_robot(ann)
        come_in(bob, "Bob")
        drive(bob, shared)
        ann.click("#driver")
        ann.get_by_label("Revoke Bob").click()
        until(lambda: speed(shared) == 0.0, 2.0)
        bob.wait_for_url("**/pair")
        expect(ann.get_by_label("Revoke Bob")).to_have_count(0)


def test_the_page_of_this_computer_invites_with_a_code(browser: Browser, shared: Product) -> None:
    with visiting(browser, shared.address) as ann:
        wait_for_the_robot(ann)
        ann.click("#driver")
        ann.click("#invite-viewer")
        code = ann.locator("#invitation svg")
        expect(code).to_be_visible()
        box = code.bounding_box()
        assert box is not None
        assert box["width"] == pytest.approx(box["height"], rel=0.02)
        link = ann.locator("#invitation code").inner_text()
        with visiting(browser, link) as vera:
            come_in(vera, "Vera")
            assert "viewer" in (vera.locator("body").get_attribute("class") or "")


def test_the_page_of_the_api_shows_every_operation(browser: Browser, shared: Product) -> None:
    with visiting(browser, f"{shared.address}/api") as page:
        shown = page.locator("#operations summary")
        expect(shown).to_have_count(len(OPERATIONS))
        shown.filter(has_text="/drive").click()
        expect(page.locator("details[open] pre")).to_contain_text("curl -X POST")
