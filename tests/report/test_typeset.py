"""A page is set as print is: text alone, and what users and files named not at all."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from elbowscrew.report.typeset import typeset

HELD = "\N{NO-BREAK SPACE}"


def told(text: str, *names: str) -> str:
    return typeset(f"<body>{text}", names).removeprefix("<body>")


@pytest.mark.parametrize(
    ("plain", "printed"),
    [
        ("the 95 % interval", "the 95~% interval"),
        ("±0.58 deg and 1.4 mm at 100 Hz", "±0.58~deg and 1.4~mm at 100~Hz"),
        ("1.35 mm/rad, 12 deg/s, 0.25 rad/s, 9 m/s", "1.35~mm/rad, 12~deg/s, 0.25~rad/s, 9~m/s"),
        ("4.6·10⁻⁵ m", "4.6·10⁻⁵~m"),
        ("50 % ± 0.3 %", "50~% ±~0.3~%"),
        ("5 short stretches in 3 models, 2 minutes", "5 short stretches in 3 models, 2 minutes"),
        ("-3.5 to -2 deg, e-5, 1-2, 2026-11-28, --2", "−3.5 to −2~deg, e-5, 1-2, 2026-11-28, --2"),
        ("the joint's axis, the frames&#39; axes", "the joint’s axis, the frames’ axes"),
        ("body 'Pelvis' of &#39;Bob&#x27;s arm&#39; has", "body ‘Pelvis’ of ‘Bob’s arm’ has"),
        ("<dd>130.0<small> deg</small></dd>", "<dd>130.0<small>~deg</small></dd>"),
        ("<td>130.0</td><td> deg</td>", "<td>130.0</td><td> deg</td>"),
        ("is 3<span> of 5 mm</span>", "is 3<span> of 5~mm</span>"),
    ],
)
def test_text_is_set(plain: str, printed: str) -> None:
    printed = printed.replace("~", HELD)
    assert told(plain) == printed
    assert told(printed) == printed


@pytest.mark.parametrize(
    "kept",
    [
        "<script>x = '-1' - -3; y = '5 mm'</script>",
        "<style>a::after { content: '5 mm'; margin: -3px }</style>",
        "<pre>it's 5 mm</pre>",
        "<code>it's 5 mm</code>",
        '<svg><metadata>["it\'s 5 mm", -3]</metadata></svg>',
        '<path d="M-3 -5" aria-label="it\'s 5 mm"/>',
        '<h1 translate="no">it\'s <b>5 mm</b></h1>',
        '<table id="t" translate="no"><tr><td>-3 mm</td></tr></table>',
    ],
)
def test_what_is_no_text_stays_as_it_is(kept: str) -> None:
    assert told(f"5 mm {kept} 5 mm") == f"5{HELD}mm {kept} 5{HELD}mm"


def test_the_head_stays_as_it_is() -> None:
    assert typeset("<title>it's 5 mm</title><body>5 mm") == f"<title>it's 5 mm</title><body>5{HELD}mm"


def test_names_stay_letter_by_letter() -> None:
    assert told("it's trial -3.csv of Bob&#39;s, 5 mm", "trial -3.csv", "Bob&#39;s") == (
        f"it’s trial -3.csv of Bob&#39;s, 5{HELD}mm"
    )


def test_a_page_of_a_result_has_one_kind_of_apostrophe_and_no_number_that_leaves_its_unit(result: Path) -> None:
    page = (result / "report.html").read_text(encoding="utf-8")
    body = re.sub(r"<(script|style|code|metadata)\b.*?</\1>|<[^>]*>", "", page.partition("<body>")[2], flags=re.DOTALL)
    assert "’" in body
    assert not re.search(r"'|&#39;|&#x27;", body)
    assert re.search(rf"\d{HELD}mm\b", body)
    assert not re.search(r"\d (%|mm|deg|Hz)(?!\w)", body)
