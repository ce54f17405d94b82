"""The pages in a real browser, opened from disk: no network, no error, and everything that moves moves."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

playwright = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CHROMIUM = os.environ.get("ELBOWSCREW_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
TRIAL_MOST_BYTES = 6_000_000
STATE = "document.getElementById('viewer').dataset"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        launched = started.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)
        yield launched
        launched.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[Any]:
    """Open a page from disk; in the end it must have complained of nothing and asked nobody for anything."""
    complaints: list[str] = []
    contexts = []

    def refuse(dialog: Any) -> None:
        complaints.append(f"dialog: {dialog.message}")
        dialog.dismiss()

    def opened(path: Path, **options: Any) -> Any:
        context = browser.new_context(**options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("dialog", refuse)
        page.on("request", lambda request: complaints.append(request.url) if request.url != path.as_uri() else None)
        page.goto(path.as_uri())
        return page

    yield opened
    for context in contexts:
        context.close()
    assert complaints == []


def viewer(page: Any) -> dict[str, str]:
    """What the view in space says of itself, once it has drawn."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return dict(page.evaluate(f"({{...{STATE}}})"))


def until(page: Any, condition: Callable[[dict[str, str]], bool]) -> dict[str, str]:
    """Wait for a state of the view; the page's policy forbids the browser to evaluate text of ours by itself."""
    end = time.monotonic() + 20.0
    while not condition(state := viewer(page)):
        assert time.monotonic() < end, state
    return state


def ink(page: Any) -> int:
    """Pixels of the canvas with something on them."""
    return int(
        page.evaluate(
            "(() => { const space = document.getElementById('space'); const c = document.createElement('canvas');"
            "c.width = space.width; c.height = space.height;"
            "const x = c.getContext('2d', {willReadFrequently: true}); x.drawImage(space, 0, 0);"
            "const d = x.getImageData(0, 0, c.width, c.height).data;"
            "let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; return n; })()"
        )
    )


