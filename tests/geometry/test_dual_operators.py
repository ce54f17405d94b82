"""Operators of dual numbers: a commutative ring over the reals, oracle ``[[a, b], [0, a]]``."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from elbowscrew.geometry.dual_number import DualNumber, dual_number

RNG = np.random.default_rng(11)
X, Y, Z = (dual_number(RNG.uniform(1.0, 2.0, 5), RNG.normal(size=5)) for _ in range(3))
OPERATORS = (operator.add, operator.sub, operator.mul, operator.truediv)


def matrix(x: Any) -> Any:
    x = x if isinstance(x, DualNumber) else dual_number(np.broadcast_to(x, 5))
    return x.real[:, None, None] * np.eye(2) + x.dual[:, None, None] * np.array([[0.0, 1.0], [0.0, 0.0]])


def of_matrices(op: Callable[[Any, Any], Any], x: Any, y: Any) -> Any:
    if op is operator.mul:
        return matrix(x) @ matrix(y)
    if op is operator.truediv:
        return matrix(x) @ np.linalg.inv(matrix(y))
    return op(matrix(x), matrix(y))


@pytest.mark.parametrize("op", OPERATORS)
@pytest.mark.parametrize(
    ("x", "y"),
    [
        (X, Y),
        (X, 3.0),
        (3.0, X),
        (X, 2),
        (2, X),
        (X, np.float64(1.5)),
        (np.float64(1.5), X),
        (X, Y.real),
        (Y.real, X),
        (X, True),
    ],
)
def test_operators_are_those_of_the_matrices(op: Callable[[Any, Any], Any], x: Any, y: Any) -> None:
    result = op(x, y)
    assert isinstance(result, DualNumber)
    np.testing.assert_allclose(matrix(result), of_matrices(op, x, y), atol=1e-14)


def same(x: DualNumber, y: DualNumber) -> None:
    np.testing.assert_allclose(x.real, y.real, atol=1e-13)
    np.testing.assert_allclose(x.dual, y.dual, atol=1e-13)


def test_laws_of_a_commutative_ring() -> None:
    same(X + Y, Y + X)
    same(X * Y, Y * X)
    same((X + Y) + Z, X + (Y + Z))
    same((X * Y) * Z, X * (Y * Z))
    same(X * (Y + Z), X * Y + X * Z)
    same(X - Y, X + -Y)
    same(X / Y * Y, X)
    same(1.0 / X * X, dual_number(np.ones(5)))
    eps = dual_number(0.0, 1.0)
    same(eps * eps, dual_number(0.0))


@pytest.mark.parametrize("strange", [(1.0, 2.0), [1.0, 2.0], "ab", None, 1j, np.array([1j]), np.array(["a"])])
@pytest.mark.parametrize("op", OPERATORS)
def test_other_operands_are_refused(op: Callable[[Any, Any], Any], strange: Any) -> None:
    with pytest.raises(TypeError):
        op(X, strange)
    with pytest.raises(TypeError):
        op(strange, X)


def test_another_type_may_answer() -> None:
    class Answers:
        def __radd__(self, other: object) -> str:
            return "answered"

    other: Any = Answers()
    assert X + other == "answered"


def test_it_unpacks_as_a_tuple() -> None:
    real, dual = X + Y
    np.testing.assert_array_equal(real, X.real + Y.real)
    np.testing.assert_array_equal(dual, X.dual + Y.dual)
