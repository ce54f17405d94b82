"""Every number on the page and on the terminal is the result's, rounded, in its place and with its unit."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from recomputed import distal_points
from told_results import Told

RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
LOWERED = {ord(raised): chr(digit) for digit, raised in zip(RAISED, map(chr, RAISED.values()), strict=True)}
NUMBER = re.compile(r"(?<![\w.])[−-]?\d+(?:\.\d+)?(?:e[−+-]?\d+)?(?![\w.]*\d)")
NONE = "–"


def dec(value: Any, decimals: int = 2) -> str:
    """So many decimals, a true minus sign, no minus before zero, a dash where nothing is known."""
    if value is None or not math.isfinite(value):
        return NONE
    text = f"{abs(value):.{decimals}f}"
    return ("−" if value < 0.0 and float(text) else "") + text


def brief(value: float | None) -> str:
    """Two digits that count, written out; of less than 1e-4 with the power of ten."""
    if value is None:
        return NONE
    if value < 1e-4:
        mantissa, _, power = f"{value:.1e}".partition("e-")
        return f"{mantissa.removesuffix('.0')}·10⁻{str(int(power)).translate(RAISED)}"
    decimals = max(1 - math.floor(math.log10(value)), 0)
    return f"{float(f'{value:.1e}'):.{decimals}f}"


def plain(text: str) -> str:
    """As a terminal writes it: a minus is a hyphen."""
    return text.replace("−", "-")


def vec(values: Any, decimals: int) -> list[str]:
    return [dec(value, decimals) for value in values]


def general(value: float) -> str:
    return f"{value:g}"


def numbers(text: str, *names: str | None) -> list[str]:
    """Numbers and dashes that stand for one, without those that belong to names."""
    for name in sorted(filter(None, names), key=len, reverse=True):
        text = text.replace(name, " ")
    text = re.sub("·10⁻([⁰-⁹¹²³]+)", lambda power: f"e-{int(power[1].translate(LOWERED)):02d}", text)
    return re.findall(rf"{NUMBER.pattern}|(?<=[ ,(]){NONE}(?=[ ,)]|$)|^{NONE}", text)


def listed(frames: list[int]) -> list[str]:
    """Frame numbers as a terminal lists them: of many the first twelve, and how many more there are."""
    return [str(frame) for frame in frames[:12]] + ([str(len(frames) - 12)] if len(frames) > 12 else [])


def names_of(told: Told) -> list[str | None]:
    summary = told.summary
    return [
        summary["source"]["name"], summary["source"]["take"], *(body["name"] for body in summary["trial"]["bodies"]),
        summary["elbowscrew"],
    ]  # fmt: skip


# ---------------------------------------------------------------- page


def test_header_and_cards(told: Told) -> None:
    trial, motion, model = (told.summary[part] for part in ("trial", "motion", "interpolation"))
    (lead,) = (text for text in told.page.texts if " → " in text or "→" in text)
    expected = [str(trial["frames"]), f"{trial['rate_hz']:.6g}", dec(trial["duration_s"])]
    assert numbers(lead, *names_of(told))[:3] == expected
    assert f"{expected[0]} frames at {expected[1]} Hz · {expected[2]} s" in lead
    cards = told.page.terms
    signed = "" if motion["signed"] else "; without a sense: no axis dominates"
    assert cards["Largest angle θ"] == [
        f"{dec(motion['theta_max_deg'], 1)} deg",
        f"frame {motion['theta_max_frame']}; lowest {dec(motion['theta_min_deg'], 1)} deg{signed}",
    ]
    axis, two, ball = motion["joint_axis"], told.joint["two_axes"], told.joint["ball"]
    value, about = cards[f"{'Both axes' if two else 'Center' if ball else 'Joint axis'} known within"]
    if two:
        words = trial["joint"]
        assert axis is None
        assert value == f"{brief(two['axis1']['cone95_deg'])} and {brief(two['axis2']['cone95_deg'])} deg"
        assert about == (
            f"95 %, two axes ({told.joint['joint_type']['status']}), the first in the {words['proximal']}, "
            f"the second in the {words['distal']}"
        )
    elif ball:
        assert axis is None
        assert (value, about) == (
            f"{brief(ball['radius95_mm'])} mm",
            f"95 %, ball ({told.joint['joint_type']['status']})",
        )
    elif axis is None:
        assert (value, about) == (NONE, "the motion has no single axis")
    else:
        assert value == f"{brief(axis['axis_cone95_deg'])} deg, {brief(axis['point_radius95_mm'])} mm"
        assert about.startswith(f"95 %, {axis['model'].replace('_', '-')}")
        assert ("hardly" in about) == (axis["axis_cone95_deg"] > 30.0)
    assert cards["Dispersion of the axes"] == [
        f"{dec(motion['axis_dispersion_deg'])} deg",
        f"median by equal steps of θ; {dec(motion['axis_dispersion_all_frames_deg'])} deg over "
        f"{motion['axis_frames']} frames",
    ]
    assert cards["Model error"] == [
        f"{dec(model['rms_angle_error_deg'])} deg",
        f"RMS over time of the rotation, and {dec(model['rms_displacement_mm'])} mm of the RMS displacement; the model "
        f"covers {dec(100.0 * model['covered_share'], 1)} % of the recording",
    ]
    lost = trial["frames"] - trial["measured_frames"] - trial["filled_frames"]
    assert cards["Tracked"] == [
        f"{dec(100.0 * trial['measured_frames'] / trial['frames'], 1)} %",
        f"{trial['filled_frames']} frames filled in, {lost} lost",
    ]


def test_provenance(told: Told) -> None:
    source, trial = told.summary["source"], told.summary["trial"]
    terms = told.page.terms
    assert terms["Source"] == [told.source.name]
    assert terms["SHA-256"] == [source["sha256"]]
    assert terms["Layout"] == [f"{source['layout']}, {source['rotation']}, {source['length_unit']}"]
    assert terms["Bodies in the file"] == [", ".join(f"{body['name']} ({body['id']})" for body in trial["bodies"])]
    libraries = ", ".join(f"{name} {number}" for name, number in told.summary["versions"].items())
    assert terms["Analyzed with"] == [f"elbowscrew {told.summary['elbowscrew']}; {libraries}"]


def rows_after(told: Told, first: str) -> list[list[str]]:
    """Rows of the table whose head begins with a word."""
    rows = told.page.rows
    (start,) = (k for k, row in enumerate(rows) if row and row[0] == first)
    heads = {
        "Estimate", "Type tried", "Axis", "Frame", "No.", "Angle, deg", "Phase", "Error of the model", "Body",
        "To report", "Option",
    }  # fmt: skip
    found = []
    for row in rows[start + 1 :]:
        if row[0] in heads:
            break
        found.append(row)
    return found


def test_table_of_the_joints_axis(told: Told) -> None:
    joint = told.joint
    expected = []
    for name in ("mean_axis", "hinge", "screw_hinge", "weighted_mean", "sara"):
        fit = joint[name]
        if fit is None:
            continue
        left = [fit.get(key) for key in ("residual_rotation_deg", "residual_translation_mm")]
        expected.append(
            [
                ", ".join(vec(fit["direction"], 4)),
                ", ".join(vec(fit["point_mm"], 1)),
                dec(fit.get("axis_cone95_deg"), 3),
                dec(fit.get("point_radius95_mm"), 3),
                dec(fit.get("pitch_mm_per_rad")),
                NONE if left[0] is None else ", ".join(vec(left, 2)),
            ]
        )
    rows = rows_after(told, "Estimate")
    assert [row[1:7] for row in rows][: len(expected)] == expected
    marked = [row for row in rows if "preferred" in row[0]]
    assert len(marked) == (joint["preferred"] is not None)
    if marked:  # the one whose limits stand at the top of the page
        assert marked[0][3] == dec(told.summary["motion"]["joint_axis"]["axis_cone95_deg"], 3)


def test_tables_of_the_joints_type(told: Told) -> None:
    kind, two = told.joint["joint_type"], told.joint["two_axes"]
    assert f"Reason: {kind['reason']}." in told.page.texts
    left = {"hinge": "a hinge leaves ", "two_axes": "two axes leave ", "ball": "a ball joint leaves "}
    if kind["reason"].startswith(left.get(kind["type"], "a rigid joint leaves ")):
        (chosen,) = [one for one in kind["candidates"] if one["type"] == kind["type"]]
        said = [float(one) for one in numbers(kind["reason"])[:2]]
        assert said == pytest.approx([chosen["residual_deg"], chosen["residual_mm"]], rel=0.05)
    if kind["candidates"]:
        assert [row[1:] for row in rows_after(told, "Type tried")][: len(kind["candidates"])] == [
            [
                *(dec(one[name], 3) for name in ("residual_deg", "residual_mm")),
                dec(one["heldout_variance"]),
                *(str(one[name]) for name in ("shared", "per_frame")),
                "yes" if one["valid"] else "no",
            ]
            for one in kind["candidates"]
        ]
    if two is not None:
        words = told.summary["trial"]["joint"]
        axes = [two["axis1"], two["axis2"]]
        assert rows_after(told, "Of each axis") == [
            *(
                [f"{name}, {words[body]}{unit}", *(", ".join(vec(axis[key.format(body)], decimals)) for axis in axes)]
                for body in ("proximal", "distal")
                for name, key, decimals, unit in (
                    ("Direction", "direction_in_{}", 4, ""),
                    ("Point", "point_in_{}_mm", 1, ", mm"),
                )
            ),
            *(
                [f"95 % {name} there, and in the other, {unit}"]
                + [f"{dec(axis[f'{key}_{unit}'], 3)}, {dec(axis[f'{key}_other_{unit}'], 3)}" for axis in axes]
                for name, key, unit in (("cone", "cone95", "deg"), ("radius", "radius95", "mm"))
            ),
            *(
                [name, *(dec(axis[key], decimals) for axis in axes)]
                for name, key, decimals in (
                    ("Range, deg", "range_deg", 1),
                    ("Angle known to (sd), deg", "angle_sd_deg", 3),
                )
            ),
        ]


def test_table_of_single_axes(told: Told) -> None:
    screw = told.screw.set_index("frame")
    known = screw[(screw["valid"] == 1) & screw["axis_x"].notna()]
    rows = rows_after(told, "Frame")
    assert len(rows) == min(len(known), 24)
    assert [int(rows[0][0]), int(rows[-1][0])] == [known.index[0], known.index[-1]]
    for row in rows:
        one = known.loc[int(row[0])]
        assert row[1:] == [
            dec(one["time_s"], 3),
            dec(one["theta_deg"]),
            dec(one["slide_mm"]),
            ", ".join(vec([one[f"axis_{x}"] for x in "xyz"], 4)),
            ", ".join(vec([one[f"point_{x}_mm"] for x in "xyz"], 1)),
            dec(one["axis_cone95_deg"]),
            dec(one["point_radius95_mm"]),
        ]


def test_table_of_repetitions(told: Told) -> None:
    table = told.repetitions
    if not len(table):
        assert "No cycle was found." in told.page.text
        return
    rows = rows_after(told, "No.")
    assert [int(row[0]) for row in rows] == list(range(1, len(table) + 1))
    for row, (_, one) in zip(rows, table.iterrows(), strict=True):
        assert row[1:] == [
            ", ".join(str(int(one[f"{name}_frame"])) for name in ("start", "inversion", "end")),
            dec(one["duration_s"]),
            dec(one["theta_max_deg"], 1),
            dec(one["theta_range_deg"], 1),
            dec(one["slide_range_mm"]),
            f"{dec(one['outward_speed_deg_s'], 0)}, {dec(one['back_speed_deg_s'], 0)}",
            dec(one["axis_deviation_deg"]),
        ]


def test_tables_of_the_model(told: Told) -> None:
    model = told.summary["interpolation"]
    assert rows_after(told, "Phase") == [
        [
            str(k),
            law["law"],
            f"{law['start_frame']}, {law['end_frame']}",
            NONE if law["peak"] is None else f"{dec(100.0 * law['peak'], 0)} %",
            dec(law["rms_displacement_mm"]),
        ]
        for k, law in enumerate(model["phase_laws"], start=1)
    ]
    distal = told.summary["trial"]["joint"]["distal"].capitalize()
    assert rows_after(told, "Error of the model") == [
        ["Rotation, deg", dec(model["rms_angle_error_deg"]), dec(model["max_angle_error_deg"])],
        ["Angle θ, deg", dec(model["rmse_theta_deg"]), dec(model["max_theta_error_deg"])],
        [f"{distal}'s origin, mm", dec(model["rms_translation_error_mm"]), dec(model["max_translation_error_mm"])],
        ["Screw axis, deg", dec(model["rms_axis_error_deg"]), dec(model["max_axis_error_deg"])],
        ["Screw axis, mm", dec(model["rms_axis_distance_mm"]), dec(model["max_axis_distance_mm"])],
        ["RMS displacement of a frame, mm", dec(model["rms_displacement_mm"]), dec(model["max_rms_displacement_mm"])],
    ]


BONE_ANGLES = {
    "elbow": ("flexion", "carrying_angle", "pronation"),
    "knee": ("flexion", "adduction", "internal_rotation"),
}


def test_table_of_the_bones_angles(told: Told) -> None:
    anatomy = told.summary["motion"]["anatomy"]
    if anatomy is None:
        assert "Angle, deg" not in told.page.text
        assert "Flexion" not in told.page.terms
        return
    names = BONE_ANGLES[anatomy["joint"]]
    ranges = {name: " to ".join(dec(anatomy[name][f"{end}_deg"], 1) for end in ("min", "max")) for name in names}
    others = ", ".join(f"{name.replace('_', ' ')} {ranges[name]}" for name in names[1:])
    assert told.page.terms["Flexion"] == [f"{ranges['flexion']} deg", f"{others} deg"]
    rows = rows_after(told, "Angle, deg")
    assert [[row[0], *row[2:]] for row in rows] == [
        [name, *(dec(anatomy[key][f"{kind}_deg"], 1) for kind in ("start", "min", "max", "range"))]
        for name, key in ((name.replace("_", " ").capitalize(), name) for name in names)
    ]
    start = {
        "elbow": "arm. Angles of the forearm against the humerus",
        "knee": "leg. Angles of the tibia against the femur",
    }
    assert any(
        text.startswith(f"{anatomy['side'].capitalize()} {start[anatomy['joint']]} by ") for text in told.page.texts
    )


def test_table_of_the_tracking(told: Told) -> None:
    trial, rows = told.summary["trial"], rows_after(told, "Body")
    segments = [name for name in ("proximal", "distal") if trial[name] is not None]
    for row, segment in zip(rows, segments, strict=True):
        body, noise = trial[segment], told.joint["noise"][segment]
        lost = ", ".join(f"{count} {reason}" for reason, count in body["lost_frames"].items())
        source = "not known"
        if noise is not None:
            source = noise["source"]
            if noise["marker_noise_mm"] is not None:
                source += f" ({dec(noise['marker_noise_mm'])} mm a coordinate)"
        assert row == [
            body["name"],
            f"{dec(100.0 * body['tracked_share'], 1)} %",
            lost or NONE,
            dec(body["fastest_turn_deg_s"], 0),
            dec(body["fastest_speed_m_s"]),
            str(body["markers"]),
            dec((body["marker_residual_mm"] or {}).get("median")),
            dec((body["reported_error_mm"] or {}).get("median")),
            source,
        ]


def test_table_of_the_settings(told: Told) -> None:
    settings = told.summary["settings"]
    rows = {row[0]: row[1] for row in rows_after(told, "Option")}
    assert list(rows) == list(settings)
    given = {option.removeprefix("--") for option in told.options if option.startswith("--")}
    for option, value in settings.items():
        shown = rows[option].removesuffix("chosen").strip()
        if value is None:
            assert shown == "not set"
        elif isinstance(value, bool):
            assert shown == ("yes" if value else "no")
        elif isinstance(value, float):
            assert shown == general(value)
        else:
            assert shown == (", ".join(map(str, value)) if isinstance(value, list) else str(value))
        if option not in ("method", "law"):  # by default they go by the tolerance
            usual = option == "method" and settings["tolerance"] is not None
            assert ("chosen" in rows[option]) == (option in given and not usual), option


def texts_with_numbers(told: Told) -> Iterator[tuple[str, list[str]]]:
    """Beginning of each text of the page that holds numbers, and the numbers it should hold."""
    summary, joint = told.summary, told.joint
    trial, motion, model, settings = (summary[part] for part in ("trial", "motion", "interpolation", "settings"))
    poses, axis_frames = str(len(model["keyframes"])), motion["axis_frames"]
    laws = list(dict.fromkeys(law["law"] for law in model["phase_laws"]))
    screw = told.screw
    reach = 1.959964 * screw["theta_sd_deg"]
    interval = ["95", f"{reach.median():.2g}"] if reach.notna().any() else []
    joint_axis = "joint axis" if motion["joint_axis"] else "mean axis"
    yield r"(moving )?(not tracked )?(filled in )?(95 % interval .*)?measured .*keyframes$", [*interval, poses]
    yield r"(moving )?(not tracked )?(filled in )?measured .*keyframes 95 % interval: .* drawn$", [poses, *interval]
    yield (
        "Measured and modeled rotation angle",
        [dec(screw["time_s"].iloc[-1] - screw["time_s"].iloc[0]), plain(dec(motion["theta_max_deg"], 1)),
         str(motion["theta_max_frame"])],
    )  # fmt: skip
    yield (
        rf"Rotation θ since the reference .*through.*{' and '.join(laws)} law, {model['blend']}\)\.",
        [str(trial["reference_frame"]), poses, *map(str, motion["inversion_frames"])],
    )
    if joint["two_axes"] is not None:
        yield r"In the .*Axis 1 is fixed in the .*, axis 2 goes with the ", ["1", "2", "95", "95", "57"]
    else:
        black = "the center" if joint["ball"] is not None else joint_axis
        yield rf"In the .*Black \(white in the dark\): {black}", ["95", "95", "57"]
    yield r"95 % of the frames' axes", ["95", "95"] if motion["joint_axis"] else ["95"]
    yield rf"The {joint_axis} and the axes of", [str(min(axis_frames, 60))]
    yield rf"Axes of the frames about the {joint_axis}", [general(settings["min-angle"])]
    spread = joint["dispersion"]
    positions = [dec(spread[f"position_{kind}_mm"]) for kind in ("median", "rms", "95", "max")]
    positions.insert(2, "95")
    yield (
        "Dispersion of the frames' axes",
        [
            *(dec(spread[f"direction_{kind}_deg"]) for kind in ("median", "rms")),
            "95",
            *(dec(spread[f"direction_{kind}_deg"]) for kind in ("95", "max")),
            *([] if spread["position_rms_mm"] is None else positions),
        ],
    )
    kind, two, ball = joint["joint_type"], joint["two_axes"], joint["ball"]
    yield "Reason: ", numbers(kind["reason"])
    if two is not None:
        names = [f"{name}{end}" for name in ("angle_between_deg", "distance_mm") for end in ("", "_low", "_high")]
        yield "The axes are", [dec(two[name], 1) for name in names]
        yield "The angle θ mixes rotations about both axes", wanders_of_both(two)
    if ball is not None:
        within = [] if ball["radius95_mm"] is None else [dec(ball["radius95_mm"])]
        yield (
            "The center is at",
            [
                *vec(ball["center_in_proximal_mm"], 1),
                *within,
                *vec(ball["center_in_distal_mm"], 1),
                *vec(ball["score"]["center_in_proximal_mm"], 1),
                *vec(ball["score"]["center_in_distal_mm"], 1),
            ],
        )
    if joint["second_rotation"] is not None:
        second = joint["second_rotation"]
        axis = second["axis"]
        yield (
            "Beside the hinge there is",
            [dec(second["range_deg"]), *([] if axis is None else vec(axis["direction_in_distal"], 4))],
        )
    if joint["wander"] is not None:
        size = "size" if joint["wander"]["significant"] else "unseen"
        sizes = [dec(joint["wander"][f"{size}_{unit}"]) for unit in ("deg", "mm")]
        yield ("The axis wanders by" if size == "size" else "The axis is not seen to wander"), sizes
    yield "95 % of each toward", ["95"]
    yield "The joint's axis against its angle", ["95"]
    if two is not None or ball is not None:
        yield from own_angles(told)
    yield "The 95 % intervals are those of", ["95"]
    if joint["sensitivity_deg_per_deg"] is not None:
        yield "Each degree that a cluster turns", [dec(joint["sensitivity_deg_per_deg"])]
    if joint["skin_motion"] is not None:
        stated = joint["skin_motion"]
        yield "Stated and included is", [dec(stated[name]) for name in ("mm", "deg", "part_deg", "part_mm")]
    yield r"\d+ of \d+ frames; all stand in screw.csv", [str(min(axis_frames, 24)), str(axis_frames)]
    count, again = str(len(told.repetitions)), joint["repeatability"]
    yield r"± standard deviation mean of", [count]
    if int(count) > 1:
        most = told.table("repetition_curve")["theta_sd_deg"].max()
        yield r"mean of \d+ repetitions standard deviation: .* deg at most, too narrow", [count, f"{most:.2g}"]
    yield "Mean and standard deviation of the angle over", [count]
    yield (
        "Mean angle over the cycles",
        [
            "1",  # of the name ICC(A,1)
            dec(again["icc"], 3),
            dec(again["cmc"], 3),
            *(dec(again[name]) for name in ("axis_sd_deg", "point_sd_mm", "theta_max_sd_deg")),
        ],
    )
    selected = model["selection"]
    frames = model["keyframes"]
    told_frames = frames if len(frames) <= 24 else [*frames[:3], frames[-1], len(frames)]
    yield (
        r"\S+ through \d+ poses \(frames",
        [poses, *map(str, told_frames)]
        + ([] if selected is None else [general(selected["tolerance_mm"]), dec(selected["compression_ratio"], 1)]),
    )
    radius = np.sqrt(np.mean(np.sum((distal_points(told) - distal_points(told).mean(axis=0)) ** 2, axis=1)))
    yield (
        "Angle between modeled and measured orientation, and RMS displacement in each frame, over points",
        [general(radius)],
    )
    clock = trial["clock"]
    yield (
        "Residual and error are medians",
        [str(clock["missing_frames"]), str(clock["repeated_frames"]), dec(1000.0 * clock["largest_offset_s"])],
    )
    if joint["anatomy"] is not None:
        anatomy = joint["anatomy"]
        ends = [f"{name}{end}" for name in ("axis_angle_deg", "axis_distance_mm") for end in ("", "_low", "_high")]
        yield "The joint axis lies", [dec(anatomy[end]) for end in ends]
        year = {"elbow": "2005", "knee": "1983"}[anatomy["joint"]]
        yield rf"{anatomy['side'].capitalize()} (arm|leg)\. Angles of", [year]
        yield "In brackets stand", ["95", dec(anatomy["landmark_sensitivity_deg_per_mm"])]
        centers = [vec(anatomy[f"joint_center_in_{body}_mm"], 1) for body in ("proximal", "distal")]
        yield "The joint's center is the point midway", centers[0] + centers[1]
    severe = sum(warning["severity"] == "warning" for warning in summary["warnings"])
    yield r"\d+ warnings?|\d+ notes?|No warnings", [str(n) for n in (severe, len(summary["warnings"]) - severe) if n]
    yield "After the ISB's recommendations", ["1995", "2005"]
    yield "elbowscrew, version", []


def own_angles(told: Told) -> Iterator[tuple[str, list[str]]]:
    """Keys, description and caption of the chart of the joint's own angles."""
    table = told.table("joint_angles")
    keys, behind = [], []
    names = [column.removesuffix("_sd_deg") for column in map(str, table) if column.endswith("_sd_deg")]
    angles = table[[f"{name}_deg" for name in names]].to_numpy()
    span = np.nanmax(angles) - np.nanmin(angles)
    for name in names:
        reach = 1.959964 * table[f"{name}_sd_deg"].dropna()
        number = re.findall(r"\d", name)  # of an axis
        told_reach = ["95", *number, f"{reach.median():.2g}"] if len(reach) else []
        if len(reach) and np.percentile(reach, 95.0) > 0.007 * span:
            keys += told_reach
        else:
            behind += told_reach  # too narrow to be drawn
        keys += number
    yield r"(not tracked )?(filled in )?(95 % interval of )?(Angle 1|Rotation x)\b(?!, )", keys + behind
    yield "Angle 1, Angle 2 over time; on the right Angle 2 against Angle 1", ["1", "2", "2", "1"]
    yield "The joint's own angles since the reference, about axis", ["1", "2"]


