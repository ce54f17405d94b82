"""A bare pandas read of the columns in use and the five figures in pyplot: ``read_and_draw.py TRIAL.csv FOLDER``.

Nothing is computed: the columns themselves stand for what the figures show.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from pyplot_figures import Drawn, draw_all

HEADER_LINES = 7


def main(trial: Path, folder: Path) -> None:
    table = pd.read_csv(trial, header=None, skiprows=HEADER_LINES, usecols=range(18)).to_numpy()
    euler, path = table[:, 10:14], 1000.0 * table[:, 14:17]
    angle = 180.0 * euler[:, 0]
    normal = np.array([0.0, 0.0, 1.0])
    draw_all(
        Drawn(
            time_s=table[:, 1],
            angle=angle,
            angle_sd=1000.0 * table[:, 17],
            model_angle=180.0 * euler[:, 1],
            euler=euler,
            model_euler=table[:, 2:6],
            angle_error=1000.0 * table[:, 9],
            displacement=1000.0 * table[:, 17],
            direction=euler[:, 1:] / np.linalg.norm(euler[:, 1:], axis=1)[:, None],
            point=path,
            path=path,
            keyframes=np.arange(0, len(table), 225),
            mean_direction=normal,
            mean_point=path.mean(axis=0),
        ),
        folder,
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
