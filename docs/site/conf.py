# How the site is made of the pages: see docs/run.
import os
import pathlib
import re
import xml.etree.ElementTree as tree

project = "Abrade"
root_doc = "site/index"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["paper_channel/*/**"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]

html_theme = "furo"
html_title = "Abrade"
html_static_path = [os.environ["ABRADE_SITE_STATIC"]]
html_css_files = ["katex/katex.min.css", "site.css"]
html_js_files = ["katex/katex.min.js", "katex/contrib/auto-render.js", "formulas.js"]
mathjax_path = "formulas_none.js"  # KaTeX sets them, from files of this machine
html_copy_source = False
html_show_sphinx = False
smartquotes = False
highlight_language = "cpp"

root = pathlib.Path(__file__).resolve().parents[2]
here = pathlib.Path(os.environ["ABRADE_SITE_SOURCE"])


def pages_of_headers():
    """Header -> its page of the reference, from Doxygen's tag file."""
    found = {}
    for compound in tree.parse(os.environ["ABRADE_SITE_TAGS"]).getroot().iter("compound"):
        if compound.get("kind") == "file":
            found[compound.findtext("path", "") + compound.findtext("name")] = compound.findtext("filename")
    return {str(pathlib.Path(path)).split("/include/", 1)[-1]: page for path, page in found.items()}


headers = pages_of_headers()
link = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)\s#]+)((?:#[^)\s]*)?)\)")


def resolve(app, docname, source):
    """Links that leave the pages: to headers, which the reference shows, and to files, which are named."""
    page = (here / docname).parent

    def change(match):
        text, target, anchor = match.groups()
        if re.match(r"[a-z]+:", target):
            return match.group(0)
        path = pathlib.Path(os.path.normpath(page / target))
        if path.is_relative_to(here) and (path.suffix == ".md" or not path.is_dir()):
            return match.group(0)
        of_root = os.path.relpath(path, here.parent)
        header = of_root.removeprefix("include/")
        if header in headers:
            html = headers[header]
            html = html if html.endswith(".html") else html + ".html"
            href = os.path.relpath(here / "reference" / html, page)
            shown = re.sub(r"`([^`]*)`", r"<code>\1</code>", text)
            return f'<a class="reference external" href="{href}">{shown}</a>'
        return f"{text} (`{of_root}`)"

    source[0] = link.sub(change, source[0])


def setup(app):
    app.connect("source-read", resolve)