def test_every_other_number_on_the_page_is_looked_at(told: Told) -> None:
    """Captions, keys and notes; the methods paragraph has its own tests, and e0 to e3 are names."""
    messages = [" ".join(warning["message"].split()) for warning in told.summary["warnings"]]
    expected = list(texts_with_numbers(told))
    for text in told.page.texts:
        # Two badges side by side have no blank between them.
        found = numbers(re.sub(r"warnings?(?=\d)", r"\g<0> ", text), "BSD-3", *names_of(told))
        if (
            not found
            or text.startswith(("Poses of the segments", "Pennestrì", "Wu G,", "Grood ES,", "e0 to e3"))
            or "→" in text
        ):
            continue
        if any(text.startswith(message) for message in messages):
            continue
        ((start, wanted),) = [(start, wanted) for start, wanted in expected if re.match(start, text)] or [("", [])]
        assert start, f"numbers that nobody looks at: {text}"
        assert found == wanted, text
    for message in messages:
        assert any(text.startswith(message) for text in told.page.texts), message


def test_what_intervals_include_is_said_wherever_there_are_some(told: Told) -> None:
    method = told.joint["joint_type"]["interval_method"]
    said = [text for text in told.page.texts if text.startswith("The 95 % intervals are those of the clusters")]
    assert [f", {method}. They hold if" in text for text in said] == [True] * (method is not None)


