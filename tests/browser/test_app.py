"""The page on a home screen: what it is called, how it looks, and that it never drives when old."""

from urllib.parse import urlparse

from playwright.sync_api import Page, expect

from tests.browser.support import Product, later, running_product, wait_for_the_robot
from tests.browser.tabs import Tabs

ON_HOME_SCREEN = "Object.defineProperty(navigator, 'standalone', { value: true })"


def test_browsers_find_nothing_wrong_with_the_manifest(page: Page, product: Product) -> None:
    browser = page.context.new_cdp_session(page)
    manifest = browser.send("Page.getAppManifest")
    assert manifest["errors"] == []
    assert manifest["url"] == f"{product.address}/app.webmanifest"
    errors = browser.send("Page.getInstallabilityErrors")["installabilityErrors"]
    assert {error["errorId"] for error in errors} <= {"in-incognito"}  # as every test is


def test_icons_are_as_large_as_the_manifest_says(page: Page) -> None:
    sizes = page.evaluate(
        """async () => {
          const { icons } = await (await fetch("/app.webmanifest")).json();
          const touch = document.querySelector("link[rel=apple-touch-icon]").getAttribute("href");
          const all = [...icons, { src: touch, sizes: "180x180" }];
          const drawn = all.filter(({ sizes }) => sizes !== "any");
          return Promise.all(drawn.map(async ({ src, sizes }) => {
            const image = new Image();
            image.src = src;
            await image.decode();
            return [`${image.naturalWidth}x${image.naturalHeight}`, sizes];
          }));
        }"""
    )
    assert len(sizes) == 4
    assert all(real == said for real, said in sizes)


def test_a_browser_gets_no_worker(page: Page) -> None:
    later(page, 2)
    assert (
        page.evaluate("navigator.serviceWorker.getRegistrations().then((all) => all.length)") == 0
    )


def test_without_the_driver_the_app_says_so_and_comes_back_with_it(tabs: Tabs) -> None:
    with tabs.open(scripts=ON_HOME_SCREEN) as page:
        assert_it_comes_back(page)


def assert_it_comes_back(page: Page) -> None:
    """End the driver, and start it again."""
    with running_product() as product:
        page.goto(product.address)
        wait_for_the_robot(page)
        page.evaluate("navigator.serviceWorker.ready.then(() => null)")
        assert page.evaluate("caches.keys()") == []
    page.goto(product.address)
    expect(page.get_by_role("heading")).to_have_text("Not connected")
    assert page.evaluate("document.scripts.length") == 0
    assert page.evaluate("window.pioneer3 === undefined")
    with running_product(port=urlparse(product.address).port or 0):
        expect(page.locator("#badge")).to_have_text("SIMULATOR", timeout=15000)  # by itself
        wait_for_the_robot(page)
        assert page.evaluate("caches.keys()") == []


def test_what_a_home_screen_needs_is_never_kept(page: Page, product: Product) -> None:
    kinds = {
        "/app.webmanifest": "application/manifest+json",
        "/worker.js": "text/javascript",
        "/static/app/icon-512.png": "image/png",
    }
    for path, kind in kinds.items():
        answer = page.request.get(f"{product.address}{path}")
        assert answer.status == 200
        assert answer.headers["content-type"].split(";")[0] == kind
        assert answer.headers["cache-control"] == "no-cache"
        assert "default-src 'self'" in answer.headers["content-security-policy"]
