"""Dual matrices: the laws of their inverses and decompositions."""

from __future__ import annotations

import numpy as np
import pytest
from poses import random_poses

from elbowscrew.geometry import dual_matrix, dual_matrix_from_dual_quat
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_matrix import DualMatrix

SHAPES = [(1000, 3, 3), (1000, 5, 3), (1000, 3, 5), (1000, 1, 1), (3, 1, 2, 4, 4), (0, 3, 3), (3, 3)]


def random_dual(shape: tuple[int, ...], seed: int) -> DualMatrix:
    """Random dual matrices, the real part's singular values from 0.3 to 3: no test is one of conditioning."""
    rng = np.random.default_rng(seed)
    U, _, Vt = np.linalg.svd(rng.normal(size=shape), full_matrices=False)
    sizes = rng.uniform(0.3, 3.0, size=(*shape[:-2], 1, min(shape[-2:])))
    return DualMatrix((U * sizes) @ Vt, rng.normal(size=shape))


def assert_equal(one: DualMatrix, other: DualMatrix, tolerance: float = 1e-12) -> None:
    assert one.real == pytest.approx(other.real, abs=tolerance)
    assert one.dual == pytest.approx(other.dual, abs=tolerance)


def assert_orthogonal(Q: DualMatrix, tolerance: float = 1e-12) -> None:
    square = dual_matrix.multiply(dual_matrix.transpose(Q), Q)
    assert square.real == pytest.approx(np.broadcast_to(np.eye(Q.real.shape[-1]), square.real.shape), abs=tolerance)
    assert square.dual == pytest.approx(np.zeros(square.real.shape), abs=tolerance)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_four_laws_of_the_pseudoinverse(shape: tuple[int, ...]) -> None:
    A = random_dual(shape, 1)
    P = dual_matrix.pseudoinverse(A)
    left, right = dual_matrix.multiply(A, P), dual_matrix.multiply(P, A)
    assert_equal(dual_matrix.multiply(left, A), A, 1e-11)
    assert_equal(dual_matrix.multiply(right, P), P, 1e-11)
    assert_equal(dual_matrix.transpose(left), left, 1e-11)
    assert_equal(dual_matrix.transpose(right), right, 1e-11)


def test_the_pseudoinverse_is_the_papers_formula_and_the_inverse_of_square_ones() -> None:
    wide = random_dual((1000, 3, 5), 2)
    turned = dual_matrix.transpose(wide)
    formula = dual_matrix.multiply(turned, dual_matrix.inverse(dual_matrix.multiply(wide, turned)))
    assert_equal(dual_matrix.pseudoinverse(wide), formula, 1e-10)
    square = random_dual((1000, 4, 4), 3)
    assert_equal(dual_matrix.pseudoinverse(square), dual_matrix.inverse(square), 1e-10)


@pytest.mark.parametrize("shape", SHAPES)
def test_qr_of_regular_matrices(shape: tuple[int, ...]) -> None:
    A = random_dual(shape, 4)
    Q, R = dual_matrix.qr(A)
    assert_orthogonal(Q)
    assert_equal(dual_matrix.multiply(Q, R), A)
    for part in R:
        assert (np.tril(part, -1) == 0.0).all()
    assert (np.diagonal(R.real, axis1=-2, axis2=-1) > 0).all()


@pytest.mark.parametrize("shape", [(1000, 3, 3), (1000, 5, 3), (1000, 3, 5)])
@pytest.mark.parametrize("rank", [0, 1, 2])
@pytest.mark.parametrize("dual", ["random", "deficient", "zero"])
def test_qr_of_matrices_whose_real_part_has_no_full_rank(shape: tuple[int, ...], rank: int, dual: str) -> None:
    rng = np.random.default_rng(5)

    def small_integers(rank: int) -> Float:  # products of small integers: the rank is exact
        factors = rng.integers(-2, 3, size=(*shape[:-1], rank)), rng.integers(-2, 3, size=(1000, rank, shape[-1]))
        return np.asarray(factors[0] @ factors[1], dtype=np.float64)

    parts = {"random": rng.normal(size=shape), "deficient": small_integers(1), "zero": np.zeros(shape)}
    A = DualMatrix(small_integers(rank), parts[dual])
    Q, R = dual_matrix.qr(A)
    assert_orthogonal(Q, 1e-11)
    assert_equal(dual_matrix.multiply(Q, R), A, 1e-11)
    assert (np.tril(R.real, -1) == 0.0).all()
    with pytest.raises(np.linalg.LinAlgError, match="full rank"):
        dual_matrix.pseudoinverse(A)


@pytest.mark.parametrize("shape", [shape for shape in SHAPES if shape[-2] >= shape[-1]])
def test_polar_form(shape: tuple[int, ...]) -> None:
    A = random_dual(shape, 6)
    Q, S = dual_matrix.polar(A)
    assert_orthogonal(Q, 1e-11)
    assert_equal(dual_matrix.multiply(Q, S), A, 1e-11)
    assert_equal(dual_matrix.transpose(S), S)
    assert (np.linalg.eigvalsh(S.real) > 0).all()


def test_the_polar_factor_is_the_derivative_of_the_real_one() -> None:
    A = random_dual((200, 4, 3), 7)
    h = 1e-6

    def factor(real: Float) -> Float:
        U, _, Vt = np.linalg.svd(real, full_matrices=False)
        return np.asarray(U @ Vt)

    slope = (factor(A.real + h * A.dual) - factor(A.real - h * A.dual)) / (2 * h)
    assert dual_matrix.polar(A)[0].dual == pytest.approx(slope, abs=1e-7)


def test_an_orthogonal_dual_matrix_is_its_own_factor() -> None:
    A = dual_matrix_from_dual_quat(random_poses((50,), 8))
    assert_equal(dual_matrix.polar(A)[0], A)
    assert_equal(dual_matrix.qr(A)[0], A)


def test_what_does_not_exist_is_refused() -> None:
    flat = DualMatrix(np.diag([1.0, 1.0, 0.0]), np.eye(3))
    with pytest.raises(np.linalg.LinAlgError):
        dual_matrix.inverse(flat)
    with pytest.raises(np.linalg.LinAlgError, match="full rank"):
        dual_matrix.pseudoinverse(flat)
    with pytest.raises(np.linalg.LinAlgError, match="full column rank"):
        dual_matrix.polar(flat)
    with pytest.raises(np.linalg.LinAlgError, match="full column rank"):
        dual_matrix.polar(random_dual((3, 5), 9))
