"""How functions on arrays of any leading shape go through memory: rows of components, a block of frames at a time.

A column of an array (N, 8) as C lays it out is one number in every 64 bytes, and arithmetic on it waits for memory. So
results are kept as eight contiguous rows, shape (8, N) in memory, and given out as the transposed view (N, 8). Blocks
keep what a formula needs in between within the processor's cache, so that it costs no memory beside its result.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry.arrays import Float, Index

# From 8,192 to 32,768 frames alike. The least of them keeps a linear map of 4 x 8 below the size from which on
# OpenBLAS takes threads, which would stand in the way of those who run one process on each core.
BLOCK: Final = 8192


def in_blocks(
    kernel: Callable[..., Iterable[Float]], *operands: ArrayLike, width: int, contiguous: bool = True
) -> Float:
    """Apply a formula on rows of components to arrays whose leading shapes broadcast.

    Parameters
    ----------
    kernel : callable
        Told one array (k, n) for each operand, or (k, 1) for one that is the same for all frames, it gives `width`
        rows (n,) or (1,). Warnings of NumPy are off in it.
    *operands : array_like, shape (..., k)
        Each with its own k.
    width : int
        Components of the result.
    contiguous : bool
        Whether the kernel wants the rows of its operands contiguous; a matrix product does not mind.

    Returns
    -------
    ndarray, shape (..., width)
        A view of contiguous rows, shape (width, N).
    """
    arrays = [np.asarray(operand, dtype=np.float64) for operand in operands]
    shape = _common_shape({array.shape[:-1] for array in arrays})
    count = math.prod(shape)
    readers = [_reader(array, shape, count, contiguous=contiguous) for array in arrays]
    result = np.empty((width, count))
    with np.errstate(all="ignore"):
        for start in range(0, count, BLOCK):
            part = slice(start, start + BLOCK)
            for out, row in zip(result[:, part], kernel(*[read(part) for read in readers]), strict=True):
                out[...] = row
    if len(shape) == 1:
        return result.T
    return result.reshape(width, *shape).transpose(*range(1, len(shape) + 1), 0)


def _common_shape(shapes: set[tuple[int, ...]]) -> tuple[int, ...]:
    """`np.broadcast_shapes`, which takes as long as a short series, only where shapes differ."""
    differing = shapes - {()}
    return differing.pop() if len(differing) == 1 else np.broadcast_shapes(*differing)


def _reader(array: Float, shape: tuple[int, ...], count: int, *, contiguous: bool) -> Callable[[slice], Float]:
    """Give a function that gives the rows of components, shape (k, n), of a slice of the frames."""
    components = array.reshape(-1, array.shape[-1]).T
    frames = components.shape[1]
    if frames == 1 and count != 1:
        constant = np.ascontiguousarray(components)
        return lambda part: constant
    if frames == count:
        if not contiguous or components.strides[1] == components.itemsize:
            return lambda part: components[:, part]
        return lambda part: np.ascontiguousarray(components[:, part])
    index = np.broadcast_to(np.arange(frames).reshape(array.shape[:-1]), shape).flat
    return lambda part: np.ascontiguousarray(components[:, index[part]])


def is_single(array: Float) -> bool:
    """Whether the array (..., k) holds one frame only."""
    return bool(array.size == array.shape[-1])


def evenly_thinned(rows: Index, most: int) -> Index:
    """At most so many of the rows (K,), evenly chosen, the first and the last among them."""
    return rows if rows.size <= most else rows[np.linspace(0, rows.size - 1, most).astype(np.int64)]
