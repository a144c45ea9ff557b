"""Pairing, roles, and who drives, in real browsers."""

from pathlib import Path
from typing import Literal

import pytest
import zxingcpp
from playwright.sync_api import Page, expect

from pioneer3.maps.image import read_image
from pioneer3.web.access.sessions import Role
from pioneer3.web.api.routes import OPERATIONS
from tests.browser.sharing import come_in, invitation, needs_network, two, visiting
from tests.browser.support import Product, hold, later, speed, until, wait_for_the_robot
from tests.browser.tabs import Tabs
from tests.browser.views import drive, open_view

pytestmark = needs_network


def test_a_link_pairs_once_and_its_token_leaves_no_trace(tabs: Tabs, shared: Product) -> None:
    link = invitation(shared, Role.DRIVER)
    with visiting(tabs, link) as page:
        expect(page.locator("#form")).to_be_visible()
        assert "#" not in page.evaluate("location.href")
        come_in(page, "Ann")
        page.click("#driver")
        expect(page.locator("#people-you")).to_have_text("You are Ann, a driver.")
        assert page.evaluate("document.cookie") == ""
        page.go_back()
        assert link.partition("#")[2] not in page.evaluate("location.href")
    with visiting(tabs, link) as page:
        page.click("#drive")
        expect(page.locator("#lead")).to_contain_text("it was used")


def test_who_is_not_paired_is_told_how(tabs: Tabs, shared: Product) -> None:
    with visiting(tabs, shared.web.access.urls[0]) as page:
        page.wait_for_url("**/pair")
        expect(page.locator("#lead")).to_contain_text("not paired")


def test_a_viewer_cannot_drive_but_stops_the_robot(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.VIEWER, "Vera") as (ann, vera):
        vera.keyboard.down("ArrowUp")
        expect(vera.locator("#toast")).to_contain_text("You are a viewer")
        vera.keyboard.up("ArrowUp")
        expect(vera.locator("#motors")).to_be_disabled()
        for name in ("#edit", "#goto", "#pad-forward", "#stick", "#speed", ".knob"):
            expect(vera.locator(name)).to_be_hidden()
        expect(vera.locator("#why")).to_contain_text("You watch")
        vera.locator(".views [data-view=modes]").click()
        expect(vera.locator("#view-modes")).to_contain_text("No mode runs")
        expect(vera.locator("#wander-start")).to_be_hidden()
        vera.locator("#sheet-close").click()
        assert speed(shared) == 0.0
        drive(ann, shared)
        vera.click("#estop")
        until(lambda: speed(shared) == 0.0)
        expect(ann.locator("#reset")).to_be_visible()
        expect(vera.locator("#reset")).to_be_hidden()


def test_a_take_over_stops_the_robot_and_tells_who_drove(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.DRIVER, "Bob") as (ann, bob):
        drive(ann, shared)
        expect(bob.locator("#driver")).to_have_text("laptop drives")
        bob.click("#driver")
        bob.click("#lease-take-over")
        until(lambda: speed(shared) == 0.0)
        expect(ann.locator("#driver")).to_have_text("Bob has control")
        expect(ann.locator("#toast")).to_contain_text("Bob")
        hold(bob, "ArrowUp", lambda: speed(shared) > 0.25)  # while ann still holds her key
        expect(bob.locator("#driver")).to_have_text("You drive")
        bob.keyboard.up("ArrowUp")
        until(lambda: speed(shared) == 0.0)


def test_who_is_taken_over_in_a_mode_is_told_by_whom(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.DRIVER, "Bob") as (ann, bob):
        open_view(ann, "modes")
        ann.click("#wander-start")
        until(lambda: speed(shared) > 0.1)
        bob.click("#driver")
        bob.click("#lease-take-over")
        expect(ann.locator("#toast")).to_have_text("Bob took over; you watch now")
        expect(ann.locator("#view-modes .mode-state")).to_have_text("Wander ended: Bob took over.")
        expect(ann.locator("#why")).to_have_text("Bob has control.")
        later(ann)
        expect(ann.locator("#toast")).to_have_text("Bob took over; you watch now")


