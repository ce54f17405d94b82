"""Charts are read back from the SVG alone: what is drawn lies where the values are, by the chart's own ticks."""

from __future__ import annotations

import numpy as np
import pytest
from read_charts import Read, keys_in, numbers, picture_in

from elbowscrew.report.charts import COLORS, Chart, color_of, picture, range_of, tick_text, ticks_between
from elbowscrew.report.distributions import strip_chart

NAN = float("nan")


def chart() -> Chart:
    return Chart("one", "A <title>", "What & why", x_range=(0.0, 10.0), y_range=(-20.0, 60.0),
                 x_label="Time (s)", y_label="Angle <θ> (deg)")  # fmt: skip


X = np.arange(11.0)


def test_a_line_goes_through_its_values_and_is_broken_where_there_is_none() -> None:
    y = np.array([0.0, 10, 20, 30, NAN, 50, 40, 30, 20, -10, -20])
    one = chart()
    one.line(X, y, "measured", "measured")
    read = Read(picture_in(one.svg()))
    (path,) = read.every("path", "measured")
    assert path.get("d", "").count("M") == 2
    (points,) = read.outline("measured")
    known = np.isfinite(y)
    assert points == pytest.approx(np.column_stack([X, y])[known], abs=0.15)


def test_a_band_lies_between_its_edges_wherever_both_are_known() -> None:
    low, high = X - 5.0, X + 5.0
    low[3], high[7] = NAN, NAN
    one = chart()
    one.band(X, low, high, "band-known", "± one")
    read = Read(picture_in(one.svg()))
    pieces = read.outline("band-known")
    assert [len(piece) for piece in pieces] == [2 * 3, 2 * 3, 2 * 3]
    for piece, rows in zip(pieces, (slice(0, 3), slice(4, 7), slice(8, 11)), strict=True):
        edges = np.concatenate([low[rows], high[rows][::-1]])
        assert piece == pytest.approx(np.column_stack([np.concatenate([X[rows], X[rows][::-1]]), edges]), abs=0.15)
    assert all(path.get("d", "").endswith("Z") for path in read.every("path", "band-known"))


def test_points_stand_at_their_values_and_unknown_ones_nowhere() -> None:
    one = chart()
    one.points(np.array([1.0, 2.0, NAN, 8.0]), np.array([5.0, NAN, 3.0, 55.0]), "keyframe", "keyframes", radius=3.0)
    assert Read(picture_in(one.svg())).dots("keyframe") == [
        pytest.approx([1.0, 5.0, 3.0], abs=0.15),
        pytest.approx([8.0, 55.0, 3.0], abs=0.15),
    ]


def test_spans_reach_from_begin_to_end_and_from_axis_to_top() -> None:
    one = chart()
    one.spans([(2.0, 5.0), (7.0, 7.0)], "fill-lost", "not tracked")
    read = Read(picture_in(one.svg()))
    wide, thin = read.every("rect", "fill-lost")
    x, width = float(wide.get("x", "")), float(wide.get("width", ""))
    assert np.polyval(read.x, [x, x + width]) == pytest.approx([2.0, 5.0], abs=0.02)
    assert float(thin.get("width", "")) == 0.5  # a single moment can still be seen
    top, tall = float(wide.get("y", "")), float(wide.get("height", ""))
    assert np.polyval(read.y, [top, top + tall]) == pytest.approx([60.0, -20.0], abs=0.2)


def test_a_segment_joins_its_two_ends_in_its_own_color() -> None:
    one = chart()
    one.segment((1.0, 9.0), (10.0, 30.0), "thread", "#123456")
    one.segment((0.0, 10.0), (5.0, 5.0), "level", label="RMS")
    read = Read(picture_in(one.svg()))
    assert read.outline("thread")[0] == pytest.approx(np.array([[1.0, 10.0], [9.0, 30.0]]), abs=0.15)
    assert [path.get("stroke") for look in ("thread", "level") for path in read.every("path", look)] == [
        "#123456",
        None,
    ]


def test_the_legend_has_each_drawn_thing_once_and_nothing_else() -> None:
    one = chart()
    one.spans([], "fill-lost", "not tracked")
    one.spans([(1.0, 2.0)], "fill-moving", "moving")
    one.line(X, X, "measured", "measured <x>")
    one.line(X, X + 1.0, "measured", "measured <x>")
    one.segment((0.0, 1.0), (0.0, 1.0), "thread")
    one.points(X, X, "keyframe", "keyframes")
    # A surface has a surface for its key, a curve a line, a point a point, each with the look of the thing drawn.
    assert keys_in(one.keys()) == [
        ("rect", "fill-moving", "moving"),
        ("path", "measured", "measured &lt;x&gt;"),
        ("circle", "keyframe", "keyframes"),
    ]


