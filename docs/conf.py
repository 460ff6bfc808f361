"""Sphinx: build.sh runs it, and puts Doxygen's XML and the Python package where it finds them."""

import os
import re
from pathlib import Path

import orientation_from_color

DOCS = Path(__file__).parent
project = "ofc"
author = "the authors of ofc"
project_copyright = author
version = release = orientation_from_color.__version__
extensions = ["breathe", "myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["requirements.txt"]

if (Path(os.environ["OFC_RUSTDOC"]) / "mathjax").exists():
    mathjax_path = "../mathjax/tex-svg.js"

html_theme = "furo"
html_title = f"ofc {release}"
html_extra_path = [os.environ["OFC_RUSTDOC"]]
html_theme_options = {"navigation_with_keys": True}

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

breathe_projects = {"ofc": os.environ["OFC_DOXYGEN"]}
breathe_default_project = "ofc"
breathe_domain_by_extension = {"h": "c", "hpp": "cpp"}
breathe_show_include = False

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: name for name in ("Photo", "Channels", "npt.ArrayLike", "npt.NDArray")}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
napoleon_use_ivar = True


def link_outside(app, name, source):
    """Pages of the repository that are none of these become files to download, as sources of other types do by themselves."""
    folder = (DOCS / name).parent

    def link(match):
        target = (folder / match[1]).resolve()
        return match[0] if target.is_relative_to(DOCS) else f"](path:{match[1]})"

    source[0] = re.sub(r"\]\(((?:\.\./)+[^)#]*\.md)(?:#[^)]*)?\)", link, source[0])


def setup(app):
    """Sphinx calls it."""
    app.connect("source-read", link_outside)
