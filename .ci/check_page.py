"""The page in a real browser: submit an example, see it, turn it, print it.

usage: check_page.py BASE_URL FOLDER_FOR_PICTURES
"""

import sys
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import expect, sync_playwright

FLAGS = [
    "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-quic", "--no-first-run",
]
COLOURS = """() => {
    const canvas = document.getElementById('canvas'), gl = canvas.getContext('webgl2');
    const bytes = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return new Set(new Uint32Array(bytes.buffer)).size;
}"""
OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


def until(page, condition):
    """Waits for a condition; the page's policy forbids Playwright's own way, which is eval."""
    for _ in range(200):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(100)
    raise AssertionError(condition)


def check(page, base, folder):
    page.goto(base + "/")
    expect(page.get_by_text("No jobs yet: try an example.")).to_be_visible()
    page.get_by_role("button", name="Submit the example").click()
    row = page.locator("#rows tr").first
    expect(row).to_contain_text("successful", timeout=120_000)
    page.screenshot(path=folder / "list.png")
    row.get_by_role("link").click()
    expect(page.locator("#downloads li").first).to_be_visible()
    expect(page.locator("#legend")).to_be_visible()
    until(page, f"({COLOURS})() > 50")
    expect(page.locator("#summary li").first).to_be_visible()
    until(page, "document.getElementById('picture').naturalWidth > 0")
    page.screenshot(path=folder / "view.png", full_page=True)

    canvas = page.locator("#canvas")
    before = canvas.screenshot()
    canvas.focus()
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.wait_for_timeout(200)
    assert canvas.screenshot() != before, "an arrow key turns nothing"
    box = canvas.bounding_box()
    found = False
    for share in (0.3, 0.4, 0.5, 0.6, 0.7):
        page.mouse.move(box["x"] + box["width"] * share, box["y"] + box["height"] * 0.5)
        found = found or "twist" in page.locator("#under").inner_text()
    assert found, "no value under the pointer"
    expect(page.locator("#limit")).to_contain_text("limit 6°")
    files(page)

    page.set_viewport_size({"width": 360, "height": 740})
    page.wait_for_timeout(200)
    page.screenshot(path=folder / "small.png", full_page=True)
    assert page.evaluate(OVERFLOW) <= 0, "the small window scrolls sideways"
    page.set_viewport_size({"width": 1000, "height": 1400})
    page.emulate_media(media="print")
    page.screenshot(path=folder / "print.png", full_page=True)
    assert not page.locator("#canvas").is_visible(), "the print shows the canvas"
    page.emulate_media(media="screen", color_scheme="dark")
    page.screenshot(path=folder / "dark.png", full_page=True)


def files(page):
    """The list of files, by unit and by part."""
    link = page.locator("#downloads a", has_text="result.obj")
    page.locator("#units").select_option("mm")
    assert link.get_attribute("href").endswith("result.obj?units=mm"), link.get_attribute("href")
    page.locator("#units").select_option("")
    assert link.get_attribute("href").endswith("result.obj"), link.get_attribute("href")
    page.locator("#parts summary").click()
    expect(page.locator("#pieces a", has_text="plate-1.glb")).to_be_visible()


def others(page, base, folder):
    """The other methods: coloured by their own quantity, with or without a limit."""
    for example, quantity, limit in (
        ("bent_plate", "distance", True), ("bilge_grid", "deviation", True),
        ("vault", "normal deviation", False), ("half_circle", None, False),
    ):
        page.goto(base + "/")
        page.locator("#example").select_option(example)
        page.get_by_role("button", name="Submit the example").click()
        row = page.locator("#rows tr").first
        expect(row).to_contain_text("successful", timeout=120_000)
        row.get_by_role("link").click()
        expect(page.locator("#downloads li").first).to_be_visible()
        until(page, "document.getElementById('picture').naturalWidth > 0")
        if quantity is None:
            expect(page.locator("#space")).to_be_hidden()
            assert page.locator("#downloads a", has_text="glb").count() == 0
            continue
        expect(page.locator("#quantity")).to_have_text(f"{quantity} 0")
        assert page.locator("#limit").inner_text().startswith("limit") == limit, example
        until(page, f"({COLOURS})() > 50")
        page.screenshot(path=folder / f"{example}.png", full_page=True)


def main():
    base, folder = sys.argv[1].rstrip("/"), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    said, asked = [], set()
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.on("console", lambda m: said.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda e: said.append(str(e)))
        page.on("request", lambda r: asked.add(urlsplit(r.url).netloc))
        try:
            check(page, base, folder)
            page.emulate_media(media="screen", color_scheme="light")
            page.set_viewport_size({"width": 1280, "height": 900})
            others(page, base, folder)
        finally:
            print("\n".join(said), file=sys.stderr)
            browser.close()
    assert not said, said
    assert asked == {urlsplit(base).netloc}, asked
    print("the page works")


if __name__ == "__main__":
    main()
