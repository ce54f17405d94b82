"""What the help of each command ends with: command lines that do what people come for."""

from __future__ import annotations

from typing import Final

EXAMPLES: Final[dict[str, tuple[str, ...]]] = {
    "analyze": (
        "elbowscrew analyze trial.csv",
        'elbowscrew analyze trial.csv --joint knee --proximal "Rigid Body 1" --distal "Rigid Body 2"',
        "elbowscrew analyze trial.csv --lowpass 6 --landmarks arm.toml --figure-format pdf",
        "elbowscrew analyze trial.csv --tolerance 2mm --output results/P01",
    ),
    "batch": (
        "elbowscrew batch study --recursive --output results",
        "elbowscrew batch manifest.csv --config lab.toml --workers 4",
    ),
    "report": (
        "elbowscrew report results",
        "elbowscrew report trial_elbowscrew --figures theta,joint --width single --figure-format pdf",
        "elbowscrew report results --figures overlay",
        "elbowscrew report trial_elbowscrew --clip view.gif",
    ),
    "compare": (
        "elbowscrew compare trial.csv",
        "elbowscrew compare study --methods dlb,sclerp --laws cycloidal,best --counts 2,3",
    ),
    "interpolate": ("elbowscrew interpolate trial_elbowscrew/keyframes.csv --frames 200",),
    "info": ("elbowscrew info trial.csv", "elbowscrew info trial.c3d --all --json"),
    "simulate": (
        "elbowscrew simulate trial.csv --joint-type two-axes --pronation 60 --seed 1",
        "elbowscrew simulate knee.csv --joint knee --repetitions 5 --marker-noise 0.3 --skin 5",
    ),
    "paper": ("elbowscrew paper", "elbowscrew paper --figures paper_figures"),
    "samples": ("elbowscrew samples", "elbowscrew samples --copy elbowscrew_samples"),
}


def epilog(command: str) -> str:
    """Give the end of a command's help; blank lines keep its lines apart on a terminal, too."""
    return "\n\n".join(("Examples:", *EXAMPLES[command]))
