"""What MkDocs does besides: navigation from folders, Markdown as GitHub reads it, formulas, links out of doc/, names of the Python module."""

import ast
import html
import importlib.util
import posixpath
import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from urllib.parse import unquote

import markdown
import markdown.extensions.toc
import pygments
from griffe._internal.docstrings import numpy as numpydoc
from markdown.util import AtomicString
from math_core import LatexError, LatexToMathML
from mkdocs.plugins import get_plugin_logger
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound

ROOT = Path(__file__).resolve().parents[2]
# With --strict a warning ends the build.
log = get_plugin_logger("pages")

# ---- Navigation ------------------------------------------------------------------------------------------------------


# Of folders whose name is no word.
TITLES = {"api": "API"}


def pages_of(folder, order):
    """The pages of `folder` below doc/: those of `order` first, then the others by name; subfolders, in one order with it, as sections."""
    there = [path for path in sorted(folder.iterdir()) if path.suffix == ".md" or any(path.glob("**/*.md"))]
    place = {name: number for number, name in enumerate(order)}
    entries = []
    for path in sorted(there, key=lambda path: place.get(path.name, len(place))):
        if path.is_file():
            entries.append(path.relative_to(ROOT / "doc").as_posix())
        elif path.name != "error-vs-time":
            title = TITLES.get(path.name) or path.name.replace("_", " ").replace("-", " ").capitalize()
            entries.append({title: pages_of(path, order)})
    return entries


def on_config(config):
    """Fills the navigation, and adds what pages need to be read as GitHub reads them."""
    config.nav = [{"Start": "index.md"}]
    for part in config.extra["parts"]:
        folder = ROOT / "doc" / part["folder"]
        if folder.is_dir():
            pages = pages_of(folder, part["order"])
            config.nav.append({part["title"]: pages})
            PARTS[f"doc/{part['folder']}"] = pages[0]
    config.repo_url = REPOSITORY
    config.markdown_extensions.append(AsOnGithub())
    markdown.extensions.toc.unique = numbered_as_on_github
    linked_files.clear()
    return config


def numbered_as_on_github(slug, taken, _counters=None):
    """Returns `slug`, with `-1`, `-2` where a heading before has it."""
    number, name = 0, slug
    while name in taken or not name:
        number += 1
        name = f"{slug}-{number}"
    taken.add(name)
    return name


# ---- Markdown as GitHub reads it -------------------------------------------------------------------------------------

FENCE = re.compile(r"(`{3,}|~{3,})\s*([\w-]*)")
ITEM = re.compile(r"([-*+]|\d{1,9}[.)])( +)(?=\S)")
ALERT = re.compile(r"> ?\[!(NOTE|TIP|IMPORTANT|WARNING|CAUTION)\]\s*$")


def as_on_github(text):
    """Python-Markdown wants a blank line before lists, tables, formulas and fences, and four spaces inside an item."""
    out, stack, kinds, fence, alert, formula = [], [], [], None, False, False

    def separate():
        if out and out[-1].strip():
            out.append("")

    previous, in_list, in_code = "", False, False
    for line in text.expandtabs(4).split("\n"):
        bare = line.lstrip(" ")
        indent = len(line) - len(bare)
        if fence:
            mark, cut, pad, is_formula = fence
            if bare.startswith(mark) and not bare.strip(mark[0] + " "):
                out.append(pad + ("$$" if is_formula else bare))
                out.append("")
                fence, previous = None, ""
            else:
                out.append(pad + line[min(cut, indent) :])
            continue
        if alert:
            if bare.startswith(">"):
                out.append("    " + bare[1:].removeprefix(" "))
                continue
            alert = False
        if not bare:
            out.append("")
            previous = ""
            continue
        item, opening = ITEM.match(bare), FENCE.match(bare)
        kind = item and item[1][-1]
        while stack and indent < stack[-1] and (item or opening or not previous.strip()):
            stack.pop()
            last_kind = kinds.pop()
            if item and indent >= (stack[-1] if stack else 0) and kind != last_kind:
                separate()  # Another list.
        lazy = bool(stack) and indent < stack[-1]
        pad = " " * 4 * len(stack)
        rest = indent - (stack[-1] if stack else 0)
        # Four spaces after a blank line make code, until a line has fewer.
        in_code = rest >= 4 and (in_code or not previous.strip())
        if lazy:
            out.append(pad + bare)
        elif opening and rest < 4:
            separate()
            is_formula = opening[2] == "math"
            fence = (opening[1], indent, pad, is_formula)
            out.append(pad + ("$$" if is_formula else bare))
        elif item and rest < 4:
            if previous.strip() and not in_list:
                separate()
            stack.append(indent + item.end())
            kinds.append(kind)
            out.append(pad + item[1].replace(")", ".") + " " + bare[item.end() :])
        elif match := ALERT.match(bare):
            separate()
            out.append(f"!!! {match[1].lower()}")
            alert = True
        elif bare.startswith("$$") and rest < 4:
            # A formula is a block of its own; the blank line after it comes with the line that ends it.
            if not formula:
                separate()
            out.append(pad + bare)
            ends = bare.rstrip().endswith("$$") and len(bare.strip()) > 2
            formula = not formula and not ends
            if not formula:
                out.append("")
        else:
            if bare.startswith("|") and not previous.lstrip().startswith("|"):
                separate()
            out.append(pad + " " * (rest if in_code else 0) + bare)
            if formula and bare.rstrip().endswith("$$"):
                formula = False
                out.append("")
        in_list = bool(stack)
        previous = line
    return "\n".join(out)


