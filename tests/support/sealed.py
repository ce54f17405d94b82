"""Results that were changed on purpose, with digests of what is there now: what is wrong in them is then looked at."""

from __future__ import annotations

from pathlib import Path

from elbowscrew.results.proof import Proof, proof_of, seal


def resealed(folder: Path) -> Path:
    (folder / "SHA256SUMS").unlink(missing_ok=True)
    seal(folder)
    return folder


def reproved(folder: Path) -> Proof:
    return proof_of(resealed(folder))
