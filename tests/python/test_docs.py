"""The code of docs/python.md runs, and prints what it says it prints."""

import contextlib
import io
import re

from conftest import SOURCE

PAGE = SOURCE / "docs" / "python.md"


def blocks():
    return re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)


def test_the_page_runs_from_top_to_bottom(monkeypatch):
    monkeypatch.chdir(SOURCE)
    assert len(blocks()) > 8
    names = {}
    printed_lines = 0
    for block in blocks():
        # Pieces of code, each with the lines that it is to print.
        for code, expected in re.findall(r"((?:^(?!#>).*\n)+)((?:^#> .*\n)*)", block, re.M):
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(code, str(PAGE), "exec"), names)
            wanted = re.sub(r"^#> ", "", expected, flags=re.M)
            printed_lines += wanted.count("\n")
            assert out.getvalue() == wanted, code
    assert printed_lines > 10


def test_the_package_shows_the_loop_that_the_readme_shows():
    import isochor as iso

    for line in ("world = iso.World(gravity=(0, -9.81, 0))", 'air = world.add(iso.cavity(finger, surfaces="chamber"))'):
        assert line in iso.__doc__ and line in PAGE.read_text(encoding="utf-8")