def test_an_invitation_to_watch_offers_no_more(tabs: Tabs, shared: Product) -> None:
    with visiting(tabs, invitation(shared, Role.VIEWER)) as vera:
        expect(vera.locator("#lead")).to_contain_text("invited to watch")
        expect(vera.locator("#drive")).to_be_hidden()
        vera.get_by_role("button", name="Watch").click()
        wait_for_the_robot(vera)
        expect(vera.locator("#driver")).to_have_text("You watch")
    with visiting(tabs, invitation(shared, Role.DRIVER)) as bob:
        expect(bob.locator("#lead")).to_contain_text("invited to drive")
        expect(bob.locator("#drive")).to_be_visible()
        expect(bob.locator("#watch")).to_be_visible()


def test_control_is_handed_over_by_name(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.DRIVER, "Bob") as (ann, bob):
        ann.click("#driver")
        ann.click("#lease-take")
        expect(ann.locator("#people-lease")).to_have_text("You have control.")
        expect(ann.locator("#driver")).to_have_text("You have control")
        ann.get_by_label("Hand control to Bob").click()
        expect(ann.locator("#people-lease")).to_have_text("Bob has control.")
        expect(bob.locator("#toast")).to_have_text("laptop has handed control to you")
        bob.click("#driver")
        bob.click("#lease-release")
        expect(ann.locator("#people-lease")).to_have_text("Nobody has control.")


def test_a_revoked_page_stops_the_robot_and_leads_to_pairing(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.DRIVER, "Bob") as (ann, bob):
        drive(bob, shared)
        ann.click("#driver")
        ann.get_by_label("Revoke Bob").click()
        until(lambda: speed(shared) == 0.0)
        bob.wait_for_url("**/pair")
        expect(ann.get_by_label("Revoke Bob")).to_have_count(0)


def test_the_page_of_this_computer_invites_with_a_code(tabs: Tabs, shared: Product) -> None:
    with visiting(tabs, shared.address) as ann:
        wait_for_the_robot(ann)
        ann.click("#driver")
        ann.click("#invite-viewer")
        code = ann.locator("#invitation svg")
        expect(code).to_be_visible()
        box = code.bounding_box()
        assert box is not None
        assert box["width"] == pytest.approx(box["height"], rel=0.02)
        link = ann.locator("#invitation code").inner_text()
        with visiting(tabs, link) as vera:
            come_in(vera, "Vera")
            assert "viewer" in (vera.locator("body").get_attribute("class") or "")


def test_the_code_on_the_screen_leads_to_the_invitation(
    tabs: Tabs, shared: Product, tmp_path: Path
) -> None:
    schemes: list[Literal["dark", "light"]] = ["dark", "light"]
    with visiting(tabs, shared.address) as page:
        wait_for_the_robot(page)
        page.click("#driver")
        page.click("#invite-driver")
        for width, height in ((1440, 900), (390, 844), (844, 390)):
            page.set_viewport_size({"width": width, "height": height})
            for scheme in schemes:
                page.emulate_media(color_scheme=scheme)
                assert_code_is_read(page, tmp_path / "screen.png")


def assert_code_is_read(page: Page, picture: Path) -> None:
    """Check that a camera reads the address that stands below the code."""
    page.locator("#invitation svg").scroll_into_view_if_needed()
    page.screenshot(path=picture)
    read = zxingcpp.read_barcodes(read_image(picture).shades)
    assert [code.text for code in read] == [page.locator("#invitation code").inner_text()]


def test_the_page_of_the_api_shows_every_operation(tabs: Tabs, shared: Product) -> None:
    with visiting(tabs, f"{shared.address}/api") as page:
        shown = page.locator("#operations summary")
        expect(shown).to_have_count(len(OPERATIONS))
        shown.filter(has_text="/driveDrive").click()
        expect(page.locator("details[open] pre")).to_contain_text("curl -X POST")
