"""Flesch reading ease and sentence length of the pages: `readability.py [FOLDER]`, the repository unless given.

Code, tables, formulas and headings are left out; code and formulas within a sentence count as a word of one syllable. Syllables are
counted by textstat. Sentences are split here, since textstat splits numbers, too. Reading ease: 60 to 70 is plain English, 30 to 50
is difficult, below 30 is for specialists.
"""

import re
import sys
from pathlib import Path

import textstat

LEFT_OUT = {"site", "error-vs-time", "target"}


def prose(text):
    """The sentences of a page."""
    text = re.sub(r"^( *)(```|~~~).*?^\1\2 *$", "\n\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\$\$.*?\$\$", "\n\n", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    # What a notebook printed as HTML, and names of the Python module.
    text = re.sub(r"^(<div class=\"output\">|::: ).*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"^ *\|.*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"^#.*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`|\$[^$\n]+\$", "code", text)
    text = re.sub(r"^ *(>|[-*+]|\d+[.)]) +", "\n\n", text, flags=re.MULTILINE)
    text = re.sub(r"[*_]{1,3}(\S)|(\S)[*_]{1,3}", r"\1\2", text)
    sentences = []
    for paragraph in re.split(r"\n\s*\n", text):
        paragraph = " ".join(paragraph.split())
        sentences += re.split(r"(?<=[.!?])\)?\s+(?=[A-Z(])", paragraph)
    words = [re.findall(r"[A-Za-zÀ-ÿ][A-Za-zÀ-ÿ'’-]*", sentence) for sentence in sentences]
    return [found for found in words if found]


def measure(sentences):
    """Words, mean sentence length, the share of sentences above 20 words, reading ease."""
    words = [word for sentence in sentences for word in sentence]
    if not words:
        return 0, 0.0, 0.0, 0.0
    syllables = sum(max(1, textstat.syllable_count(word)) for word in words)
    length = len(words) / len(sentences)
    ease = 206.835 - 1.015 * length - 84.6 * syllables / len(words)
    return len(words), length, sum(len(sentence) > 20 for sentence in sentences) / len(sentences), ease


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2])
    pages = [page for page in sorted((root / "doc").rglob("*.md")) if not LEFT_OUT & set(page.relative_to(root).parts)]
    parts, everything = {}, []
    print(f"{'words':>7} {'words/sentence':>15} {'above 20':>9} {'ease':>6}  page")
    for page in [root / "README.md", *pages]:
        sentences = prose(page.read_text())
        name = page.relative_to(root)
        parts.setdefault(name.parent.as_posix() if len(name.parts) < 4 else "/".join(name.parts[:2]), []).extend(sentences)
        everything += sentences
        show(name.as_posix(), sentences)
    print()
    for name, sentences in parts.items():
        show(f"{name}/", sentences)
    show("all", everything)


def show(name, sentences):
    words, length, long, ease = measure(sentences)
    print(f"{words:7} {length:15.1f} {long:9.0%} {ease:6.1f}  {name}")


if __name__ == "__main__":
    main()
