"""The settings as options of a command, made from `elbowscrew.settings.SETTINGS`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from typing import TYPE_CHECKING, Annotated, Any

import typer

from elbowscrew.choices import EXPORT_NAMES
from elbowscrew.cli import completing, options
from elbowscrew.errors import UsageError, shown

if TYPE_CHECKING:
    from elbowscrew.declaring import Setting

OUTPUT = "Output"


def settings_options(
    *only: str, defaults: Mapping[str, str] | None = None
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Put settings in the place of a command's parameter ``given``, which gets what the options say.

    The options are made when `with_settings` of the command is called, so that listing the commands need not load the
    settings (`elbowscrew.cli.app`).

    Parameters
    ----------
    *only : str
        Names of the options; all settings if there are none.
    defaults : mapping of str to str, optional
        What the help says of defaults that are the command's own, by the options' names.
    """

    def decorated(command: Callable[..., None]) -> Callable[..., None]:
        def with_settings() -> Callable[..., None]:
            from elbowscrew.settings import SETTINGS

            settings = {one.option.replace("-", "_"): one for one in SETTINGS if not only or one.option in only}

            @wraps(command)
            def run(**values: Any) -> None:
                given = {name: _value(setting, values.pop(name)) for name, setting in settings.items()}
                command(given=given, **values)

            made = [_parameter(name, one, defaults or {}) for name, one in settings.items()]
            parameters: list[inspect.Parameter] = []
            for parameter in inspect.signature(command, eval_str=True).parameters.values():
                parameters += made if parameter.name == "given" else [parameter]
            run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
            run.__annotations__ = {}
            return run

        def listed() -> None:
            """Stand in the list of commands; the one that is asked for is made by `with_settings`."""

        listed.__name__, listed.__doc__ = command.__name__, command.__doc__
        listed.with_settings = with_settings  # type: ignore[attr-defined]
        return listed

    return decorated


def _parameter(name: str, setting: Setting, defaults: Mapping[str, str]) -> inspect.Parameter:
    kind = list[str] if setting.several or setting.former else setting.kind  # of two names both are heard
    names = [f"--{one}" for one in (setting.option, *setting.former)]
    if kind is bool and not setting.option.startswith("no-"):
        names = [f"{names[0]}/--no-{setting.option}"]
    default = defaults.get(setting.option, setting.default)
    option = typer.Option(
        *names,
        metavar=None if kind is bool or (setting.choices and not setting.several) else setting.metavar,
        rich_help_panel=setting.about,
        help=setting.text + (" Separate with commas, or repeat the option." if setting.several else ""),
        show_default=False if kind is bool or not default else default,
        autocompletion=_completion(setting),
    )
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[kind | None, option]
    )


def _completion(setting: Setting) -> Callable[..., list[str]] | None:
    if setting.option in ("proximal", "distal"):
        return completing.bodies
    choices = EXPORT_NAMES if setting.option == "export" else setting.choices  # plug-ins may bring more
    return completing.choices(choices) if setting.several and choices else None


def _value(setting: Setting, given: Any) -> Any:
    if setting.former and not setting.several:
        return _only(setting.option, given or [])
    if given is None or not setting.several:
        return given
    parts = options.parts(setting.option, given, once=setting.kind not in (int, float))
    return options.whole_numbers(setting.option, parts) if setting.kind is int else parts


def _only(option: str, given: list[str]) -> str | None:
    """Take the one value of an option that has several names, None if it is not given."""
    different = list(dict.fromkeys(given))
    if len(different) > 1:
        msg = f"--{option} is given twice, as {' and '.join(map(shown, different))}; keep one"
        raise UsageError(msg)
    return different[0] if different else None
