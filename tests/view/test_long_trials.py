"""A long trial is shown by a stretch that is like the others, and by what all of it spans."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from drawn_trials import drawn_trial
from numpy.typing import NDArray

from elbowscrew.model import Repetitions
from elbowscrew.plots import FIGURES
from elbowscrew.view.long_trials import envelope, shown_part, stretch_of
from elbowscrew.view.trial_view import TrialView


@pytest.fixture
def long() -> TrialView:
    return drawn_trial("long")


def test_a_short_trial_is_shown_as_it_is() -> None:
    short = drawn_trial("multi-cycle")
    assert shown_part(short) == (short, None)


def test_the_stretch_is_three_cycles_and_no_odd_one(long: TrialView) -> None:
    stretch = stretch_of(long)
    assert stretch is not None
    duration = 899 / 100.0
    assert long.time_s[stretch.end - 1] - long.time_s[stretch.first] == pytest.approx(3 * duration, abs=0.1)
    first = int(stretch.told.split()[1])
    # If one of these were odd, others would be shown.
    top = long.repetitions.top_angle.copy()
    top[first] *= 0.5
    odd = stretch_of(replace(long, repetitions=replace(long.repetitions, top_angle=top)))
    assert odd is not None
    other = int(odd.told.split()[1])
    assert not other <= first + 1 <= other + 2


def test_without_cycles_it_is_2000_frames(long: TrialView) -> None:
    columns = {field.name: getattr(long.repetitions, field.name)[:0] for field in fields(long.repetitions)}
    none = replace(long.repetitions, **columns)
    stretch = stretch_of(replace(long, repetitions=none))
    assert stretch is not None
    assert stretch.end - stretch.first == 2000
    assert stretch.told.startswith("frames ")


def test_what_is_cut_out_are_the_rows_of_the_trial(long: TrialView) -> None:
    part, stretch = shown_part(long)
    assert stretch is not None
    rows = slice(stretch.first, stretch.end)
    for name in ("frame", "time_s", "angle", "valid", "modeled_angle", "euler_parameters", "slide_sd"):
        assert np.array_equal(getattr(part, name), getattr(long, name)[rows], equal_nan=name != "valid"), name
    assert part.joint_angles is not None
    assert long.joint_angles is not None
    assert np.array_equal(part.joint_angles.angle, long.joint_angles.angle[rows], equal_nan=True)
    assert np.array_equal(part.frame[part.keyframes.row], part.keyframes.frame)
    assert part.keyframes.row.size > 3
    assert np.array_equal(part.phases.moving, long.phases.moving[rows])
    flexion = long.extra["anatomy"]["flexion"]
    assert np.array_equal(part.extra["anatomy"]["flexion"], flexion[rows], equal_nan=True)
    assert part.extra["cycles"] is not None
    assert part.repetitions.number.size == 3
    assert part.repetitions.number[0] == int(stretch.told.split()[1])
    assert stretch_of(part) is None


def test_what_is_cut_out_is_no_long_trial_again(long: TrialView) -> None:
    """Cycles as long as a whole recording are cut to frames."""
    ends = {name: getattr(long.repetitions, name)[:22] for name in (field.name for field in fields(long.repetitions))}
    whole = {"start_time_s": np.full(22, long.time_s[0]), "end_time_s": np.full(22, long.time_s[-1])}
    part, stretch = shown_part(replace(long, repetitions=replace(long.repetitions, **{**ends, **whole})))
    assert stretch is not None
    assert stretch.told.startswith("frames ")
    assert stretch_of(part) is None


@pytest.mark.parametrize(("cycles", "rest"), [(30, 0), (30, 40), (60, 0), (400, 13)])
def test_equal_cycles_span_the_same_all_along(long: TrialView, cycles: int, rest: int) -> None:
    period = long.frame.size // cycles
    row = np.arange(long.frame.size)
    phase = np.clip(row % period / (period - rest), 0.0, 1.0)
    angle = np.sin(np.pi * phase) ** 2
    starts = long.time_s[np.arange(cycles) * period]
    made = repetitions_at(long, starts, starts + (period - rest) / long.rate_hz)
    found = envelope(replace(long, repetitions=made), angle)
    assert np.diff(found.time_s).min() >= 0.45 * period / long.rate_hz
    for values in (found.low, found.middle, found.high):
        assert values[:-2] == pytest.approx(values[0], abs=1e-3)  # the last part has what is left over, too
    assert found.high == pytest.approx(1.0, abs=2e-3)


def test_a_long_rest_between_cycles_has_parts_of_its_own(long: TrialView) -> None:
    """A cycle a second, but for a minute in which nothing moves."""
    time_s = long.time_s - long.time_s[0]
    resting = (time_s >= 60.0) & (time_s < 120.0)
    angle = np.where(resting, 0.0, np.sin(np.pi * time_s) ** 2)
    starts = np.arange(0.0, 220.0)
    starts = starts[(starts < 60.0) | (starts >= 120.0)] + long.time_s[0]
    found = envelope(replace(long, repetitions=repetitions_at(long, starts, starts + 1.0)), angle)
    inside = (found.time_s > 62.0 + long.time_s[0]) & (found.time_s < 118.0 + long.time_s[0])
    assert inside.sum() > 20
    assert (found.high[inside] == 0.0).all()
    moving = (found.time_s < 59.0 + long.time_s[0]) | (found.time_s > 121.0 + long.time_s[0])
    assert found.high[moving] == pytest.approx(1.0, abs=0.01)


def test_few_long_cycles_are_followed(long: TrialView) -> None:
    starts = long.time_s[[0, 9000]]
    made = repetitions_at(long, starts, starts + 80.0)
    found = envelope(replace(long, repetitions=made), long.time_s)
    assert found.time_s.size > 100
    assert found.middle[1:-1] == pytest.approx(found.time_s[1:-1], abs=1.0)


def repetitions_at(view: TrialView, starts: NDArray[np.float64], ends: NDArray[np.float64]) -> Repetitions:
    rows = np.zeros(starts.size, dtype=np.int64)
    columns = {field.name: getattr(view.repetitions, field.name)[rows] for field in fields(view.repetitions)}
    return Repetitions(**{**columns, "start_time_s": starts, "end_time_s": ends})


def test_the_envelope_holds_every_value(long: TrialView) -> None:
    found = envelope(long, long.angle)
    assert np.nanmin(found.low) == np.nanmin(long.angle)
    assert np.nanmax(found.high) == np.nanmax(long.angle)
    assert (found.low <= found.middle).all()
    assert (found.middle <= found.high).all()
    gap = long.angle.copy()
    gap[:9000] = np.nan
    unknown = envelope(long, gap)
    assert np.isnan(unknown.low[:8]).all()
    assert np.isfinite(unknown.low[-8:]).all()


@pytest.mark.parametrize("name", ["theta", "euler_parameters", "velocity", "anatomy", "joint_angles", "fig7"])
def test_a_long_trial_has_an_overview_above_its_stretch(long: TrialView, name: str) -> None:
    figure = FIGURES[name](long)
    assert [ax.get_title(loc="left") for ax in figure.axes] == list("abcdefgh"[: len(figure.axes)])
    assert "part drawn in full" in figure.axes[0].get_legend_handles_labels()[1]
    shown = figure.axes[1].get_xlim()
    assert shown[1] - shown[0] < 30.0 < np.ptp(figure.axes[0].get_xlim())
