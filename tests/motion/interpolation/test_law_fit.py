"""Which law a phase follows: on phases made by a law that is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.geometry import dual_quat_from_screw, line_through, sclerp
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import ModelPhases
from elbowscrew.motion.difference import points_from_radius, rms_displacement
from elbowscrew.motion.interpolation import law_fit
from elbowscrew.motion.interpolation.law_fit import FittedLaw, laws_of
from elbowscrew.motion.interpolation.laws import LAWS, asymmetric

COUNT = 121
TAU = np.linspace(0.0, 1.0, COUNT)
LINE = line_through([0.1, -0.2, 0.05], [0.2, 0.9, -0.3])
PHASES = ModelPhases(bound_rows=np.array([0, COUNT - 1]), law_rows=np.array([[0, COUNT - 1]]))


def moved(t: Float, top_deg: float = 130.0) -> Float:
    return dq.multiply(
        dual_quat_from_screw(np.radians(top_deg) * t, 0.004 * t, LINE[:3], LINE[3:]),
        dq.dual_quat_from_pose([0.6, 0.0, 0.8, 0.0], [0.1, 0.2, -0.3]),
    )


def law_of(name: str, pose: Float, peak: float | None = None, phases: ModelPhases = PHASES) -> FittedLaw:
    measured = np.isfinite(pose[:, 0])
    (found,) = laws_of(name, peak, pose, measured, TAU, np.arange(COUNT), phases, points_from_radius(0.05))
    return found


@pytest.mark.parametrize("name", [name for name in LAWS if name != "linear"])
@pytest.mark.parametrize("peak", [0.3, 0.5, 0.62])
def test_the_best_law_is_the_one_the_motion_was_made_with(name: str, peak: float) -> None:
    found = law_of("best", moved(asymmetric(LAWS[name], peak)(TAU)))
    assert found.law.name == name
    assert found.law.peak == pytest.approx(peak, abs=2e-4)
    assert found.law.rms < 5e-5


def test_a_steady_motion_is_linear() -> None:
    found = law_of("best", moved(TAU))
    assert (found.law.name, found.law.peak) == ("linear", None)
    assert found.law.rms < 1e-12


@pytest.mark.parametrize("top_deg", [20.0, 130.0, 200.0])
def test_the_recordings_own_law_is_the_share_of_its_turn(top_deg: float) -> None:
    t = asymmetric(LAWS["modified-sine"], 0.4)(TAU) + 0.02 * np.sin(8 * np.pi * TAU)
    pose = moved(t, top_deg)
    pose[50:60] = np.nan
    found = law_of("empirical", pose)
    assert found.function(TAU)[:50] == pytest.approx(t[:50], abs=1e-12)
    assert found.function(TAU)[60:] == pytest.approx(t[60:], abs=1e-12)
    assert found.function(TAU)[50:60] == pytest.approx(np.interp(TAU[50:60], TAU[[49, 60]], t[[49, 60]]), abs=1e-12)
    assert found.law.rms < 1e-12


def test_a_phase_that_does_not_turn_has_no_law_of_its_own() -> None:
    pose = moved(np.sin(2.0 * np.pi * TAU))
    with pytest.raises(SettingError, match="does not turn between frames 0 to 120"):
        law_of("empirical", pose)


def test_named_laws_stay_as_they_are_and_say_how_near_they_are() -> None:
    pose = moved(LAWS["harmonic"](TAU))
    direct = law_of("harmonic", pose)
    other = law_of("cycloidal", pose, 0.4)
    assert direct.law.rms < 1e-12
    assert (other.law.name, other.law.peak) == ("cycloidal", 0.4)
    assert other.function(TAU) == pytest.approx(asymmetric(LAWS["cycloidal"], 0.4)(TAU))
    assert law_of("best", pose).law.rms <= other.law.rms


@pytest.mark.parametrize("batch", [1, 50, 4096])
def test_each_phase_has_its_own_rms_however_many_are_looked_at_at_a_time(
    batch: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(law_fit, "_BATCH_FRAMES", batch)
    pose = moved(np.sin(3.0 * np.pi * TAU))
    measured = np.ones(COUNT, dtype=np.bool_)
    measured[60:91] = False
    bounds = np.array([0, 20, 59, 91, COUNT - 1])
    rows = np.stack([bounds[:-1], bounds[1:]], axis=1)
    rows[2] = 60, 90  # with no measured frame
    points = points_from_radius(0.05)
    together = laws_of(
        "harmonic", None, pose, measured, TAU, np.arange(COUNT), ModelPhases(bound_rows=bounds, law_rows=rows), points
    )
    for p, found in enumerate(together):
        alone = ModelPhases(bound_rows=bounds[p : p + 2], law_rows=rows[p : p + 1])
        (one,) = laws_of("harmonic", None, pose, measured, TAU, np.arange(COUNT), alone, points)
        assert (found.law.name, found.law.peak) == ("harmonic", None)
        assert str(found.law.rms) == str(one.law.rms)
    rms = [found.law.rms for found in together]
    assert np.isnan(rms).tolist() == [False, False, True, False]
    kept = np.arange(20, 60)
    tau = (TAU[kept] - TAU[20]) / (TAU[59] - TAU[20])
    modeled = sclerp(pose[20], pose[59], LAWS["harmonic"](tau), way="as given")
    assert rms[1] == pytest.approx(np.sqrt(np.mean(rms_displacement(pose[kept], modeled, points) ** 2)), rel=1e-14)


def test_the_best_law_of_a_minimum_jerk_elbow() -> None:
    trial = simulate_trial(marker_noise_mm=0.1, rest_before_s=0.8, seed=2).recording
    laws = analyze(trial, Settings(law="best")).laws
    assert [law.name for law in laws] == ["polynomial-345"] * 2
    assert [law.peak for law in laws] == pytest.approx([0.5, 0.5], abs=0.02)


@pytest.mark.parametrize("law", ["linear", "empirical", "best"])
def test_laws_without_a_peak_take_none(law: Any) -> None:
    with pytest.raises(UsageError, match="leave --law-peak out"):
        settings_from(None, {"law": law, "law_peak": 0.4})


def test_an_asymmetric_law_moves_the_highest_velocity_of_the_model() -> None:
    trial = simulate_trial(marker_noise_mm=0.05).recording
    fraction = analyze(trial, Settings(law_peak=0.3)).interpolated.fraction
    assert int(np.argmax(np.diff(fraction[:211]))) == pytest.approx(0.3 * 211, abs=2)


@pytest.mark.parametrize("noise_deg", [0.05, 0.3])
def test_the_sd_of_a_fitted_peak_is_its_scatter(noise_deg: float) -> None:
    """Where the law's ends are known: white noise of the rotation, that of the two end poses in it."""
    random = np.random.default_rng(4)
    exact = asymmetric(LAWS["polynomial-345"], 0.55)(TAU)
    known = replace(PHASES, law_sd_s=np.zeros((1, 2)))
    found = [
        law_of("best", moved(exact + random.normal(0.0, noise_deg / 130.0, COUNT)), phases=known).law for _ in range(40)
    ]
    off = np.array([law.peak - 0.55 for law in found if law.peak is not None and law.name == "polynomial-345"])
    sd = np.array([law.peak_sd for law in found if law.name == "polynomial-345"])
    assert off.size >= 30
    assert np.sqrt(np.mean((off / sd) ** 2)) == pytest.approx(1.0, abs=0.35)


