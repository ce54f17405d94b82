"""The pages in a real browser, opened from disk: no network, no error, and everything that moves moves."""

from __future__ import annotations

import io
import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from drawn_trials import drawn_trial
from PIL import Image

from elbowscrew import Mesh, analyze, save_analysis, simulate_trial
from elbowscrew.report.pages import broken
from elbowscrew.report.study import read_study
from elbowscrew.report.study_page import study_page
from elbowscrew.report.trial_page import trial_page

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
LONG_TRIAL_MOST_BYTES = 3_000_000
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


PIXELS = (
    "(() => { const space = document.getElementById('space'); const c = document.createElement('canvas');"
    "c.width = space.width; c.height = space.height;"
    "const x = c.getContext('2d', {willReadFrequently: true}); x.drawImage(space, 0, 0);"
    "return x.getImageData(0, 0, c.width, c.height).data; })()"
)


def ink(page: Any) -> int:
    """Pixels of the canvas with something on them."""
    return int(
        page.evaluate(
            f"(() => {{ const d = {PIXELS};"
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
    for summary in page.locator("summary").all():
        summary.click()
    for selector in ("table", "svg.chart"):
        for k in range(page.locator(selector).count()):
            assert page.locator(selector).nth(k).is_visible()
    if which == "trial":
        assert page.locator("noscript").inner_text().startswith("The view that turns")
        assert not page.locator("#viewer").is_visible()
    else:
        assert page.locator("#trials tbody tr").count() == 18
        assert not page.locator("#tools").is_visible()
        plain = page.locator("#trials tbody tr").all_inner_texts()
        drawn = open_page(path)
        assert drawn.locator("#trials tbody tr").all_inner_texts() == plain
        parts = "[...document.querySelectorAll('#trials tbody tr > *')].map((cell) => cell.innerHTML.trim())"
        assert [part for part in drawn.evaluate(parts) if "<svg" in part or "href" in part] == [
            part for part in page_parts(path.read_text(encoding="utf-8")) if "<svg" in part or "href" in part
        ]


def page_parts(html: str) -> list[str]:
    """Insides of the cells of the table of the trials as they stand in the file, as a browser writes them."""
    body = html[html.index('id="trials"') :]
    body = body[body.index("<tbody") : body.index("</tbody")]
    return [
        re.sub(r"(<path [^>]*)/>", r"\1></path>", part) for part in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", body, re.S)
    ]


@pytest.fixture(scope="module")
def many(study: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a study of 2000 trials, numbered."""
    found = read_study(study)
    one = found.trials[0]
    numbers = one.values  # noqa: PD011 - of no data frame
    trials = [replace(one, folder=f"t{k:04d}", values={**numbers, "top": 5000.0 - k}) for k in range(2000)]
    path = tmp_path_factory.mktemp("many") / "index.html"
    path.write_text(study_page(replace(found, trials=tuple(trials))), encoding="utf-8")
    return path


def test_rows_of_many_trials_are_drawn_as_they_come_into_view(open_page: Any, many: Path) -> None:
    page = open_page(many, viewport={"width": 1280, "height": 900})
    rows = page.locator("#trials tbody th")
    assert 50 <= rows.count() < 500
    assert page.locator("#trials").get_attribute("aria-rowcount") == "2001"
    area = page.get_by_role("region", name="Table of the trials")
    tall = area.evaluate("(area) => area.scrollHeight")
    area.evaluate("(area) => { area.scrollTop = area.scrollHeight; }")
    page.locator("#trials tbody th", has_text="t1999").wait_for()
    assert rows.count() < 1000
    assert page.locator("#trials tr", has_text="t1999").get_attribute("aria-rowindex") == "2001"
    assert area.evaluate("(area) => area.scrollHeight") == pytest.approx(tall, rel=0.3)
    page.locator("#trials thead button", has_text="Largest angle").click()
    assert rows.first.inner_text() == "t1999"
    page.locator("#filter").fill("t0123")
    assert rows.all_inner_texts() == ["t0123"]
    assert page.locator("#count").inner_text() == "1 of 2000 trials"
    page.locator("#filter").fill("")
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert rows.count() == 2000


@pytest.mark.parametrize("which", ["trial", "study"])
def test_pages_print(open_page: Any, result: Path, study: Path, which: str) -> None:
    page = open_page(result / "report.html" if which == "trial" else study / "index.html")
    printed = page.pdf(prefer_css_page_size=True)
    assert printed.startswith(b"%PDF")
    assert printed.count(b"/Type /Page\n") + printed.count(b"/Type /Page/") >= 2
    page.emulate_media(media="print")
    assert not page.locator(".tools").first.is_visible()
    for part in page.locator("svg.chart, table").all():
        assert part.is_visible()
    if which == "trial":
        assert page.locator("#space").is_visible()  # a still of the view
        assert not page.locator("#play").is_visible()
        assert not page.locator("summary").first.is_visible()


def test_the_page_of_a_long_trial_is_short_until_it_is_unfolded(open_page: Any, tmp_path: Path) -> None:
    made = trial_page(drawn_trial("long"), tmp_path).encode()
    assert len(made) < LONG_TRIAL_MOST_BYTES
    (tmp_path / "report.html").write_bytes(made)
    page = open_page(tmp_path / "report.html", viewport={"width": 1280, "height": 900})
    screens = "document.documentElement.scrollHeight / window.innerHeight"
    assert page.evaluate(screens) < 8.0
    page.locator("summary", has_text="Table of all phases").click()
    assert page.evaluate(screens) > 9.0


def test_the_page_of_two_axes_and_anatomy_is_short_and_nothing_on_it_scrolls_sideways(
    open_page: Any, tmp_path: Path
) -> None:
    (tmp_path / "report.html").write_text(trial_page(drawn_trial("two axes"), tmp_path), encoding="utf-8")
    page = open_page(tmp_path / "report.html", viewport={"width": 1280, "height": 900})
    assert page.evaluate("document.documentElement.scrollHeight / window.innerHeight") < 8.0
    for summary in page.locator("summary").all():
        summary.click()
    assert page.evaluate(SIDEWAYS) == []


def test_no_table_of_a_study_but_that_of_its_trials_scrolls_sideways(open_page: Any, study: Path) -> None:
    page = open_page(study / "index.html", viewport={"width": 1280, "height": 900})
    assert set(page.evaluate(SIDEWAYS)) <= {"Table of the trials"}


SIDEWAYS = """[...document.querySelectorAll('.scroll')].filter((part) => part.scrollWidth > part.clientWidth + 1)
  .map((part) => part.getAttribute('aria-label'))"""
BROKEN_WORDS = """[...document.querySelectorAll('th, td, dt, dd, h1, h2, h3, caption, label')].flatMap((place) => {
  const texts = document.createTreeWalker(place, NodeFilter.SHOW_TEXT), found = [];
  for (let node = texts.nextNode(); node; node = texts.nextNode()) {
    for (const word of node.data.matchAll(/[\\p{L}]+/gu)) {
      const range = document.createRange();
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      if (new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1) found.push(word[0]);
    }
  }
  return found;
})"""


def test_no_word_is_broken_on_a_phone(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html", viewport={"width": 390, "height": 844})
    for summary in page.locator("summary").all():
        summary.click()
    assert page.evaluate(BROKEN_WORDS) == []


@pytest.mark.parametrize("width", [390, 1280])
def test_axe_finds_nothing_serious_on_a_study_in_the_dark(open_page: Any, study: Path, width: int) -> None:
    page = open_page(study / "index.html", color_scheme="dark", viewport={"width": width, "height": 900})
    found = axe.Axe().run(page).response
    assert [fault["id"] for fault in found["violations"] if fault["impact"] in ("serious", "critical")] == []


def test_in_the_dark_the_page_and_the_view_are_dark_and_on_paper_light(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html", color_scheme="dark", viewport={"width": 1280, "height": 900})
    assert lightness(page.evaluate("getComputedStyle(document.body).backgroundColor")) < 0.2
    found = axe.Axe().run(page).response
    assert [fault["id"] for fault in found["violations"] if fault["impact"] in ("serious", "critical")] == []
    viewer(page)
    assert mean_ink(page) > 0.35
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert mean_ink(page) < 0.65
    page.emulate_media(media="print")
    assert lightness(page.evaluate("getComputedStyle(document.body).backgroundColor")) > 0.9


def lightness(color: str) -> float:
    return sum(float(part) for part in re.findall(r"[\d.]+", color)[:3]) / 765.0


def mean_ink(page: Any) -> float:
    """Mean lightness of what covers the canvas fully."""
    return float(
        page.evaluate(
            f"(() => {{ const d = {PIXELS}; let n = 0, sum = 0;"
            " for (let k = 0; k < d.length; k += 4) if (d[k + 3] > 250)"
            " { n += 1; sum += (d[k] + d[k + 1] + d[k + 2]) / 765; } return sum / n; })()"
        )
    )


def test_a_chart_tells_the_values_beneath_the_pointer(open_page: Any, result: Path) -> None:
    page = open_page(result / "report.html", viewport={"width": 1280, "height": 900})
    chart = page.locator("svg.chart").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"])
    told = page.locator(".values").first.inner_text().replace("−", "-")
    seconds, measured = (float(re.search(rf"{name} (-?[\d.]+)", told)[1]) for name in (r"Time \(s\)", "measured"))  # type: ignore[index]
    table = pd.read_csv(result / "screw.csv")
    assert measured == pytest.approx(np.interp(seconds, table["time_s"], table["theta_deg"]), abs=1.5)
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] - 20)
    assert page.locator(".values").first.inner_text() == ""


def test_a_chart_can_be_taken_along_as_picture_and_as_numbers(browser: Any, result: Path) -> None:
    page = browser.new_page(color_scheme="dark")
    page.goto((result / "report.html").as_uri())
    saved = {}
    for kind in ("SVG", "CSV"):
        with page.expect_download() as waited:
            page.get_by_role("button", name=f"Download the chart Angle over time as {kind}").click()
        assert waited.value.suggested_filename == f"angle-over-time.{kind.lower()}"
        saved[kind] = Path(waited.value.path()).read_text(encoding="utf-8-sig")
    page.close()
    rows = pd.read_csv(io.StringIO(saved["CSV"]))
    measured = rows[rows["series"] == "measured"]
    table = pd.read_csv(result / "screw.csv")
    assert measured["Time (s)"].to_numpy() == pytest.approx(table["time_s"].to_numpy())
    assert measured["value"].to_numpy() == pytest.approx(table["theta_deg"].to_numpy(), rel=1e-5, abs=1e-6, nan_ok=True)
    assert set(rows["quantity"]) == {"Angle θ (deg)"}
    picture = ElementTree.fromstring(saved["SVG"])  # noqa: S314 - a page of ours
    style = next(part.text or "" for part in picture.iter() if part.tag.endswith("style"))
    assert ".measured" in style
    assert "#000000" in style or "rgb(0, 0, 0)" in style  # the colors of paper, from a dark page
    assert "var(" not in style
    words = [part.text for part in picture.iter() if part.tag.endswith("text")]
    assert {"Time (s)", "measured", "keyframes"} <= set(words)


def test_the_view_can_be_taken_along_as_a_still(browser: Any, result: Path) -> None:
    page = browser.new_page(color_scheme="dark", viewport={"width": 1280, "height": 900})
    page.goto((result / "report.html").as_uri())
    page.locator("#scrub").press("Home")
    size = page.locator("#space").bounding_box()
    with page.expect_download() as waited:
        page.get_by_role("button", name="Download the view as PNG").click()
    assert waited.value.suggested_filename == "frame-0.png"
    with Image.open(waited.value.path()) as still:
        assert still.size == pytest.approx((3 * size["width"], 3 * size["height"]), abs=3)
        levels = np.asarray(still.convert("RGB"))
    assert (levels[0, 0] == 255).all()  # paper, from a dark page
    assert (levels.min(axis=2) < 120).sum() > 1000
    viewer(page)
    assert mean_ink(page) > 0.35  # the page is as dark as before
    page.close()


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


def test_words_in_the_view_are_not_cut_off(open_page: Any, result: Path) -> None:
    """Turned and enlarged until a segment's name would stand half over the edge, it stands within."""
    page = open_page(result / "report.html", viewport={"width": 1280, "height": 900})
    page.evaluate(
        "window.words = []; const draw = CanvasRenderingContext2D.prototype.strokeText;"
        "CanvasRenderingContext2D.prototype.strokeText = function (text, x, y) {"
        " const half = this.measureText(text).width / 2;"
        " window.words.push([x - half, y - 6, x + half - this.canvas.clientWidth, y + 6 - this.canvas.clientHeight]);"
        " return draw.call(this, text, x, y); }; 0"
    )
    space = page.locator("#space")
    for key in ("+", "+", "+", "ArrowUp", "+", "ArrowLeft", "+", "+"):
        for _ in range(4):
            space.press(key)
            viewer(page)
    boxes = np.array(page.evaluate("window.words"))
    assert len(boxes) > 60
    seen = (boxes[:, 0] > -60) & (boxes[:, 1] > -16) & (boxes[:, 2] < 60) & (boxes[:, 3] < 16)
    left, top, right, bottom = boxes[seen].T
    cut = (left < 0) | (top < 0) | (right > 0) | (bottom > 0)
    whole_outside = (left < -30) | (top < -9) | (right > 30) | (bottom > 9)
    assert not (cut & ~whole_outside).any()


def test_a_digest_does_not_widen_the_checklist_on_a_phone(open_page: Any, result: Path, tmp_path: Path) -> None:
    text = (result / "report.html").read_text(encoding="utf-8")
    place = re.search(r'<tr><th scope="row">File</th><td>.*?</td></tr>', text)
    row = '<tr><th scope="row">File</th><td>a.csv, SHA-256 ' + broken("0a" * 32) + "</td></tr>"
    assert str(broken("a <b>")) == "a &lt;b&gt;"
    changed = text.replace(place[0], row) if place else text
    assert "digest" in changed
    (tmp_path / "report.html").write_text(changed, encoding="utf-8")
    page = open_page(tmp_path / "report.html", viewport={"width": 390, "height": 844})
    page.locator("summary", has_text="What a paper on this trial should state").click()
    area = page.get_by_role("region", name="Table of the reporting checklist")
    assert area.evaluate("(area) => area.scrollWidth - area.clientWidth") <= 1


def test_the_headings_of_the_trials_table_are_no_buttons_in_print(open_page: Any, study: Path) -> None:
    """A button is painted on the first sheet alone."""
    page = open_page(study / "index.html")
    button = page.locator("#trials thead button").first
    assert button.evaluate("(button) => getComputedStyle(button).display") != "contents"
    page.emulate_media(media="print")
    assert button.evaluate("(button) => getComputedStyle(button).display") == "contents"


def test_bones_are_drawn_and_can_be_left_out(open_page: Any, tmp_path: Path) -> None:
    """A box of bone as long as a thigh, of twelve triangles."""
    low, high = np.array([-0.02, -0.02, -0.15]), np.array([0.02, 0.02, 0.15])
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
    squares = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    faces = np.array([half for a, b, c, d in squares for half in ((a, b, c), (a, c, d))])
    bone = Mesh(vertices=low + corners * (high - low), faces=faces, triangles=len(faces))
    recording = simulate_trial(joint="knee", frames=60, inversion=30, proximal="moving").recording
    folder = save_analysis(analyze(recording), tmp_path / "r", figure_formats=(), meshes={"thigh": bone})
    page = open_page(folder / "report.html", viewport={"width": 1280, "height": 900})
    for part in ("axes", "moment", "cone", "path"):
        page.locator(f'[data-show="{part}"]').uncheck()
    viewer(page)
    with_bone = ink(page)
    page.locator('[data-show="bones"]').uncheck()
    viewer(page)
    assert with_bone > ink(page) + 1000
    found = axe.Axe().run(page).response
    assert [fault["id"] for fault in found["violations"]] == []


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (1280, "dark")])
@pytest.mark.parametrize("kind", ["two axes", "wandering", "ball"])
def test_axe_finds_nothing_on_pages_of_all_joints_unfolded(
    open_page: Any, tmp_path: Path, kind: str, width: int, scheme: str
) -> None:
    (tmp_path / "report.html").write_text(trial_page(drawn_trial(kind), tmp_path), encoding="utf-8")
    page = open_page(tmp_path / "report.html", viewport={"width": width, "height": 900}, color_scheme=scheme)
    for summary in page.locator("summary").all():
        summary.click()
    found = axe.Axe().run(page).response
    assert len(found["passes"]) > 15
    assert [(fault["id"], [node["html"] for node in fault["nodes"]][:3]) for fault in found["violations"]] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(BROKEN_WORDS) == []


@pytest.mark.parametrize("width", [390, 1280])
def test_axe_finds_nothing_on_a_study_unfolded(open_page: Any, study: Path, width: int) -> None:
    page = open_page(study / "index.html", viewport={"width": width, "height": 900})
    for summary in page.locator("summary").all():
        summary.click()
    assert axe.Axe().run(page).response["violations"] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_no_option_is_broken_on_a_phone(open_page: Any, tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text(trial_page(drawn_trial("ball"), tmp_path), encoding="utf-8")
    page = open_page(tmp_path / "report.html", viewport={"width": 390, "height": 844})
    for summary in page.locator("summary").all():
        summary.click()
    lines = page.evaluate("[...document.querySelectorAll('.option')].map((one) => one.getClientRects().length)")
    assert set(lines) == {1}  # of one at least
    assert str(broken("--arm-markers NAMES, a--b, <--x>")) == (
        '<span class="option">--arm-markers</span> NAMES, a--b, &lt;<span class="option">--x</span>&gt;'
    )
