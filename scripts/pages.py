#!/usr/bin/env python3
# What scripts/links, scripts/words and the site (mkdocs.yml, as a hook) share: which pages there are, and the prose, links and headings of one.
import html
import logging
import os
import posixpath
import re

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
at_root = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]


def all_pages():
    """Paths of all pages, relative to the project."""
    found = []
    for folder, _, names in os.walk(os.path.join(root, "docs")):
        found += [os.path.relpath(os.path.join(folder, name), root) for name in names if name.endswith(".md")]
    return at_root + sorted(found)


def read(page):
    with open(os.path.join(root, page), encoding="utf-8") as file:
        return file.read()


def is_generated(text):
    """Whether a program or script of the project prints the page."""
    return re.search(r"This page is what `|Written by `scripts/", re.sub(r"\s+", " ", text[:600])) is not None


def without_code(text):
    """The text with every character of code blocks and code spans made blank: lines and columns stay."""

    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))

    text = re.sub(r"^( *)(```+|~~~+).*?^\1\2", blank, text, flags=re.MULTILINE | re.DOTALL)
    lines = text.split("\n")
    code, item = False, 0
    for number, line in enumerate(lines):
        if not line.strip():
            continue
        indent = len(line) - len(line.lstrip())
        after_blank = number == 0 or not lines[number - 1].strip()
        # An indented block begins after an empty line; in a list it is indented further than the text of the item.
        code = indent >= item + 4 and (code or after_blank)
        if code:
            lines[number] = " " * len(line)
        elif start := re.match(r" *([-*+]|\d+\.) +", line):
            item = start.end()
        elif indent == 0 and after_blank:
            item = 0
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", blank, "\n".join(lines), flags=re.DOTALL)


link_pattern = re.compile(r"(\]\()([^()\s]+(?:\([^()\s]*\)[^()\s]*)*)((?: +\"[^\"]*\")?\))|^( *\[[^\]]+\]: +)(\S+)|((?:src|href)=\")([^\"]+)", re.MULTILINE)


def links(text):
    """Line, start and end in the text, and target of every link and image."""
    for match in link_pattern.finditer(without_code(text)):
        group = next(g for g in (2, 5, 7) if match.group(g) is not None)
        yield text.count("\n", 0, match.start()) + 1, match.start(group), match.end(group), match.group(group)


def is_outside(target):
    return re.match(r"[a-z]+:", target) is not None


def resolved(page, target):
    """The path, relative to the project, and the anchor that a link on a page leads to."""
    path, _, anchor = target.partition("#")
    return (posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page), anchor


def anchors(text):
    """The anchors of a page's headings, as GitHub and the site make them."""
    blanked = without_code(text).split("\n")
    found = set()
    for line, blank in zip(text.split("\n"), blanked):
        if match := re.match(r"#{1,6} +(.*?) *#*$", line if blank.startswith("#") else ""):
            words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", match.group(1))
            words = html.unescape(re.sub(r"`|\*|<[^>]*>", "", words))
            found.add(re.sub(r"[^\w\- ]", "", words.lower()).strip().replace(" ", "-"))
    return found


# The site: README, CHANGELOG and CONTRIBUTING are pages too, README the first. A link to a file outside of docs/ leads to a copy.


def existing(entries):
    """The nav without the pages that are not there; a page that is there and not listed is a warning (on_files)."""
    for title, value in (next(iter(entry.items())) for entry in entries):
        if isinstance(value, list):
            yield {title: list(existing(value))}
        elif os.path.isfile(os.path.join(root, value if value in at_root else "docs/" + value)):
            yield {title: value}


def on_config(config):
    config["nav"] = [entry for entry in existing(config["nav"]) if entry != {"Tutorials": []}]
    return config


def on_nav(nav, **_):
    """The reference of the header-only core, which Doxygen makes (scripts/site)."""
    from mkdocs.structure.nav import Link

    for section in nav.items:
        if section.title == "Reference":
            section.children.append(Link("Header-only core (C++)", "api/index.html"))
    return nav


def site_path(path):
    """Where the site has a file of the project: docs/ is its root, pages are HTML, what a browser would not show is text."""
    path = path[5:] if path.startswith("docs/") else path
    return path if re.search(r"\.(md|json|csv|png|svg|txt|html)$", path) else path + ".txt"


def on_files(files, config):
    from mkdocs.structure.files import File

    linked = set(at_root)
    for page in all_pages():
        targets = (resolved(page, target)[0] for *_, target in links(read(page)) if not is_outside(target))
        linked |= {path for path in targets if not path.startswith("docs/") and os.path.isfile(os.path.join(root, path))}
    for path in sorted(linked):
        file = File(site_path(path), root, config["site_dir"], config["use_directory_urls"])
        file.abs_src_path = os.path.join(root, path)
        files.append(file)
    listed = set(re.findall(r"[\w/]+\.md", str(config["nav"])))
    for file in files.documentation_pages():
        if file.src_uri not in listed and not file.src_uri.startswith("decisions/"):
            logging.getLogger("mkdocs.hooks").warning(f"mkdocs.yml: nav does not list {file.src_uri}")
    return files


def on_page_markdown(markdown, page, **_):
    """Links are rewritten from where the file lies in the project to where the site has it."""
    uri = page.file.src_uri
    source = uri if uri in at_root else "docs/" + uri
    for _, start, end, target in reversed(list(links(markdown))):
        if is_outside(target):
            continue
        path, anchor = resolved(source, target)
        if os.path.isdir(os.path.join(root, path)):
            path = posixpath.join(path, "README.md")
        if target.startswith("#") or not os.path.isfile(os.path.join(root, path)):
            continue
        there = posixpath.relpath(site_path(path), posixpath.dirname(uri) or ".")
        markdown = markdown[:start] + there + ("#" + anchor if anchor else "") + markdown[end:]
    return markdown
