"""Check of the derivations: outputs against the files beside the scripts, docs/errata.md against
the outputs.

    python3 docs/derivations/check.py             all; exit 1 where something differs
    python3 docs/derivations/check.py --write     writes the outputs anew

In docs/errata.md a paragraph that begins with `*Shown by*` names scripts by links; every number
with a decimal point in it must stand in the output of one of them. Those of the overview may be
rounded. Every link within the page must have its heading.
"""

import difflib
import os
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
ERRATA = HERE.parent / "errata.md"
NO_DERIVATION = {"check.py", "common.py"}
NO_ERRATUM = {"invertibility"}


def output(script):
    """Returns the output of the script, or None after printing why there is none."""
    environment = os.environ | {"PYTHONPATH": "", "PYTHONHASHSEED": "0", "PYTHONIOENCODING": "utf-8", "PYTHONDONTWRITEBYTECODE": "1"}
    run = subprocess.run([sys.executable, script], cwd=HERE, env=environment, capture_output=True, text=True, encoding="utf-8")
    if run.returncode == 0:
        return run.stdout
    print(f"{script.name}: failed\n{run.stderr}", end="")
    if "ModuleNotFoundError" in run.stderr:
        print(f"needed once: {sys.executable} -m pip install -r {HERE / 'requirements.txt'}")
    return None


def compare(script, write):
    """Returns True if the output of the script is the committed one."""
    printed = output(script)
    if printed is None:
        return False
    committed = script.with_suffix(".txt")
    if write:
        committed.write_text(printed, encoding="utf-8")
    before = committed.read_text(encoding="utf-8") if committed.exists() else ""
    if before == printed:
        print(f"{script.name}: as committed")
        return True
    print(f"{script.name}: differs")
    sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), printed.splitlines(True), committed.name, "now"))
    return False


def quoted_numbers():
    """Returns numbers of the errata that are in no output, and scripts that it does not name."""
    faults = []
    linked = set()
    page = ERRATA.read_text(encoding="utf-8")
    for paragraph in page.split("\n\n"):
        if not paragraph.startswith("*Shown by*"):
            continue
        names = re.findall(r"\]\(derivations/([a-z_]+)\.py\)", paragraph)
        linked.update(names)
        faults += [f"no output of {name}.py" for name in names if not output_of(name)]
        text = " ".join(output_of(name) for name in names)
        known = set(re.findall(r"\d+\.\d+", text))
        faults += [f"{number} is not in the output of {', '.join(names) or 'any script'}"
                   for number in re.findall(r"\d+\.\d+", paragraph) if number not in known]
    faults += [f"{name}.py is not named" for name in sorted({script.stem for script in derivations()} - linked - NO_ERRATUM)]
    return faults + overview_faults(page)


def overview_faults(page):
    """Returns numbers of the overview that round none of their entry's scripts, and dead links."""
    entries = {}
    for entry in re.split(r"^#+ ", page, flags=re.M)[1:]:
        heading, _, body = entry.partition("\n")
        entries[re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")] = body
    faults = [f"no heading for #{anchor}" for anchor in re.findall(r"\]\(#([^)]*)\)", page) if anchor not in entries]
    for anchor, row in re.findall(r"^\| \[\w+\]\(#([^)]*)\) \|[^|]*\|(.*)$", page, re.M):
        text = " ".join(output_of(name) for name in re.findall(r"\]\(derivations/([a-z_]+)\.py\)", entries.get(anchor, "")))
        known = [float(number) for number in re.findall(r"\d+\.\d+", text)]
        for number in re.findall(r"\d+\.\d+", row):
            digits = len(number.split(".")[1])
            if not any(round(value, digits) == float(number) for value in known):
                faults.append(f"{number} of the overview is in no output of #{anchor}")
    return faults


def output_of(name):
    """Returns the committed output of a script; empty if there is none."""
    file = HERE / f"{name}.txt"
    return file.read_text(encoding="utf-8") if file.exists() else ""


def derivations():
    return sorted(script for script in HERE.glob("*.py") if script.name not in NO_DERIVATION)


def main():
    write = sys.argv[1:] == ["--write"]
    if sys.argv[1:] and not write:
        print(__doc__.strip())
        return 2
    same = [compare(script, write) for script in derivations()]
    faults = quoted_numbers()
    for fault in faults:
        print(f"{ERRATA.name}: {fault}")
    print(f"{sum(same)} of {len(same)} scripts as committed, {len(faults)} faults in the errata")
    return 0 if all(same) and not faults else 1


if __name__ == "__main__":
    sys.exit(main())
