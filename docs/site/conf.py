"""How Sphinx makes the site out of the pages that docs/site/prepare.py has laid out."""

import os
import sys

sys.path.insert(0, os.environ["ROSIN_PACKAGE"])
project = "rosin"
copyright = author = "the authors of rosin"
version = release = os.environ["ROSIN_VERSION"]
html_title = f"rosin {version}"
html_copy_source = html_show_copyright = html_show_sphinx = False

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "breathe"]
root_doc = "docs/index"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["colon_fence", "dollarmath", "html_image"]
myst_heading_anchors = 4  # as GitHub names headings

# Formulas are drawn by MathJax 2 out of Debian's libjs-mathjax, copied beside the pages: no network is asked.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG"
myst_update_mathjax = False
mathjax2_config = {
    "messageStyle": "none",
    "SVG": {"linebreaks": {"automatic": True, "width": "container"}, "font": "TeX"},
    "tex2jax": {"processClass": "math", "ignoreClass": ".*"},
}

html_theme = "furo"
html_static_path = ["_static"]
html_extra_path = ["extra"]
html_css_files = ["rosin.css"]
pygments_style = "default"
highlight_language = "none"

autodoc_typehints = "signature"
breathe_projects = {"rosin": os.environ["ROSIN_DOXYGEN"]}
breathe_default_project = "rosin"
