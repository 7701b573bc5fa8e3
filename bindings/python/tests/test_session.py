"""Pages of docs with code and its output, run from their beginning to their end."""

import contextlib
import io
import re
import shutil

import pytest

CAMERA = "host-sim/cameras/phase-one-ixm-rs150f-50.toml"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def printed(page):
    """Code, what it prints, and what the page says that it prints."""
    names = {}
    blocks = BLOCK.findall(page)
    for (kind, code), (next_kind, output) in zip(blocks, [*blocks[1:], ("", "")]):
        if kind == "python":
            assert next_kind == "output", code
            with contextlib.redirect_stdout(io.StringIO()) as text:
                exec(compile(code, "docs", "exec"), names)
            yield code, text.getvalue(), output


@pytest.mark.parametrize("page, least", [("docs/python-session.md", 6), ("docs/start.md", 1)])
def test_page_prints_what_it_shows(page, least, root, tmp_path, monkeypatch):
    shutil.copy(root / CAMERA, tmp_path / "camera.toml")
    monkeypatch.chdir(tmp_path)
    compared = 0
    for code, found, shown in printed((root / page).read_text(encoding="utf-8")):
        assert found == shown, code
        compared += 1
    assert compared >= least


def test_output_that_differs_is_found():
    page = '```python\nprint(1)\n```\n\n```output\n2\n```\n'
    [(_, found, shown)] = printed(page)
    assert (found, shown) == ("1\n", "2\n")