# ---------------------------------------------------------------- terminal


def test_terminal(told: Told) -> None:
    trial, motion, model, settings = (told.summary[part] for part in ("trial", "motion", "interpolation", "settings"))
    title, *lines = told.terminal.splitlines()
    assert title.strip() == told.source.name
    said = {line[:13].strip(): line[13:].strip() for line in lines}
    expected = {
        "Bodies": [dec(100.0 * body["tracked_share"], 1) for body in (trial["proximal"], trial["distal"]) if body],
        "Frames": [
            str(trial["frames"]),
            f"{trial['rate_hz']:.6g}",
            dec(trial["duration_s"]),
            *(
                str(count)
                for count in (trial["filled_frames"], int((told.screw["valid"] + told.screw["filled"] == 0).sum()))
                if count
            ),
        ],
        "Angle θ": [dec(motion["theta_min_deg"]), dec(motion["theta_max_deg"])],
        "Inversion": listed(motion["inversion_frames"]),
        "Slide": [dec(motion[f"slide_{kind}_mm"]) for kind in ("median", "min", "max")],
        "Mean axis": [*vec(motion["mean_axis"]["direction"], 4), *vec(motion["mean_axis"]["point_mm"], 1)],
        "Joint": numbers(told.joint["joint_type"]["reason"]),
        "Joint axis": joint_axis_numbers(told),
        **anatomy_numbers(motion["anatomy"]),
        "Dispersion": [
            dec(motion["axis_dispersion_deg"]),
            dec(motion["axis_dispersion_all_frames_deg"]),
            str(motion["axis_frames"]),
        ],
        "Model": [*listed(model["keyframes"]), dec(100.0 * model["covered_share"], 0)],
        "Model error": [
            dec(model["rms_angle_error_deg"]),
            dec(model["max_angle_error_deg"]),
            str(model["max_angle_error_frame"]),
            dec(model["rms_displacement_mm"]),
            *([] if model["points"]["from"] == "markers" else [general(model["points"]["radius_of_gyration_mm"])]),
        ],
    }
    assert set(said) == {*expected, "Results", "Open"}
    assert said["Results"] == str(told.folder)
    assert said["Open"] == str(told.folder / "report.html")
    for name, values in expected.items():
        assert numbers(said[name], *names_of(told)) == [plain(value) for value in values], said[name]
    assert ("without a sense" in said["Angle θ"]) == (not motion["signed"])
    assert f"in the {told.frame_of_screws} frame" in said["Mean axis"]
    assert said["Model"].startswith(f"{settings['method']} {settings['blend']}, {settings['law']} law")
    assert "still" in said["Bodies"] or trial["proximal"] is not None
    for name in ("filled", "lost"):
        assert (name in said["Frames"]) == any(text.endswith(name) for text in said["Frames"].split(", "))


