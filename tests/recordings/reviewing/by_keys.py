"""Reviews decisions on the page of `report --interactive` in Chromium, by keys and a mouse.

    python by_keys.py PAGE.html SAVED.csv [PICTURES]

Needs playwright and a Chromium: its own, or the one on PATH.
"""

import pathlib
import shutil
import sys

from playwright.sync_api import sync_playwright

page_path, saved = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
pictures = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None


def picture(page, name):
    if pictures:
        pictures.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=str(pictures / f"{name}.png"))


with sync_playwright() as playwright:
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
    for scheme, size in [("dark", (1600, 900)), ("light", (1280, 720)), ("dark", (1280, 720))]:
        width, height = size
        context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme=scheme, accept_downloads=True
        )
        context.set_offline(True)
        page = context.new_page()
        errors, asked = [], []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(page_path.as_uri())
        picture(page, f"start-{scheme}-{width}")
        # Nothing sticks out at the side.
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        # By keys alone: the reviewer's name, then the first three decisions.
        page.keyboard.press("Tab")
        page.keyboard.type("Ann")
        page.keyboard.press("Escape")
        page.keyboard.press("r")
        page.keyboard.press("n")
        page.keyboard.type('a "wiggle", no reaction')
        page.keyboard.press("Escape")
        assert "rejected" in page.inner_text("#verdict")
        page.keyboard.press("ArrowRight")
        assert "decision 2 of" in page.inner_text("#progress"), "the first arrow moves"
        # The verdict and the buttons stay where they are: only the list scrolls.
        assert page.evaluate("scrollY") == 0
        assert page.evaluate("document.documentElement.scrollHeight <= innerHeight")
        page.keyboard.press("a")
        before = page.inner_text("#break")
        page.keyboard.press("]")
        assert page.inner_text("#break") != before, "the breakpoint moves"
        page.keyboard.press("o")
        assert "decision 3 of" in page.inner_text("#progress")
        # With the mouse: a breakpoint in the middle of the plot.
        box = page.locator("#plot").bounding_box()
        page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 60)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60)
        page.mouse.up()
        assert "your breakpoint" in page.inner_text("#break")
        assert "a word on 3" in page.inner_text("#progress")
        picture(page, f"reviewed-{scheme}-{width}")
        with page.expect_download() as download:
            page.keyboard.press("s")
        download.value.save_as(saved)
        assert "not saved" not in page.inner_text("#progress")
        # What was said is still there when the page is opened again.
        page.reload()
        assert "a word on 3" in page.inner_text("#progress")
        assert not errors, errors
        assert asked and all(url.startswith(("file:", "blob:")) for url in asked), asked
        context.close()
    browser.close()
