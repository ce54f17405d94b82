"""Make `docs/reference/settings.md` from what `elbowscrew.settings` declares: ``python docs/make_settings.py``."""

from __future__ import annotations

from pathlib import Path

from elbowscrew.declaring import Setting
from elbowscrew.settings import SETTINGS

_HEAD = """\
# Settings

Made from `elbowscrew.settings` by `python docs/make_settings.py`; do not edit by hand. An option of the command line is
`--` and the option's name; the same name is the key in a TOML file (`--config`) and the column of a manifest. In Python
it is the field of `elbowscrew.Settings`, which carries its unit. A list takes commas, or the option again.
`express-in` also takes the words of the joint's segments; `joint`, else the bodies' names, say which end is meant.
"""


def page() -> str:
    """Text of the document."""
    lines = [_HEAD]
    for about in dict.fromkeys(setting.about for setting in SETTINGS):
        lines += [
            f"## {about}",
            "",
            "| option | field | takes | default | what it is |",
            "| --- | --- | --- | --- | --- |",
        ]
        lines += [_row(setting) for setting in SETTINGS if setting.about == about]
        lines.append("")
    return "\n".join(lines)


def _row(setting: Setting) -> str:
    names = ", ".join(f"`{name}`" for name in (setting.option, *setting.former))
    takes = ", ".join(f"`{one}`" for one in setting.choices) or (
        "yes or no" if setting.kind is bool else " ".join([setting.metavar, " and ".join(setting.bounds)]).strip()
    )
    return f"| {names} | `{setting.field}` | {takes} | {setting.default or '–'} | {setting.text} |"


if __name__ == "__main__":
    (Path(__file__).parent / "reference" / "settings.md").write_text(page(), encoding="utf-8")