# By the beginning of a page's path.
BOOSTS = [("tutorials", 2), ("howto", 2), ("python/api", 0.5), ("method/error-vs-time", 0.1), ("method", 0.5)]


def on_page_markdown(text, page, config, files):
    """Reads the page as GitHub does. Search puts what most readers look for first."""
    OutwardLinks.page = page.file.src_uri
    boost = next((factor for start, factor in BOOSTS if page.file.src_uri.startswith(start)), 1)
    page.meta.setdefault("search", {}).setdefault("boost", boost)
    return as_on_github(text.replace(REST, "\n\n".join(f"::: stickslip.{name}" for name in names_of_no_page())))


# ---- Names of the Python module --------------------------------------------------------------------------------------

API = ROOT / "doc/python/api"
REST = "<!-- public names of no other page -->"


def public_names():
    """The public names of the module, from `__all__`."""
    module = ast.parse((ROOT / "python/stickslip/__init__.py").read_text())
    lists = [node.value for node in module.body if isinstance(node, ast.Assign) and node.targets[0].id == "__all__"]
    return [name for name in ast.literal_eval(lists[0]) if name != "__version__"]


def names_of_no_page():
    """The public names that no page of the API has."""
    placed = {name for page in API.glob("*.md") for name in re.findall(r"\bstickslip\.(\w+)", page.read_text())}
    return [name for name in public_names() if name not in placed]


def as_written(text, docstring, **options):
    """The type of a docstring, where it is an expression; griffe takes "ndarray, shape (m,)" for one, too."""
    return typed(text, docstring, **options) if re.fullmatch(r"[\w.|\[\] ]+", text) else text


def each_its_own(lines, docstring, **options):
    """Parameters that are described together have defaults and types of their own; griffe gives all of them those of the first."""
    parameters, offset = described(lines, docstring, **options)
    own = getattr(docstring.parent, "parameters", ())
    of_signature = {id(one.annotation) for one in own}
    for parameter in parameters:
        if parameter.name in own:
            parameter.value = own[parameter.name].default
            if id(parameter.annotation) in of_signature:
                parameter.annotation = own[parameter.name].annotation
    return parameters, offset


typed, described = numpydoc.parse_docstring_annotation, numpydoc._read_parameters
numpydoc.parse_docstring_annotation, numpydoc._read_parameters = as_written, each_its_own


# ---- Formulas --------------------------------------------------------------------------------------------------------

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)
TAG = re.compile(r"\\tag\{([^{}]*)\}")
converter = LatexToMathML(fancy_error=False)


def mathml(latex, block, page):
    """Returns a formula as MathML, which browsers show without a script; its number is set on the right."""
    number = TAG.search(latex) if block else None
    try:
        latex = TAG.sub("", latex).strip().replace("{split}", "{aligned}")
        math = converter.convert_with_local_state(latex, displaystyle=block)
    except LatexError as error:
        log.warning(f"doc/{page}: the formula {latex!r} cannot be read: {error}")
        return html.escape(latex)
    if not block:
        return math
    label = f'<span class="number">({number[1]})</span>' if number else ""
    return f'<div class="formula">{math}{label}</div>'


def on_page_content(content, page, config, files):
    """Formulas become MathML, and pictures wait until they are scrolled to."""
    content = FORMULA.sub(lambda m: mathml(html.unescape(m[3]), m[2] == "[", page.file.src_uri), content)
    return content.replace("<img ", '<img loading="lazy" ')


# ---- Links out of doc/, and to folders -------------------------------------------------------------------------------

REPOSITORY = tomllib.loads((ROOT / "Cargo.toml").read_text())["package"].get("repository")
linked_files = set()
PARTS = {}  # The folder of each part, and its first page: what a link to the folder means.


