"""Numbers as sentences have them: so many digits that count, never in a form that a reader must decode."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.quantities import in_digits, rounded

LOWERED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def read(text: str) -> float:
    mantissa, _, power = text.partition("·10")
    return float(f"{mantissa}e{power.translate(LOWERED)}" if power else text)


@given(value=st.floats(1e-300, 1e300), digits=st.integers(1, 6))
def test_so_many_digits_count(value: float, digits: int) -> None:
    for text in (in_digits(value, digits), rounded(value, digits)):
        assert read(text) == pytest.approx(value, rel=0.5000001 * 10.0 ** (1 - digits))
    assert read(rounded(-value, digits)) == -read(rounded(value, digits))


@given(value=st.floats(1e-4, 9e5))
def test_what_is_usual_has_no_power_of_ten(value: float) -> None:
    assert re.fullmatch(r"\d+(\.\d+)?", in_digits(value))
    assert rounded(value) == in_digits(value)


@pytest.mark.parametrize("value", [None, float("nan")])
def test_what_is_not_known_is_a_dash(value: float | None) -> None:
    assert (in_digits(value), rounded(value)) == ("–", "–")


def test_a_terminal_gets_letters_that_it_has() -> None:
    """As that of a console in code page 1252, where a raised minus would be a question mark."""
    assert in_digits(5.7e-5).isascii()
    assert rounded(5.7e-5) == "5.7·10⁻⁵"
