"""Sphinx configuration."""

from panokit import __version__

project = "panokit"
author = "The panokit authors"
copyright = "2026, the panokit authors"
release = version = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "panokit"
autodoc_member_order = "bysource"
autodoc_typehints = "description"
# Fonts and scripts come with the theme: the built pages make no external request.
