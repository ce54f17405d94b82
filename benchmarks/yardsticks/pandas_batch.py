"""The loop one writes around the script for a study: ``pandas_batch.py DATA OUT WORKERS``, by joblib if it is there."""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from pandas_script import main as one_trial


def main(data: Path, out: Path, workers: int) -> None:
    paths = sorted(data.glob("*.csv"))
    folders = [out / path.stem for path in paths]
    if find_spec("joblib"):
        joblib: Any = import_module("joblib")
        work = (joblib.delayed(one_trial)(path, folder) for path, folder in zip(paths, folders, strict=True))
        joblib.Parallel(n_jobs=workers)(work)
    else:
        with ProcessPoolExecutor(workers) as pool:
            list(pool.map(one_trial, paths, folders))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
