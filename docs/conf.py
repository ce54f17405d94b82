"""Settings of the documentation's build: ``make docs``, or ``sphinx-build -W docs build/site``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_extensions"), str(HERE.parent / "src")]

from elbowscrew import __version__  # noqa: E402

project = "elbowscrew"
author = "The elbowscrew developers"
copyright = "2026, the elbowscrew developers"  # noqa: A001
version = release = __version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "math_ml",
    "commands",
    "program",
]
exclude_patterns = [
    "gallery/*.ipynb",
    "**/sg_execution_times.rst",
    "sg_execution_times.rst",
    "_made",
    "_static",
    "_extensions",
    "schemas",
    "gallery_scripts",
]
suppress_warnings = ["mystnb.unknown_mime_type"]

# ELBOWSCREW_DOCS_RUN=0 builds without running anything: commands and cells are shown as they stand.
run_commands = os.environ.get("ELBOWSCREW_DOCS_RUN", "1") != "0"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "force" if run_commands else "off"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # they would come from the network

sphinx_gallery_conf = {
    "examples_dirs": "gallery_scripts",
    "gallery_dirs": "gallery",
    "filename_pattern": "/plot_" if run_commands else "/none",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 600,
    "within_subsection_order": "FileNameSortKey",
}

autosummary_generate = True
autodoc_typehints = "none"  # the docstrings tell types with their shapes
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

html_theme = "pydata_sphinx_theme"
html_title = f"elbowscrew {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "navigation_with_keys": True,
    "show_nav_level": 1,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
copybutton_prompt_text = r"\$ |>>> |PS> "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = False
