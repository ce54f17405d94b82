"""The directive ``command`` shows a command with its arguments, options and examples."""

from __future__ import annotations

from declared import commands, examples, panels, paragraphs, usage
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")


class Command(SphinxDirective):
    """One command: how it is called, what it takes, and the examples of its help."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Make the text of it, and parse it as that of the page."""
        return self.parse_text_to_nodes("\n".join(self._lines(self.arguments[0])))

    def _lines(self, name: str) -> list[str]:
        command = commands()[name]
        lines = ["```text", usage(name, command), "```", ""]
        for paragraph in paragraphs(command):
            lines += [paragraph, ""]
        if examples(command):
            lines += ["```sh", *examples(command), "```", ""]
        for title, parameters in panels(command).items():
            lines += [f"**{title}**", "", "| | takes | what it is | default |", "| --- | --- | --- | --- |"]
            for one in parameters:
                called = ", ".join(f"`{word}`" for word in one.names)
                takes = "a path" if title == "Arguments" else ", ".join(f"`{word}`" for word in one.takes)
                lines.append(f"| {called} | {takes} | {_cell(one.text)} | {_cell(one.default)} |")
            lines.append("")
        return lines


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command", Command)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
