# docs/python.md: its blocks run one after the other, and print what stands below them.
import contextlib
import io
import re

from conftest import SOURCE

BLOCK = re.compile(r"^```(python|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_tutorial_prints_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
    names, printed, blocks = {"SOURCE": str(SOURCE)}, None, 0
    for kind, text in BLOCK.findall(page):
        if kind == "python":
            assert not printed, f"the page does not show what is printed: {printed}"
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(text, f"docs/python.md, block {blocks}", "exec"), names)
            printed, blocks = out.getvalue(), blocks + 1
        elif printed is not None:
            assert printed == text
            printed = None
    assert not printed
    assert blocks >= 8
