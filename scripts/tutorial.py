#!/usr/bin/env python3
# What scripts/tutorial does once the program `furcula` is there: tutorial.py PROGRAMS PAGE.
#
# In the page a block `xml` or `toml` is the file that the text before it names last, `sh` is commands, and `text` below them what they print, however
# the lines are wrapped. A command may fail only where its output begins with "furcula: ".
import os
import re
import subprocess
import sys
import tempfile
import time

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def fail(page, line, message):
    sys.exit(f"{page}:{line}: {message}")


def main():
    programs, page = sys.argv[1:]
    with open(page, encoding="utf-8") as file:
        text = file.read()
    environment = dict(os.environ, PATH=programs + os.pathsep + os.environ["PATH"])

    printed, last, commands = None, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for block in BLOCK.finditer(text):
            kind, content = block.groups()
            line = text.count("\n", 0, block.start()) + 1
            if kind in ("xml", "toml"):
                names = re.findall(r"`([\w.]+\.(?:urdf|toml|xml))`", text[last : block.start()])
                if not names:
                    fail(page, line, "the text before the block names no file")
                with open(os.path.join(folder, names[-1]), "w", encoding="utf-8") as file:
                    file.write(content)
            elif kind == "sh":
                if printed:
                    fail(page, line, "the page does not show what the commands before print: " + printed)
                began = time.monotonic()
                ran = subprocess.run(["bash", "-ec", content], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                printed, commands = ran.stdout, commands + 1
                print(f"{time.monotonic() - began:6.1f} s  {content.splitlines()[0][:100]}", flush=True)
                if ran.returncode != 0 and not printed.startswith("furcula: "):
                    fail(page, line, f"status {ran.returncode}:\n{printed}")
            elif kind == "text" and printed is not None:
                if printed.split() != content.split():
                    fail(page, line, f"the page shows\n{content}\nand the commands print\n{printed}")
                printed = None
            last = block.end()
    if printed or commands == 0:
        fail(page, 1, "the page has no commands, or does not show what the last ones print")
    print(f"{commands} blocks of commands print what the page shows")


main()
