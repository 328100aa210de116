"""The code of pages runs, and prints what it says it prints."""

import contextlib
import io
import re

import pytest

from conftest import SOURCE

PAGE = SOURCE / "docs" / "python.md"
GRADIENTS = SOURCE / "docs" / "derivatives.md"


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def test_there_is_no_page_that_no_test_runs():
    assert {page for page in (SOURCE / "docs").rglob("*.md") if blocks(page)} == {PAGE, GRADIENTS}


@pytest.mark.parametrize("page, more_blocks, more_lines", [(PAGE, 8, 10), (GRADIENTS, 2, 2)])
def test_the_page_runs_from_top_to_bottom(page, more_blocks, more_lines, monkeypatch):
    monkeypatch.chdir(SOURCE)
    assert len(blocks(page)) > more_blocks
    names = {}
    printed_lines = 0
    for block in blocks(page):
        # Pieces of code, each with the lines that it is to print.
        for code, expected in re.findall(r"((?:^(?!#>).*\n)+)((?:^#> .*\n)*)", block, re.M):
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(code, str(page), "exec"), names)
            wanted = re.sub(r"^#> ", "", expected, flags=re.M)
            printed_lines += wanted.count("\n")
            assert out.getvalue() == wanted, code
    assert printed_lines > more_lines


def test_the_package_shows_the_loop_that_the_readme_shows():
    import isochor as iso

    for line in ("world = iso.World(gravity=(0, -9.81, 0))", 'air = world.add(iso.cavity(finger, surfaces="chamber"))'):
        assert line in iso.__doc__ and line in PAGE.read_text(encoding="utf-8")