def test_a_trials_page_opens_and_is_small(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html")
    assert page.title().endswith("elbowscrew")
    assert page.locator("svg.chart").count() >= 5
    assert page.locator("table").count() >= 5
    assert 0 < (result / "report.html").stat().st_size < TRIAL_MOST_BYTES
    assert ink(page) > 2000


def test_the_view_turns_by_mouse_and_by_keys(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html")
    before = viewer(page)
    page.locator("#space").scroll_into_view_if_needed()
    box = page.locator("#space").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 90, middle[1] + 20, steps=4)
    page.mouse.up()
    dragged = viewer(page)
    assert dragged["view"] != before["view"]
    page.locator("#space").press("ArrowLeft")
    turned = viewer(page)
    assert turned["view"] != dragged["view"]
    page.locator("#space").press("+")
    assert float(viewer(page)["zoom"]) > float(turned["zoom"])
    page.get_by_role("button", name="End-on").click()
    end_on = [float(number) for number in viewer(page)["view"].split()]
    direction = page.evaluate("JSON.parse(document.getElementById('data').textContent).direction")
    assert end_on[6:] == pytest.approx(direction, abs=1e-3)  # the joint's axis points at who looks
    rows = [end_on[k : k + 3] for k in (0, 3, 6)]
    for j, row in enumerate(rows):
        for k, other in enumerate(rows):
            assert sum(a * b for a, b in zip(row, other, strict=True)) == pytest.approx(float(j == k), abs=1e-3)


def test_the_view_plays_pauses_and_goes_to_a_frame_by_keyboard(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html")
    scrub = page.locator("#scrub")
    scrub.focus()
    scrub.press("Home")
    assert viewer(page)["frame"] == "0"
    scrub.press("ArrowRight")
    assert viewer(page)["frame"] == "1"
    assert page.locator("#readout").inner_text().startswith("Frame 1 ·")
    play = page.locator("#play")
    play.focus()
    play.press("Enter")
    assert viewer(page)["playing"] == "true"
    until(page, lambda state: int(state["frame"]) > 5)
    assert play.inner_text() == "Pause"
    play.press("Enter")
    stopped = viewer(page)
    assert stopped["playing"] == "false"
    page.wait_for_timeout(150)
    assert viewer(page)["frame"] == stopped["frame"]


def test_playing_reaches_the_end_and_stops(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html")
    page.locator("#speed").select_option("2")
    page.locator("#scrub").press("End")
    for _ in range(20):
        page.locator("#scrub").press("ArrowLeft")
    page.locator("#play").click()
    until(page, lambda state: (state["playing"], state["frame"]) == ("false", "450"))


def test_where_motion_is_to_be_reduced_the_view_steps(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html", reduced_motion="reduce")
    assert viewer(page)["playing"] == "false"
    page.locator("#scrub").press("Home")
    page.locator("#play").click()
    # Half a second at 100 Hz in one step.
    assert int(until(page, lambda state: state["frame"] != "0")["frame"]) % 50 == 0


def test_parts_of_the_view_can_be_left_out(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html")
    viewer(page)
    whole = ink(page)
    for part in ("axes", "moment", "cone", "path"):
        page.locator(f'[data-show="{part}"]').uncheck()
    viewer(page)
    assert ink(page) < whole


@pytest.mark.parametrize("width", [380, 1280])
@pytest.mark.parametrize("which", ["trial", "hostile trial", "study"])
def test_axe_finds_nothing_serious(
    open_page: Any, result: Path, hostile: Path, study: Path, which: str, width: int
) -> None:
    path = {"trial": result / "report.html", "hostile trial": hostile / "report.html", "study": study / "index.html"}
    page = open_page(path[which], viewport={"width": width, "height": 900})
    found = axe.Axe().run(page).response
    assert len(found["passes"]) > 15
    serious = [fault for fault in found["violations"] if fault["impact"] in ("serious", "critical")]
    assert [(fault["id"], [node["html"] for node in fault["nodes"]][:3]) for fault in serious] == []


def test_hostile_names_are_text(open_page: Any, hostile: Path, study: Path) -> None:
    page = open_page(hostile / "report.html")
    assert "<script>alert('x')</script>" in page.locator(".lead").inner_text()
    assert "{{ 7 * 7 }}" in page.locator("h1").inner_text()
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2
    assert ink(page) > 2000
    page = open_page(study / "index.html")
    assert "<img src=x onerror=alert(1)>" in page.locator("#failures ~ div").inner_text()
    assert page.locator("img").count() == page.locator("tbody b").count() == 0


@pytest.mark.parametrize("which", ["trial", "study"])
def test_without_javascript_tables_and_figures_are_there(open_page: Any, result: Path, study: Path, which: str) -> None:
    path = result / "report.html" if which == "trial" else study / "index.html"
    page = open_page(path, java_script_enabled=False)
    for selector in ("table", "svg.chart"):
        for k in range(page.locator(selector).count()):
            assert page.locator(selector).nth(k).is_visible()
    if which == "trial":
        assert page.locator("noscript").inner_text().startswith("The view that turns")
        assert not page.locator("#viewer").is_visible()
    else:
        assert page.locator("#trials tbody tr").count() == 18
        assert not page.locator("#tools").is_visible()


@pytest.mark.parametrize("which", ["trial", "study"])
def test_pages_print(open_page: Any, result: Path, study: Path, which: str) -> None:
    page = open_page(result / "report.html" if which == "trial" else study / "index.html")
    printed = page.pdf(prefer_css_page_size=True)
    assert printed.startswith(b"%PDF")
    assert printed.count(b"/Type /Page\n") + printed.count(b"/Type /Page/") >= 2
    page.emulate_media(media="print")
    assert not page.locator("#viewer, #tools").first.is_visible()
    assert page.locator("svg.chart").first.is_visible()


@pytest.mark.parametrize("width", [360, 1280])
def test_no_page_is_wider_than_its_window(open_page: Any, result: Path, hostile: Path, study: Path, width: int) -> None:
    for path in (result / "report.html", hostile / "report.html", study / "index.html"):
        page = open_page(path, viewport={"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def trials(page: Any) -> list[str]:
    """Names of the trials shown, in their order."""
    return list(page.locator("#trials tbody tr:visible th").all_inner_texts())


def test_the_table_sorts_up_down_and_by_number(open_page: Any, study: Path) -> None:
    page = open_page(study / "index.html")
    assert len(trials(page)) == 18
    header = page.locator("#trials thead th", has_text="Largest angle")
    column = page.evaluate(
        "[...document.querySelectorAll('#trials thead th')].findIndex(h => h.textContent.startsWith('Largest'))"
    )
    header.locator("button").click()
    angles = [float(row) for row in page.locator(f"#trials tbody tr > :nth-child({column + 1})").all_inner_texts()]
    assert angles == sorted(angles)
    assert len(set(angles)) > 10
    assert header.get_attribute("aria-sort") == "ascending"
    header.locator("button").press("Enter")
    assert trials(page)[0] == "trial 5"
    assert header.get_attribute("aria-sort") == "descending"
    page.locator("#trials thead button").first.click()
    names = trials(page)
    assert names.index("trial 2") < names.index("trial 10")  # as a person counts
    assert header.get_attribute("aria-sort") is None


def test_the_table_filters_by_text_condition_and_outliers(open_page: Any, study: Path) -> None:
    page = open_page(study / "index.html")
    page.locator("select[data-factor]").last.select_option("fast")
    assert set(trials(page)) == {f"trial {k}" for k in range(1, 18, 2) if k != 7} | {"trial #7 <b>%41</b>"}
    assert page.locator("#count").inner_text() == "9 of 18 trials"
    page.locator("#only-outliers").check()
    assert trials(page) == ["trial 5"]
    page.locator("#only-outliers").uncheck()
    page.locator("select[data-factor]").last.select_option("")
    page.locator("#filter").fill("TRIAL 1 slow")
    assert set(trials(page)) == {f"trial {k}" for k in (10, 12, 14, 16)}
    page.locator("#filter").fill("nothing like this")
    assert trials(page) == []


def test_links_lead_to_the_trials_pages(browser: Any, study: Path) -> None:
    page = browser.new_page()
    page.goto((study / "index.html").as_uri())
    page.get_by_role("link", name="trial #7").click()
    page.wait_for_selector("#viewer")
    assert page.locator("#h-methods").is_visible()
    page.close()