def is_outside(page, link):
    """The path from the repository's root of a file outside doc/, or of a folder, that `link` on `page` leads to, or None."""
    if ":" in link or link.startswith(("#", "/")):
        return None
    path = posixpath.normpath(posixpath.join("doc", posixpath.dirname(page), unquote(link.split("#")[0])))
    return None if path.startswith("doc/") and not (ROOT / path).is_dir() else path


class AsOnGithub(markdown.extensions.Extension):
    def extendMarkdown(self, md):
        md.treeprocessors.register(OutwardLinks(md), "outward_links", 1)  # Before MkDocs' own at 0.
        md.treeprocessors.register(PipesInCode(md), "pipes_in_code", 1)


class PipesInCode(markdown.treeprocessors.Treeprocessor):
    """A | in code in a table is written as \\|."""

    def run(self, root):
        for cell in root.iter("td"):
            for code in cell.iter("code"):
                code.text = AtomicString((code.text or "").replace("\\|", "|"))


class OutwardLinks(markdown.treeprocessors.Treeprocessor):
    """Leads links to files outside doc/ to the repository, or, where Cargo.toml names none, to a page with the file."""

    page = ""

    def run(self, root):
        for element in root.iter():
            if element.tag not in ("a", "img"):
                continue
            key = "href" if element.tag == "a" else "src"
            path = is_outside(self.page, element.get(key, ""))
            if path is None:
                continue
            there = ROOT / path
            if part := PARTS.get(path):
                element.set(key, posixpath.relpath(part, posixpath.dirname(self.page) or "."))
                continue
            if path.startswith("..") or not there.exists():
                log.warning(f"doc/{self.page}: the link {element.get(key)} leads to nothing")
                continue
            if REPOSITORY:
                element.set(key, f"{REPOSITORY}/{'tree' if there.is_dir() else 'blob'}/main/{path}")
                continue
            linked_files.add(path)
            if is_binary(there):
                element.set("download", posixpath.basename(path))
            # MkDocs lets what has a scheme alone; on_post_page puts the address in.
            element.set(key, f"outside:{path}")


def is_binary(file):
    """Whether `file` is not to be read as text, as notebooks are not either: a browser then downloads it."""
    return file.is_file() and (file.suffix == ".ipynb" or b"\0" in file.read_bytes()[:4096])


def source_address(path):
    there = ROOT / path
    if there.is_dir():
        return f"source/{path}/index.html"
    return f"source/{path}" if is_binary(there) else f"source/{path}.html"


def on_post_page(output, page, config):
    up = "../" * page.url.count("/")
    return re.sub(r'"outside:([^"]*)"', lambda m: f'"{up}{source_address(html.unescape(m[1]))}"', output)


SHEET = """<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{path}</title><link rel="stylesheet" href="{up}assets/source.css"><h1>{path}</h1>
<p><a href="{up}index.html">stickslip</a></p>{body}</html>"""


def on_post_build(config):
    """Writes a page for each file and folder outside doc/ that a page links to."""
    site = Path(config.site_dir)
    for path in sorted(linked_files):
        there, target = ROOT / path, site / source_address(path)
        if is_binary(there):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(there, target)
            continue
        if there.is_dir():
            listed = subprocess.run(["git", "ls-files", "--", "."], cwd=there, capture_output=True, text=True).stdout
            body = f"<pre>{html.escape(listed)}</pre>"
        else:
            try:
                lexer = get_lexer_for_filename(path)
            except ClassNotFound:
                lexer = TextLexer()
            body = pygments.highlight(there.read_text(errors="replace"), lexer, HtmlFormatter())
        target.parent.mkdir(parents=True, exist_ok=True)
        up = "../" * (target.relative_to(site).as_posix().count("/"))
        target.write_text(SHEET.format(path=html.escape(path), up=up, body=body))
    font = Path(importlib.util.find_spec("ziamath").origin).parent / "fonts/STIXTwoMath-Regular.ttf"
    shutil.copy(font, site / "assets/STIXTwoMath-Regular.ttf")
    light = HtmlFormatter(style="default").get_style_defs(".highlight")
    dark = HtmlFormatter(style="github-dark").get_style_defs(".highlight")
    (site / "assets/source.css").write_text(
        "body{max-width:60rem;margin:1rem auto;padding:0 1rem;font-family:sans-serif}pre{overflow-x:auto;font-size:.85rem}\n"
        f"{light}\n@media (prefers-color-scheme:dark){{body{{background:#1e2129;color:#ddd}}a{{color:#8ab4f8}}\n{dark}}}\n"
    )
