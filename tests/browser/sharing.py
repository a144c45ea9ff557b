"""Browsers of several people at one page."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Page

from pioneer3.web.access.hosts import lan_addresses
from pioneer3.web.access.invitations import pairing_url
from pioneer3.web.access.sessions import Role
from tests.browser.support import Product, wait_for_the_robot
from tests.browser.tabs import Tabs

needs_network = pytest.mark.skipif(
    not lan_addresses("0.0.0.0"), reason="this machine has no network"
)


@contextmanager
def visiting(tabs: Tabs, url: str) -> Iterator[Page]:
    """Open `url` in a browser of its own."""
    with tabs.open(url, size=(1000, 700)) as page:
        yield page


@contextmanager
def two(tabs: Tabs, shared: Product, role: Role, name: str) -> Iterator[tuple[Page, Page]]:
    """Open the page on this computer, and elsewhere for somebody of that role and name."""
    with (
        visiting(tabs, shared.address) as here,
        visiting(tabs, invitation(shared, role)) as there,
    ):
        wait_for_the_robot(here)
        come_in(there, name)
        yield here, there


def invitation(shared: Product, role: Role) -> str:
    """Return a fresh address to pair at."""
    token = shared.call(lambda: shared.web.access.invitations.invite(role))
    return pairing_url(shared.web.access.urls[0], token, role)


def come_in(page: Page, name: str) -> None:
    """Pair, and wait for the robot."""
    page.fill("#name", name)
    page.click("#form button:visible >> nth=0")
    page.wait_for_url("**/")
    wait_for_the_robot(page)
