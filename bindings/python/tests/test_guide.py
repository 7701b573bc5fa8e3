"""The code of docs/python.md, run from its beginning to its end."""

import re
import shutil

import flights


def test_code_of_the_guide_runs(root, tmp_path, monkeypatch):
    shutil.copy(flights.CAMERA, tmp_path / "camera.toml")
    shutil.copy(flights.RECORDS, tmp_path / "records.csv")
    monkeypatch.chdir(tmp_path)
    guide = (root / "docs/python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", guide, re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 5
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