def anatomy_numbers(anatomy: Any) -> dict[str, list[str]]:
    if anatomy is None:
        return {}
    angles = [anatomy[name] for name in BONE_ANGLES[anatomy["joint"]]]
    ends = [f"{name}{end}" for name in ("axis_angle_deg", "axis_distance_mm") for end in ("", "_low", "_high")]
    return {
        "Anatomy": [dec(angle[f"{kind}_deg"]) for angle in angles for kind in ("min", "max", "start")],
        "Epicondyles": [
            *(dec(anatomy[end]) for end in ends), "95", f"{anatomy['landmark_sensitivity_deg_per_mm']:.2g}"
        ],
    }  # fmt: skip


def wanders_of_both(two: dict[str, Any]) -> list[str]:
    """The numbers of the sentences on the wander of each axis: those that wander come first."""
    found, unseen = [], []
    for k in (1, 2):
        wander = two[f"axis{k}"]["wander"]
        if wander["significant"]:
            found += [str(k), *(dec(wander[f"size_{unit}"]) for unit in ("deg", "mm"))]
        else:
            unseen += [dec(wander["unseen_deg"]), str(k)]
    return found + unseen


def joint_axis_numbers(told: Told) -> list[str]:
    axis, found = told.summary["motion"]["joint_axis"], told.joint["joint_type"]
    if axis is not None:
        fit = told.joint[told.joint["preferred"]] | (told.joint["mean_axis"] or {})
        wander, second = told.joint["wander"], told.joint["second_rotation"]
        beside: list[str] = []
        if wander is not None:
            names = ("size_deg", "size_mm") if wander["significant"] else ("unseen_deg",)
            beside += [f"{wander[name]:.2g}" for name in names]
        if second is not None:
            beside += [f"{second['range_deg']:.2g}", *(vec(second["axis"]["direction"], 4) if second["axis"] else [])]
        return [
            *vec(fit["direction"], 4),
            f"{fit['axis_cone95_deg']:.2g}",
            *vec(fit["point_mm"], 1),
            f"{fit['point_radius95_mm']:.2g}",
            "95",
            f"{fit['sensitivity_deg_per_deg']:.2g}",
            *beside,
        ]
    if found["type"] == "two_axes":
        axes = told.joint["two_axes"]
        told_axes = []
        for k, body in ((1, "proximal"), (2, "distal")):
            axis = axes[f"axis{k}"]
            told_axes += [str(k), *vec(axis[f"direction_in_{body}"], 4), f"{axis['cone95_deg']:.2g}"]
            told_axes += [dec(axis["range_deg"], 0)]
            names = ("size_deg", "size_mm") if axis["wander"]["significant"] else ("unseen_deg",)
            told_axes += [f"{axis['wander'][name]:.2g}" for name in names]
        return [*told_axes, dec(axes["angle_between_deg"], 1), dec(abs(axes["distance_mm"]), 1), "95"]
    ball = told.joint["ball"]
    within = [] if ball["radius95_mm"] is None else [f"{ball['radius95_mm']:.2g}"]
    return [*vec(ball["center_in_proximal_mm"], 1), *within, "95"]
