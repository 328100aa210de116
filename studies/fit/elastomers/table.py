"""The table of docs/fit.md: every law fitted to every silicone of this folder.

    python3 studies/fit/elastomers/table.py build/isochor [largest strain]
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

LAWS = ["neo_hookean", "mooney_rivlin_2", "yeoh_3", "ogden_2", "gent"]


def constants(fit):
    shown = []
    for c in fit["constants"]:
        scale = 1e-3 if c["unit"] == "Pa" else 1
        shown.append(f"{scale * c['value']:.4g}")
    return ", ".join(shown)


def main():
    tool, to = sys.argv[1], (sys.argv[2] if len(sys.argv) > 2 else "2")
    print("| material | " + " | ".join(LAWS) + " |")
    print("|---|" + "---|" * len(LAWS))
    for path in sorted(Path(__file__).parent.glob("*.csv")):
        with tempfile.TemporaryDirectory() as folder:
            laws = [part for law in LAWS for part in ("--law", law)]
            command = [tool, "fit", path, "--to", to, "--json", "--out", folder, *laws]
            found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        fits = {fit["law"]: fit for fit in found["fits"]}
        cells = []
        for law in LAWS:
            fit = fits[law]
            if fit["material"] is None:
                cells.append("–")
                continue
            turns = "" if fit["stable"][1] >= found["curves"][0]["largest_stretch"] else f", turns over at {fit['stable'][1]:.3g}"
            cells.append(f"{constants(fit)} ({fit['r2']:.4f}{turns})")
        print(f"| {path.stem} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
