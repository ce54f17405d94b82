"""The commands as the program declares them: what the pages and the man page are made from."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, get_args, get_origin

import typer

_BRACES = str.maketrans("", "", "{}")


def commands() -> dict[str, Any]:
    """Give every command by its name, with all its options."""
    from elbowscrew.cli.app import app

    group: Any = typer.main.get_command(app)
    context = group.context_class(group, info_name="elbowscrew")
    return {name: group.resolve_command(context, [name])[1] for name in group.commands}


def usage(name: str, command: Any) -> str:
    """Give the line of a command's usage."""
    context = command.context_class(command, info_name=f"elbowscrew {name}")
    text: str = " ".join(["elbowscrew", name, *command.collect_usage_pieces(context)]).translate(_BRACES)
    return text.replace("[[", "[").replace("]]", "]")


def paragraphs(command: Any) -> list[str]:
    """Give what a command's help says of it."""
    return [" ".join(part.split()) for part in (command.help or "").split("\n\n") if part.strip()]


def examples(command: Any) -> list[str]:
    """Give the lines that a command's help ends with."""
    told = (line.strip() for line in (command.epilog or "").splitlines())
    return [line for line in told if line.startswith("elbowscrew ")]


class Told(NamedTuple):
    """An argument or an option: its names, what it takes, what it is, and its default."""

    names: tuple[str, ...]
    takes: tuple[str, ...]
    text: str
    default: str


def panels(command: Any) -> dict[str, list[Told]]:
    """Give arguments and options by the titles of their panels."""
    found: dict[str, list[Told]] = {}
    for one in command.params:
        text = " ".join((one.help or "").split())
        if one.param_type_name == "argument":
            found.setdefault("Arguments", []).append(Told((one.metavar.strip("[]"),), ("a path",), text, _default(one)))
        elif not one.hidden:
            title = getattr(one, "rich_help_panel", None) or "Options"
            told = Told((*one.opts, *one.secondary_opts), _takes(one), text, _default(one))
            found.setdefault(title, []).append(told)
    return found


def _takes(parameter: Any) -> tuple[str, ...]:
    if getattr(parameter, "is_flag", False):
        return ()
    kind = parameter.type_descriptor.annotation
    if get_origin(kind) is Literal:
        return get_args(kind)
    return tuple((parameter.metavar or kind.__name__.upper()).strip("<>").split("|"))


def _default(parameter: Any) -> str:
    shown = parameter.show_default
    if isinstance(shown, str):
        return shown
    if parameter.default is True and parameter.secondary_opts:
        return str(parameter.opts[0])
    return "" if parameter.default in (None, False) or not shown else str(parameter.default)
