"""Settings from a TOML file and options, each stronger than the one before, and back to the names of options."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from elbowscrew.declaring import FORMER_NAMES, option_name
from elbowscrew.errors import UsageError, unreadable
from elbowscrew.opening import read_toml
from elbowscrew.setting_faults import told_faults
from elbowscrew.setting_values import BY_OPTIONS, READ_BACK
from elbowscrew.settings import LISTS, SETTINGS, Settings

_FIELDS: Final = {one.option: one.field for one in SETTINGS}


def settings_from(config: Path | None = None, options: Mapping[str, Any] | None = None) -> Settings:
    """Merge defaults, a TOML file and options; the later ones win.

    Parameters
    ----------
    config : Path, optional
        A TOML file with option names as keys (``min-angle = 5``).
    options : mapping, optional
        Field or option names; None means not given.

    Raises
    ------
    UsageError
        If the file cannot be read, or a key or value is not a possible one; it names the key.
    """
    given = {option_name(key): value for key, value in (options or {}).items() if value is not None}
    table = _read_toml(config) if config is not None else {}
    if config is not None:
        checked_settings(table, str(config))
    return checked_settings({**table, **given}, "settings")


def _read_toml(config: Path) -> dict[str, Any]:
    try:
        given = read_toml(config)
    except OSError as error:
        raise unreadable(config, "a settings file", error) from error
    except ValueError as error:
        msg = f"{config}: not TOML: {error}. Write one `key = value` a line, text in quotes"
        raise UsageError(msg) from error
    table = {option_name(key): value for key, value in given.items()}
    if len(table) < len(given):
        msg = f"{config}: one setting is given twice, under two spellings; keep one of {', '.join(given)}"
        raise UsageError(msg)
    return {key: [value] if key in LISTS and isinstance(value, str) else value for key, value in table.items()}


def settings_from_options(values: Mapping[str, Any], *, read_back: bool = False) -> Settings:
    """Make settings of values by the names of their options, as ``summary.json`` has them.

    Settings that are read back from a result may name what plug-ins bring that are not installed here.

    Raises
    ------
    pydantic.ValidationError
        If a name or a value is not a possible one.
    """
    named = {_FIELDS.get(name, name): value for name, value in values.items()}
    return Settings.model_validate(named, context=READ_BACK if read_back else BY_OPTIONS)


def settings_with(settings: Settings | None, fields: Mapping[str, Any]) -> Settings:
    """Change fields of settings, by their names in Python.

    Raises
    ------
    UsageError
        If a name or a value is not a possible one; it names the field.
    """
    former = {name.replace("-", "_"): now.replace("-", "_") for name, now in FORMER_NAMES.items()}
    given = {} if settings is None else {name: getattr(settings, name) for name in settings.model_fields_set}
    changed = {former.get(name, name): value for name, value in fields.items()}
    return Settings.model_validate({**given, **changed})


def options_from_settings(settings: Settings) -> dict[str, Any]:
    """Give every setting by the name of its option, ready for JSON."""
    return {option_name(field): value for field, value in settings.model_dump(mode="json").items()}


def checked_settings(values: Mapping[str, Any], location: str, *, read_back: bool = False) -> Settings:
    """Make settings of values by the names of their options; see `settings_from_options`.

    Raises
    ------
    UsageError
        If a name or a value is not a possible one; it begins with the location and names the key.
    """
    try:
        return settings_from_options(values, read_back=read_back)
    except ValidationError as error:
        raise UsageError(told_faults(error, location, list(_FIELDS))) from error