def test_a_peak_is_as_uncertain_as_the_ends_of_its_law() -> None:
    pose = moved(asymmetric(LAWS["polynomial-345"], 0.5)(TAU))
    sure, early = (replace(PHASES, law_sd_s=np.array([[sd, 0.0]])) for sd in (1e-6, 0.02))
    assert law_of("best", pose, phases=sure).law.peak_sd < 1e-3
    told = law_of("best", pose, phases=early).law.peak_sd
    # The same, by the fit to a share of the turn that begins so much later than it is taken to.
    late = asymmetric(LAWS["polynomial-345"], 0.5)(np.clip((TAU - 0.02) / 0.98, 0.0, 1.0))
    fitted = minimize_scalar(
        lambda peak: float(np.sum((asymmetric(LAWS["polynomial-345"], peak)(TAU) - late) ** 2)),
        bounds=(0.4, 0.6),
        method="bounded",
    ).x
    assert told == pytest.approx(abs(fitted - 0.5), rel=0.15)


def test_without_limits_of_the_ends_or_a_fit_there_is_no_sd() -> None:
    pose = moved(asymmetric(LAWS["cycloidal"], 0.4)(TAU))
    assert np.isnan(law_of("best", pose).law.peak_sd)
    assert np.isnan(law_of("cycloidal", pose, 0.4, replace(PHASES, law_sd_s=np.zeros((1, 2)))).law.peak_sd)