def test_labels_ticks_and_grid_stand_at_the_axes() -> None:
    one = chart()
    read = Read(picture_in(one.svg()))
    left, bottom, right = numbers(read.every("path", "axis")[0])
    assert np.polyval(read.x, [left, right]) == pytest.approx([0.0, 10.0], abs=0.02)
    assert np.polyval(read.y, bottom) == pytest.approx(-20.0, abs=0.2)
    assert all(numbers(tick)[1] == bottom for tick in read.every("path", "tick"))
    for line in read.every("path", "grid"):
        assert (numbers(line)[0], numbers(line)[2]) == (left, right)
    texts = {text.text: text for text in read.root.iter("text")}
    assert 0.0 < float(texts["Time (s)"].get("x", "")) - left < right - left
    assert float(texts["Time (s)"].get("x", "")) == pytest.approx(0.5 * (left + right))
    assert float(texts["Time (s)"].get("y", "")) > bottom
    along_the_side = texts["Angle <θ> (deg)"]
    assert along_the_side.get("transform", "").startswith("rotate(-90 ")
    x, y = float(along_the_side.get("x", "")), float(along_the_side.get("y", ""))
    assert x < left
    assert along_the_side.get("transform") == f"rotate(-90 {x:g} {y:g})"  # about itself, or it would stand elsewhere
    height = float(read.root.get("viewBox", "").split()[3])
    assert all(0.0 < float(text.get("y", "")) < height for text in read.root.iter("text"))
    # The number of a line of the grid stands beside it: its middle, 4.5 px over its foot, is at the line.
    ends = [text for text in read.root.iter("text") if text.get("text-anchor") == "end"]
    for text, line in zip(ends, read.every("path", "grid"), strict=True):
        assert float(text.get("x", "")) < left
        assert 2.0 < float(text.get("y", "")) - numbers(line)[1] < 7.0


def test_what_lies_outside_is_cut_off_at_the_panel() -> None:
    one = chart()
    one.line(X, 100.0 * X, "measured")
    svg = one.svg()
    read = Read(picture_in(svg))
    (clip,) = read.root.iter("clipPath")
    assert f'clip-path="url(#{clip.get("id")})"' in svg
    (frame,) = clip
    left, _, right = numbers(read.every("path", "axis")[0])
    assert float(frame.get("x", "")) == left
    assert float(frame.get("x", "")) + float(frame.get("width", "")) == right
    low = float(frame.get("y", "")) + float(frame.get("height", ""))
    assert np.polyval(read.y, low) == pytest.approx(-20.0, abs=0.2)
    assert np.polyval(read.y, float(frame.get("y", ""))) >= 60.0


def test_panels_stand_where_they_are_put_and_a_picture_says_what_it_is() -> None:
    drawn = picture("two", "A <title>", "What & why", 900.0, 465.0, [chart().panel(450.0, 235.0)])
    root = picture_in(drawn)
    assert root.get("viewBox") == "0 0 900 465"
    assert root[2].get("transform") == "translate(450 235)"
    named = {one.get("id"): one.text for one in root.iter() if one.get("id")}
    assert [named[name] for name in root.get("aria-labelledby", "").split()] == ["A <title>", "What & why"]
    assert (root[0].tag, root[1].tag, root.get("role")) == ("title", "desc", "img")


@pytest.mark.parametrize(
    ("values", "zero", "wanted"),
    [
        ([0.0, 10.0], False, (-0.6, 10.6)),
        ([NAN, 5.0, 15.0], True, (0.0, 15.9)),
        ([-10.0, -5.0], True, (-10.6, 0.6)),
        ([7.0], False, (7.0 - 0.06 * 7.0, 7.0 + 0.06 * 7.0)),
        ([NAN], False, (0.0, 1.0)),
    ],
)
def test_a_range_holds_all_values_with_six_percent_of_air(
    values: list[float], zero: bool, wanted: tuple[float, float]
) -> None:
    assert range_of(np.array(values), zero=zero) == pytest.approx(wanted)


def test_a_range_of_zeros_alone_still_has_a_width() -> None:
    low, high = range_of(np.zeros(3))
    assert low < 0.0 < high


