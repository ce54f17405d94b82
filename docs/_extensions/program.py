"""The commands as the program declares them: ``command`` shows one with its arguments, options and examples."""

from __future__ import annotations

from typing import Any, Literal, get_args, get_origin

import typer
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

_BRACES = str.maketrans("", "", "{}")


def commands() -> dict[str, Any]:
    """Give every command by its name, with all its options."""
    from elbowscrew.cli.app import app

    group: Any = typer.main.get_command(app)
    context = group.context_class(group, info_name="elbowscrew")
    return {name: group.resolve_command(context, [name])[1] for name in group.commands}


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")


def _takes(parameter: Any) -> str:
    if getattr(parameter, "is_flag", False):
        return ""
    kind = parameter.type_descriptor.annotation
    if get_origin(kind) is Literal:
        choices = get_args(kind)
    else:
        choices = (parameter.metavar or kind.__name__.upper()).strip("<>").split("|")
    return ", ".join(f"`{one}`" for one in choices)


def _default(parameter: Any) -> str:
    shown = parameter.show_default
    if isinstance(shown, str):
        return shown
    return "" if parameter.default in (None, False) or not shown else str(parameter.default)


class Command(SphinxDirective):
    """One command: how it is called, what it takes, and the examples of its help."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Make the text of it, and parse it as that of the page."""
        return self.parse_text_to_nodes("\n".join(self._lines(self.arguments[0])))

    def _lines(self, name: str) -> list[str]:
        command = commands()[name]
        context = command.context_class(command, info_name=f"elbowscrew {name}")
        usage = " ".join(["elbowscrew", name, *command.collect_usage_pieces(context)]).translate(_BRACES)
        usage = usage.replace("[[", "[").replace("]]", "]")
        paragraphs = (" ".join(part.split()) for part in (command.help or "").split("\n\n"))
        lines = ["```text", usage, "```", ""]
        for paragraph in filter(None, paragraphs):
            lines += [paragraph, ""]
        told = (line.strip() for line in (command.epilog or "").splitlines())
        examples = [line for line in told if line.startswith("elbowscrew ")]
        if examples:
            lines += ["```sh", *examples, "```", ""]
        panels: dict[str, list[Any]] = {}
        for parameter in command.params:
            if parameter.param_type_name == "argument":
                panels.setdefault("Arguments", []).append(parameter)
            elif not parameter.hidden:
                panels.setdefault(getattr(parameter, "rich_help_panel", None) or "Options", []).append(parameter)
        for title, parameters in panels.items():
            lines += [f"**{title}**", "", "| | takes | what it is | default |", "| --- | --- | --- | --- |"]
            for one in parameters:
                words = [one.metavar.strip("[]")] if title == "Arguments" else [*one.opts, *one.secondary_opts]
                called = ", ".join(f"`{word}`" for word in words)
                takes = "a path" if title == "Arguments" else _takes(one)
                lines.append(f"| {called} | {takes} | {_cell(one.help or '')} | {_cell(_default(one))} |")
            lines.append("")
        return lines


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command", Command)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
