"""Every key that a template reads is one that the JSON files have, in branches that no result takes, too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import pytest
from jinja2 import Environment, nodes
from typing_extensions import is_typeddict

from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.summary_types import (
    ModelSummary,
    MotionSummary,
    PhaseLawSummary,
    QualitySummary,
    SourceSummary,
    Summary,
    TrialSummary,
    WarningSummary,
)
from elbowscrew.report.checklist import Entry
from elbowscrew.report.measures import Measure
from elbowscrew.report.study import Failure
from elbowscrew.report.study_differences import DifferenceRow, Differences
from elbowscrew.report.study_groups import AxisRow, NumberRow
from elbowscrew.report.study_page import Factor
from elbowscrew.report.trials_table import TrialRow

TYPES: dict[str, Any] = {
    "summary": Summary,
    "source": SourceSummary,
    "trial": TrialSummary,
    "motion": MotionSummary,
    "model": ModelSummary,
    "joint": JointSummary,
    "law": PhaseLawSummary,
    "warning": WarningSummary,
}
"""What `elbowscrew.report.trial_page` and its loops call the parts of a result."""
STUDY_TYPES: dict[str, Any] = {
    "row": TrialRow,
    "number": NumberRow,
    "differences": Differences,
    "difference": DifferenceRow,
    "axis": AxisRow,
    "factor": Factor,
    "column": Measure,
    "failure": Failure,
}
"""What `elbowscrew.report.study_page` and its loops call the parts of a study."""
SPACE_TYPES: dict[str, Any] = {"joint": JointSummary, "motion": MotionSummary}
"""What the view in space calls them, on the page and alone."""
TEMPLATES = {
    "trial.html": TYPES, "study.html": STUDY_TYPES, "base.html": {}, "viewer.html": SPACE_TYPES, "space.html": {},
    "checklist.html": {"entry": Entry},
}  # fmt: skip
METHODS = {"items", "lower", "startswith"}


def unknown(tree: nodes.Template, types: Mapping[str, Any]) -> Iterator[str]:
    for node in tree.find_all((nodes.Getattr, nodes.Getitem)):
        yield from unknown_in(node, types)


def unknown_in(node: Any, types: Mapping[str, Any]) -> Iterator[str]:
    path, inner = [], node
    while isinstance(inner, nodes.Getattr | nodes.Getitem):
        key = inner.attr if isinstance(inner, nodes.Getattr) else getattr(inner.arg, "value", None)
        path.append(key)
        inner = inner.node
    if not isinstance(inner, nodes.Name) or inner.name not in types:
        return
    kind: Any = types[inner.name]
    for key in reversed(path):
        if key in METHODS or not isinstance(key, str):
            return
        if not has_keys(kind) or key not in get_type_hints(kind):
            yield ".".join([inner.name, *map(str, reversed(path))])
            return
        kind = only(get_type_hints(kind)[key])


def has_keys(kind: Any) -> bool:
    return is_typeddict(kind) or hasattr(kind, "_fields") or is_dataclass(kind)


def only(kind: Any) -> Any:
    """Take a type without None."""
    if get_origin(kind) in (Union, UnionType):
        (kind,) = (one for one in get_args(kind) if one is not NoneType)
    return kind


@pytest.fixture
def source(root: Path) -> str:
    return template(root, "trial.html")


def template(root: Path, name: str) -> str:
    return (root / "src" / "elbowscrew" / "report" / "templates" / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", TEMPLATES)
def test_keys_of_a_template_are_keys_of_what_it_shows(root: Path, name: str) -> None:
    source, types = template(root, name), TEMPLATES[name]
    assert list(unknown(Environment(autoescape=True).parse(source), types)) == []
    assert {one for one in types if f"{one}." in source} == set(types)


def test_every_template_is_looked_at(root: Path) -> None:
    folder = root / "src" / "elbowscrew" / "report" / "templates"
    assert {path.name for path in folder.iterdir()} == set(TEMPLATES)


@pytest.mark.parametrize(
    "key",
    ["row.outlier", "column.decimals", "factor.levels", "number.found.icc", "difference.found.low", "axis.point_sd"],
)
def test_a_misspelled_key_of_a_study_is_seen(root: Path, key: str) -> None:
    source = template(root, "study.html")
    assert key in source
    assert list(unknown(Environment(autoescape=True).parse(source.replace(key, f"{key}x")), STUDY_TYPES))


@pytest.mark.parametrize(
    "key", ["motion.theta_max_deg", "joint.repeatability.icc", "law.peak", "model.points.radius_of"]
)
def test_a_misspelled_key_is_seen(source: str, key: str) -> None:
    assert key in source
    assert list(unknown(Environment(autoescape=True).parse(source.replace(key, f"{key}x")), TYPES))


def test_the_quality_of_a_body_has_the_keys_of_its_row(source: str) -> None:
    rows = source[source.index("{% for body in bodies %}") : source.index("Residual and error are medians")]
    row = rows[: rows.index("{% endfor %}", rows.index("noise.source"))]
    tree = Environment(autoescape=True).parse(row + "{% endfor %}")
    assert list(unknown(tree, {"body": QualitySummary})) == []
    assert list(unknown(tree, {"body": WarningSummary}))