@pytest.mark.parametrize(
    ("low", "high", "most", "wanted"),
    [
        (0.0, 10.0, 5, [0, 2, 4, 6, 8, 10]),
        (-20.0, 60.0, 5, [-20, 0, 20, 40, 60]),
        (0.0, 1.0, 10, [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        (0.0, 0.4, 8, [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]),
        (3.0, 3.0, 5, [3]),
    ],
)
def test_ticks_are_all_multiples_of_one_two_or_five_inside(
    low: float, high: float, most: int, wanted: list[float]
) -> None:
    ticks, decimals = ticks_between(low, high, most)
    assert ticks == pytest.approx(wanted)
    assert [float(f"{tick:.{decimals}f}") for tick in ticks] == pytest.approx(wanted)
    if low < high:  # no decimal more than the step has
        step = wanted[1] - wanted[0]
        assert decimals == 0 or step * 10.0 ** (decimals - 1) != pytest.approx(round(step * 10.0 ** (decimals - 1)))


def test_ticks_have_a_true_minus_sign_and_no_negative_zero() -> None:
    assert [tick_text(value, 1) for value in (-1.5, -0.0, 2.0)] == ["−1.5", "0.0", "2.0"]


def test_colors_are_those_of_the_scale_and_halfway_between() -> None:
    for k, color in enumerate(COLORS):
        assert color_of(k / (len(COLORS) - 1)) == color
    halfway = color_of(0.5 / (len(COLORS) - 1))
    for channel in (1, 3, 5):
        parts = [int(color[channel : channel + 2], 16) for color in (COLORS[0], COLORS[1])]
        assert int(halfway[channel : channel + 2], 16) == pytest.approx(0.5 * sum(parts), abs=0.51)
    assert (color_of(-1.0), color_of(2.0)) == (COLORS[0], COLORS[-1])


VALUES = np.array([10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 60.0, NAN])
NAMES = [f"trial {k} <b>" for k in range(10)]
FAR = VALUES > 50.0


def test_a_strip_has_a_point_for_each_trial_and_a_box_of_its_quartiles() -> None:
    few = np.array([20.0, 30.0])
    name = "a group with a name that is very long"
    drawn = strip_chart(
        "top", "Largest <angle>", "deg", {"slow": (VALUES, NAMES, FAR), name: (few, NAMES[:2], FAR[:2])}
    )
    read = Read(picture_in(drawn))
    unit = 0.1 * abs(read.x[0])
    known = VALUES[np.isfinite(VALUES)]
    usual = sorted(along for along, *_ in read.dots("one"))
    assert usual == pytest.approx(sorted([*known[:-1], *few]), abs=unit)
    assert [along for along, *_ in read.dots("far")] == pytest.approx([60.0], abs=unit)
    assert [one[0].text for one in read.every("circle", "far")] == [NAMES[8]]
    (box,) = read.every("rect", "box")  # two values have no quartiles
    first, median, third = np.percentile(known, [25, 50, 75])
    begin, width = float(box.get("x", "")), float(box.get("width", ""))
    assert np.polyval(read.x, [begin, begin + width]) == pytest.approx([first, third], abs=2.0 * unit)
    (line,) = read.every("path", "median")
    assert np.polyval(read.x, numbers(line)[0]) == pytest.approx(median, abs=unit)
    # Whiskers as Tukey's: to the last value within 1.5 times the box.
    (whisker,) = read.every("path", "whisker")
    low, _, begin_of_box, end_of_box, _, high = numbers(whisker)
    assert np.polyval(read.x, [low, begin_of_box, end_of_box, high]) == pytest.approx(
        [10.0, first, third, 17.0], abs=unit
    )
    # Each strip in a row of its own, with the row's name beside it and its points within.
    rows = {one.text: float(one.get("y", "")) for one in read.root.iter("text") if one.get("text-anchor") == "end"}
    assert list(rows) == ["slow", name[:21] + "…"]
    height = float(box.get("height", ""))
    middle = float(box.get("y", "")) + 0.5 * height
    assert numbers(line)[1:] == pytest.approx([float(box.get("y", "")), height], abs=0.1)
    assert numbers(whisker)[1] == pytest.approx(middle, abs=0.1)
    assert 0.0 < rows["slow"] - middle < 8.0
    apart = list(rows.values())[1] - rows["slow"]
    lower = [float(one.get("cy", "")) for one in read.every("circle", "one")]
    assert sum(abs(y - middle) < 0.5 * apart for y in lower) == known.size - 1
    assert sum(abs(y - middle - apart) < 0.5 * apart for y in lower) == few.size
    assert len({round(y - middle, 1) for y in lower[: known.size - 1]}) == known.size - 1  # side by side
    texts = {text.text for text in read.root.iter("text")}
    assert "Largest <angle> (deg)" in texts
    assert read.root[1].text == "Largest <angle> of every trial in 2 groups, outliers marked."
    alone = picture_in(strip_chart("top", "Top", "deg", {"all": (VALUES, NAMES, FAR)}))
    assert alone[1].text == "Top of every trial, outliers marked."


def test_nothing_of_a_strip_chart_lies_outside_it() -> None:
    read = Read(picture_in(strip_chart("top", "Top", "deg", {"slow": (VALUES, NAMES, FAR)})))
    width, height = (float(part) for part in read.root.get("viewBox", "").split()[2:])
    left, bottom, right = numbers(read.every("path", "axis")[0])
    assert 0.0 < left < right < width
    for dot in read.root.iter("circle"):
        assert left < float(dot.get("cx", "")) < right
        assert 0.0 < float(dot.get("cy", "")) < bottom
    for line in read.every("path", "grid"):
        assert numbers(line)[2] == bottom
        assert 0.0 <= numbers(line)[1] < 8.0
    assert all(float(text.get("y", "")) < height for text in read.root.iter("text"))
