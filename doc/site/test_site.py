"""The site of target/book in a headless Chromium: `make book-test`. Pictures of it go to target/book-pictures."""

import json
import re
import sys
from html.parser import HTMLParser
from urllib.parse import unquote

import markdown
import pytest
from conftest import BOOK, DESK, PHONE, PICTURES, ROOT

PAGES = sorted(
    path.relative_to(BOOK).as_posix() for path in BOOK.rglob("*.html") if path.relative_to(BOOK).parts[0] != "source"
)

sys.path.insert(0, str(ROOT / "doc/site"))



# What a page shows: pictures, formulas, and text that is still Markdown.
SEEN = """async () => {
  const pictures = [...document.querySelectorAll('.md-content img')];
  await Promise.all(pictures.map(picture => { picture.loading = 'eager'; return picture.decode().catch(() => 0); }));
  const text = [...document.querySelectorAll('.md-content p, .md-content li, .md-content td, .md-content dd')].map(element => {
    const copy = element.cloneNode(true);
    copy.querySelectorAll('code, pre, math, p, ul, ol, table, .highlight').forEach(child => child.remove());
    return copy.textContent;
  });
  return {
    empty: pictures.filter(picture => !picture.naturalWidth || !picture.naturalHeight).map(picture => picture.src),
    flat: [...document.querySelectorAll('.md-content math')].filter(formula => {
      const box = formula.getBoundingClientRect();
      return !box.width || !box.height;
    }).map(formula => formula.outerHTML.slice(0, 80)),
    raw: text.filter(words => /\\]\\(|\\*\\*|\\$\\$|\\\\\\(|\\\\\\[|^\\s*[-*] |\\n\\s*([-*]|\\d\\.) |^\\s*\\| .* \\||```|\\[!/.test(words)).map(words => words.slice(0, 120)),
    left: document.querySelectorAll('.arithmatex').length,
    title: (document.querySelector('.md-content h1') || {}).textContent,
  };
}"""


