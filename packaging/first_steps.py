"""What the README shows in Python, and the command and an FMU, in an environment that holds NumPy and the wheel alone."""

import doctest
import importlib.metadata
import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main() -> None:
    """Goes through them; what does not hold is an error."""
    os.chdir(ROOT)
    begun = time.process_time()
    import numpy

    of_numpy = time.process_time() - begun
    import springpot

    own = time.process_time() - begun - of_numpy
    print(f"import: {1e3 * own:.0f} ms of CPU beside NumPy's {1e3 * of_numpy:.0f} (NumPy {numpy.__version__})")
    assert own < 0.1, own
    assert ROOT / "crates" not in Path(springpot.__file__).parents, "the installed package, not the one of the tree"
    for name in ("matplotlib", "pandas", "scipy"):
        assert importlib.util.find_spec(name) is None, f"{name} is here"
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = "\n".join(block.split("```")[0] for block in text.split("```pycon\n")[1:])
    test = doctest.DocTestParser().get_doctest(lines, {}, "README.md", "README.md", 0)
    results = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test)
    assert results.attempted >= 8 and results.failed == 0, results
    licences = importlib.metadata.metadata("springpot").get_all("License-File") or []
    assert len(licences) >= 4, licences
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "springpot"]
        subprocess.run([*command, "--version"], check=True)
        scenario = str(ROOT / "scenarios/thermoviscoelastic_order.toml")
        subprocess.run([*command, "run", scenario, "--out", f"{folder}/run", "--quiet"], check=True)
        assert (Path(folder) / "run/results.csv").stat().st_size > 100_000
    print("first steps: all of it holds")


if __name__ == "__main__":
    main()
