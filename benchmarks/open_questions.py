"""The paper's open questions on samples, synthetic elbows and real hinges: tables, and the figure of docs/images.

Real hinges are taken in where ELBOWSCREW_REAL_DATA names their folder.
Run: python benchmarks/open_questions.py [FOLDER OF THE FIGURE]
     python benchmarks/open_questions.py --elbows       (how few numbers describe an elbow, alone)
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew import Comparison, ComparisonPlan, Recording, Settings, analyze, compare, read_recording, simulate_trial
from elbowscrew.choices import MethodName
from elbowscrew.errors import SettingError
from elbowscrew.plots import layout, style
from elbowscrew.plots.comparison import plain_ticks, series_look

ROOT = Path(__file__).parent.parent
METHODS: Final = ("dlb", "sclerp", "dib")
LAWS: Final = (
    "linear",
    "cycloidal",
    "harmonic",
    "polynomial-345",
    "polynomial-4567",
    "modified-sine",
    "best",
    "empirical",
)
COUNTS = (2, 3, 4, 5, 6, 8)
NOISE = {"marker_noise_mm": 0.05, "proximal": "moving"}


def motions() -> Iterator[tuple[str, Recording, Settings]]:
    for path in sorted((ROOT / "sample_data").glob("*.csv")):
        yield f"sample {path.stem.removeprefix('elbow_').replace('_', ' ')}", read_recording(path), Settings()
    rests: dict[str, Any] = {"rest_before_s": 1.0, "hold_s": 0.8, "rest_after_s": 1.0}
    elbows: dict[str, dict[str, Any]] = {
        "smooth elbow": {},
        "elbow with rests": rests,
        "jerky elbow": {"tremor_deg": 2.0},
        "elbow, axis drifts 5 deg": {"wander_deg": 5.0},
        "cycloidal elbow": {"law": "cycloidal"},
    }
    for name, changes in elbows.items():
        yield name, simulate_trial(**{**NOISE, **changes}, seed=1).recording, Settings()
    folder = os.environ.get("ELBOWSCREW_REAL_DATA", "")
    for take in ("20230627_0117", "20230706_122504"):
        for proximal, distal in ((1, 2), (2, 3)):
            path = Path(folder) / "real" / f"v121_thomazach_{take}.csv"
            if folder and path.exists():
                settings = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {distal}")
                yield f"hinge {take[4:]} {proximal}-{distal}", read_recording(path), settings


def values(found: Comparison, of: str = "rms_displacement", **wanted: Any) -> NDArray[np.float64]:
    models = found.models
    chosen = np.logical_and.reduce([getattr(models, name) == value for name, value in wanted.items()])
    result: NDArray[np.float64] = getattr(models, of)[chosen & (models.note == "")]
    return result


def least(found: Comparison, of: str = "rms_displacement", **wanted: Any) -> float:
    return float(values(found, of, **wanted).min(initial=np.inf))


def fewest(found: Comparison, of: str, limit: float, **wanted: Any) -> str:
    for count in COUNTS:
        if least(found, of, keyframes_per_phase=count, **wanted) <= limit:
            return str(count)
    return f"over {COUNTS[-1]}"


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    plan = ComparisonPlan(methods=METHODS, laws=LAWS, blends=("piecewise",), counts=COUNTS, decimation=(2, 4, 10))
    results: dict[str, Comparison] = {}
    for name, recording, settings in motions():
        results[name] = compare(recording, settings, plan)
        sys.stderr.write(f"{name}\n")
    print("\n## law of each phase that fits best, and RMS displacement (mm) of ScLERP, two poses a phase\n")
    shown = ("linear", "harmonic", "polynomial-345", "cycloidal", "polynomial-4567", "best", "empirical")
    print("| motion | phases | best law (peak) | " + " | ".join(shown) + " |")
    print("| --- " * (len(shown) + 3) + "|")
    for name, found in results.items():
        laws = [f"{law.name} ({law.peak:.2f})" if law.peak else law.name for law in found.laws["best"]]
        told = ", ".join(laws[:2]) + (", ..." if len(laws) > 2 else "")
        numbers = [least(found, data="raw", method="sclerp", law=law, keyframes_per_phase=2) for law in shown]
        print(f"| {name} | {len(laws)} | {told} | " + " | ".join(f"{1e3 * x:.2f}" for x in numbers) + " |")
    print("\n## poses a phase for 1 deg and for 1 mm (RMS)\n")
    for law in ("cycloidal", "best"):
        print(f"\nlaw: {law}\n\n| motion | " + " | ".join(f"{m}, 1 deg | {m}, 1 mm" for m in METHODS) + " |")
        print("| --- " * (2 * len(METHODS) + 1) + "|")
        for name, found in results.items():
            cells = []
            for method in METHODS:
                of_method: dict[str, Any] = {"data": "raw", "law": law, "method": method}
                cells.append(fewest(_filled(found, method), "rms_angle_error", float(np.radians(1.0)), **of_method))
                cells.append(fewest(_filled(found, method), "rms_displacement", 1e-3, **of_method))
            print(f"| {name} | " + " | ".join(cells) + " |")
    print("\n## fewest poses in all, constant speed between, within 2 mm at every frame\n")
    print("| motion | frames | keyframes |\n| --- | --- | --- |")
    for name, found in results.items():
        selection = found.selections["sclerp"]
        print(f"| {name} | {selection.frames} | {selection.row.size} |")
    print("\n## RMS displacement (mm) from the measured motion, keyframes from: (best law, ScLERP, 2 and 4 poses)\n")
    for name, found in results.items():
        cells = []
        for data in dict.fromkeys(found.models.data.tolist()):
            pair = [least(found, data=data, method="sclerp", law="best", keyframes_per_phase=n) for n in (2, 4)]
            cells.append(f"{data}: {1e3 * pair[0]:.2f} {1e3 * pair[1]:.2f}")
        print(f"{name}: " + "; ".join(cells))
    print("\n## DLB, ScLERP, DIB: RMS displacement (mm) over poses a phase, best law\n")
    for name, found in results.items():
        for method in METHODS:
            same = _filled(found, method)
            curve = [least(same, data="raw", method=method, law="best", keyframes_per_phase=n) for n in COUNTS]
            print(f"{name:30s} {method:8s} " + " ".join(f"{1e3 * x:7.3f}" for x in curve))
    elbow = results["smooth elbow"]
    times = {m: float(np.median(values(elbow, "ns_per_frame", method=m, keyframes_per_phase=5))) for m in METHODS}
    print("\nns/frame, 5 poses:", {method: round(time) for method, time in times.items()})
    if target is not None:
        draw(results, target)


ELBOW_METHODS: Final = ("joint", "sclerp", "dlb")
_SEARCHED: tuple[MethodName, ...] = ("joint", "sclerp")
LIMITS_MM = (1.0, 2.0, 5.0)
SHARED, OF_JOINT, OF_POSE = 12, 2, 6
"""Numbers of two axes, of a pose that moves about them, and of a pose; times and laws are the same for all."""


def elbows() -> None:
    """Keyframes and numbers that describe elbows with two axes."""
    trials = {"natural elbow": ROOT / "sample_data" / "elbow_natural.csv"}
    real = Path(os.environ.get("ELBOWSCREW_REAL_DATA", "")) / "cases" / "das3_real_motion.csv"
    if real.exists():
        trials["real angles on published axes"] = real
    plan = ComparisonPlan(
        methods=ELBOW_METHODS, laws=("best",), blends=("piecewise",), counts=tuple(range(2, 21)), data=("raw",)
    )
    print("\n## keyframes in all (evenly in each phase, best law), and numbers, by RMS displacement\n")
    print("| motion | within | " + " | ".join(ELBOW_METHODS) + " |\n| --- | --- | --- | --- | --- |")
    for name, path in trials.items():
        models = compare(read_recording(path), plan=plan).models
        for limit in LIMITS_MM:
            cells = []
            for method in ELBOW_METHODS:
                # Of two poses a phase DLB is sDLB.
                mine = (models.method == method) | ((method == "dlb") & (models.method == "sdlb"))
                kept = models.keyframes[mine & (models.rms_displacement <= 1e-3 * limit)]
                cells.append(_numbers(method, int(kept.min())) if kept.size else "over 20 a phase")
            print(f"| {name} | {limit:g} mm | " + " | ".join(cells) + " |")
    print("\n## fewest keyframes, constant speed between, by the largest displacement\n")
    print("| motion | within | joint | sclerp |\n| --- | --- | --- | --- |")
    for name, path in trials.items():
        recording = read_recording(path)
        for limit in LIMITS_MM:
            cells = []
            for method in _SEARCHED:
                try:
                    found = analyze(recording, Settings(method=method, tolerance_mm=limit))
                    cells.append(_numbers(method, found.keyframes.row.size))
                except SettingError:
                    cells.append("–")
            print(f"| {name} | {limit:g} mm | " + " | ".join(cells) + " |", flush=True)


def _numbers(method: str, keyframes: int) -> str:
    numbers = SHARED + OF_JOINT * keyframes if method == "joint" else OF_POSE * keyframes
    return f"{keyframes}, {numbers}"


def _filled(found: Comparison, method: str) -> Comparison:
    """Tell two poses of ScLERP as those of DIB, which are the same: the comparison has them once."""
    if method != "dib":
        return found
    models = found.models
    method_names = models.method.copy()
    same = (models.method == "sclerp") & (models.keyframes_per_phase == 2)
    method_names[same] = "dib"
    return replace(found, models=replace(models, method=method_names))


def draw(results: dict[str, Comparison], target: Path) -> None:
    target.mkdir(parents=True, exist_ok=True)
    names = list(results)
    with style.publication_style():
        figure = style.new_figure(170.0, 95.0)
        laws, poses = figure.subplots(1, 2, width_ratios=[1.0, 1.0])
        for k, law in enumerate(("linear", "cycloidal", "harmonic", "polynomial-345", "best", "empirical")):
            of_law: dict[str, Any] = {"data": "raw", "method": "sclerp", "law": law, "keyframes_per_phase": 2}
            x = [1e3 * float(values(results[name], **of_law).min()) for name in names]
            laws.plot(x, range(len(names)), label=law, **series_look(k, line=False))
        laws.set_yticks(range(len(names)), names)
        laws.invert_yaxis()
        laws.set_xscale("log")
        plain_ticks(laws.xaxis)
        laws.grid(axis="y", linewidth=0.4, color="#DDDDDD")
        laws.set_xlabel("RMS displacement (mm)")
        laws.set_title("a", loc="left")
        laws.set_title("two poses a phase, ScLERP", loc="center", fontweight="normal")
        laws.legend(loc="upper center", bbox_to_anchor=(0.4, -0.16), ncols=2)
        shown = [name for name in names if not name.startswith("sample") and name != "cycloidal elbow"]
        for k, name in enumerate(shown):
            selection = results[name].selections["sclerp"]
            look = {**series_look(k, line=True), "marker": ""}
            poses.plot(selection.count, 1e3 * selection.largest, label=name, **look)
        poses.axhline(2.0, **style.LEVEL)
        poses.set_xscale("log")
        poses.set_yscale("log")
        for axis in (poses.xaxis, poses.yaxis):
            plain_ticks(axis)
        poses.set_xlabel("Keyframes in all, chosen best (–)")
        poses.set_ylabel("Largest RMS displacement (mm)")
        poses.set_title("b", loc="left")
        poses.set_title("constant speed between, ScLERP", loc="center", fontweight="normal")
        poses.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=6.5)
        layout.settle(figure)
        figure.savefig(target / "how-few-poses.png", dpi=200, metadata={"Software": None})


if __name__ == "__main__":
    if "--elbows" not in sys.argv:
        main()
    elbows()