@pytest.mark.parametrize("page", PAGES)
def test_page_is_whole(page, tab, address):
    tab.goto(f"{address}/{page}", wait_until="load")
    seen = tab.evaluate(SEEN)
    assert seen["empty"] == [], "pictures without a size"
    assert seen["flat"] == [], "formulas without a size"
    assert seen["raw"] == [] and seen["left"] == 0, "Markdown or LaTeX that was not read"
    assert seen["title"]
    tab.set_viewport_size(PHONE)
    wide = tab.evaluate("[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
    assert wide[0] <= wide[1], "the page can be scrolled sideways on a phone"
    assert tab.faults == []


class Links(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids |= {attributes[key] for key in ("id", "name") if attributes.get(key)}
        if tag in ("a", "img", "script", "link"):
            self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def test_links_lead_somewhere():
    parsed = {path: Links(path.read_text()) for path in BOOK.rglob("*.html")}
    broken = []
    for path, page in parsed.items():
        if path.name == "404.html":
            continue  # Its addresses begin at the root of a server.
        for link in page.links:
            if re.match(r"[a-z]+:", link):
                continue
            file, _, anchor = unquote(link).partition("#")
            target = (path.parent / file).resolve() if file else path
            if target.is_dir():
                target = target / "index.html"
            if not target.is_file() or (anchor and target in parsed and anchor not in parsed[target].ids):
                # The scripts of the theme make these two themselves.
                if anchor not in ("__search", "__drawer"):
                    broken.append(f"{path.relative_to(BOOK)}: {link}")
    assert broken == []
    assert len(parsed) > 20


def test_no_page_is_lost():
    pages = [path for path in (ROOT / "doc").rglob("*.md") if not {"site", "error-vs-time"} & set(path.parts)]
    front = (BOOK / "index.html").read_text()
    for path in pages:
        address = path.relative_to(ROOT / "doc").with_suffix(".html").as_posix()
        assert (BOOK / address).is_file(), address
        assert f'href="{address}"' in front or address == "index.html", f"{address} is not in the navigation"


NOTEBOOKS = sorted((ROOT / "python/docs").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda notebook: notebook.stem)
def test_page_of_a_notebook_is_fresh(notebook):
    """Every cell is on its page as it is now. `make python-docs` compares the outputs; with PAGES=--write it writes the pages."""
    page = (ROOT / f"doc/python/{notebook.stem}.md").read_text()
    for cell in json.loads(notebook.read_text())["cells"]:
        source = re.sub(r"^%.*\n", "", "".join(cell["source"]), flags=re.MULTILINE).replace("](../../doc/", "](../")
        assert source in page, cell["id"]


def test_gallery_has_every_notebook_and_example():
    gallery = (ROOT / "doc/python/gallery.md").read_text()
    for notebook in NOTEBOOKS:
        assert f"](notebooks/{notebook.stem}.png)]({notebook.stem}.md)" in gallery
    for example in (ROOT / "python/examples").glob("*.py"):
        assert f"](../../python/examples/{example.name})" in gallery


def test_every_public_name_has_a_place():
    """Names of the module, by `__all__`, are headings of its API, or in a table there."""
    import hooks

    pages = [path.read_text() for path in (BOOK / "python/api").glob("*.html")]
    ids = set().union(*(Links(page).ids for page in pages))
    for name in hooks.public_names():
        there = any(anchor.split(".")[-1] == name and anchor.startswith("stickslip.") for anchor in ids)
        assert there or any(f"<code>stickslip.{name}</code>" in page for page in pages), name
    text = " ".join(re.sub(r"<[^>]*>", " ", page) for page in pages)
    # Sections of docstrings were read as such, and no role of reStructuredText is left.
    assert not re.search(r"-{8,}|:(class|func|meth|math|ref):|^\.\. ", text, re.MULTILINE)


@pytest.mark.parametrize("words", ["press fit", "fretting", "friction"])
def test_search_finds(words, tab, address):
    tab.goto(address)
    found = search(tab, words)
    found.first.click()
    tab.wait_for_load_state()
    assert tab.url.split("?")[0] not in (address, f"{address}/", f"{address}/index.html")
    content = tab.locator(".md-content").inner_text().lower()
    assert all(word in content for word in words.split())
    assert tab.faults == []


def search(tab, words):
    if tab.viewport_size["width"] < 1000:
        tab.locator("label[for=__search]").first.click()
    else:
        tab.locator("input.md-search__input").click()
    # The theme searches when a key is released, which filling in the field does not do.
    tab.locator("input.md-search__input").press_sequentially(words)
    found = tab.locator(".md-search-result__item a")
    found.first.wait_for()
    return found


def test_search_without_a_server(tab):
    tab.goto((BOOK / "index.html").as_uri())
    found = search(tab, "friction")
    assert found.count() > 3
    assert tab.faults == []


def test_dark_and_light(tab, address):
    tab.emulate_media(color_scheme="dark")
    tab.goto(address)
    shade = "Math.max(...getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3).map(Number))"
    assert tab.evaluate(shade) < 80
    tab.screenshot(path=PICTURES / "dark.png")
    tab.locator("label[title=Light]").click()
    tab.wait_for_function(f"{shade} > 200")


FORMULAS = r"""
Text with $\bar w_t$ and, right after it,
$$
K u + C_n^{\mathsf T} p_n = f \tag{15}
$$
- an item
  - another $|p_t| \le \mu p_n$
1. a step

   ```sh
   stickslip run x.toml
   ```
2. the next

```math
\begin{aligned} w_n &\le g \\ p_n &\ge 0 \end{aligned}
```
| a | b |
| --- | --- |
| `x \| y` | $\sigma_n$ |

> [!WARNING]
> Mind this.
"""


def test_formulas_and_github_markdown(tab, caplog):
    import hooks

    extensions = ["tables", "sane_lists", "admonition", "pymdownx.superfences", "pymdownx.arithmatex", hooks.AsOnGithub()]
    text = markdown.markdown(
        hooks.as_on_github(FORMULAS), extensions=extensions, extension_configs={"pymdownx.arithmatex": {"generic": True}}
    )
    page = type("Page", (), {"file": type("File", (), {"src_uri": "page.md"})})
    text = hooks.on_page_content(text, page, None, None)
    tab.set_content(f'<div class="md-content"><h1>Formulas</h1>{text}</div>')
    seen = tab.evaluate(SEEN)
    assert seen["raw"] == [] and seen["flat"] == [] and seen["left"] == 0
    counted = {name: tab.locator(name).count() for name in ["math", "ul", "ol", "ol > li pre", ".number", ".admonition", "table"]}
    assert counted == {"math": 5, "ul": 2, "ol": 1, "ol > li pre": 1, ".number": 1, ".admonition": 1, "table": 1}, text
    assert tab.locator("td code").inner_text() == "x | y"
    hooks.mathml(r"\unknown{x}", False, "page.md")
    assert "the formula" in caplog.text


def test_indented_code_stays_code():
    import hooks

    code = "Text:\n\n    a = [1]\n    b = a[:, 0][2]\n\n    - c\n"
    assert hooks.as_on_github(code) == code
    assert hooks.as_on_github("- an item\n      goes on\n") == "- an item\n    goes on\n"


def test_the_scene_of_the_first_page_is_the_one_that_is_drawn():
    scene = (ROOT / "doc/lap.toml").read_text()
    assert f"```toml\n{scene}```" in (ROOT / "README.md").read_text()


def test_pictures(tab, address):
    """Takes pictures for people to look at."""
    tutorials = [page for page in PAGES if page.startswith("tutorials/")]
    tutorial = next((page for page in tutorials if "lap-joint" in page), tutorials[0])
    shown = [("front", "index.html"), ("tutorial", tutorial), ("theory", "method/theory.html")]
    shown += [(name, f"python/{page}.html") for name, page in [("gallery", "gallery"), ("notebook", "ten_minutes"), ("api", "api/results")]]
    for name, page in shown[3:] + shown[:3]:
        tab.goto(f"{address}/{page}")
        tab.screenshot(path=PICTURES / f"{name}.png")
    tab.evaluate("(document.querySelectorAll('.formula')[1] || document.body).scrollIntoView({block: 'center'})")
    tab.screenshot(path=PICTURES / "formulas.png")
    tab.goto(address)
    search(tab, "friction")
    tab.wait_for_timeout(300)
    tab.screenshot(path=PICTURES / "search.png")
    tab.set_viewport_size(PHONE)
    for name, page in shown[3:] + shown[:3]:
        tab.goto(f"{address}/{page}")
        tab.screenshot(path=PICTURES / f"phone_{name}.png")
    tab.evaluate("(document.querySelectorAll('.formula')[1] || document.body).scrollIntoView({block: 'center'})")
    tab.screenshot(path=PICTURES / "phone_formulas.png")
