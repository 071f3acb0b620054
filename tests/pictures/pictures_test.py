#!/usr/bin/env python3
"""Pictures of the docs are those that rosin draws today: pictures_test.py ROSIN.

Each picture of docs/pictures has a row in docs/pictures.txt and is shown on a page, and so is each picture of a row; each example
has a row. The tables that quick ones are drawn from hold the numbers of docs/pictures/digests.txt. No text stands over another, and
none is cut by the edge: in stored SVGs, and in a picture of each kind on a screen and 85 and 175 mm wide, as SVG, PDF and PNG.
"""

import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs/pictures"))
import texts
from digest import digest

TOLERANCE = 1e-3  # of the largest number of a column: digests have four digits
LISTED = ROOT / "docs/pictures.txt"
DIGESTS = ROOT / "docs/pictures/digests.txt"


def check_list(rows: list[list[str]]) -> list[str]:
    faults = []
    shown = "".join(page.read_text(encoding="utf-8") for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
    pictures = {row[0] for row in rows if "/" not in row[0]}
    present = {file.name for file in (ROOT / "docs/pictures").iterdir() if file.suffix in (".svg", ".png")}
    faults += [f"docs/pictures/{name} has no row in {LISTED.name}: no command draws it" for name in present - pictures]
    faults += [f"{name} has a row in {LISTED.name} but is not in docs/pictures" for name in pictures - present]
    faults += [f"no page shows docs/pictures/{name}" for name in pictures if f"pictures/{name})" not in shown]
    faults += [f"the row of {row[0]} says '{row[2]}', not quick, slow, measured or browser" for row in rows
               if row[2] not in ("quick", "slow", "measured", "browser")]
    words = {word for row in rows for word in shlex.split(row[3])}
    scripts = "".join(file.read_text() for file in (ROOT / "docs/pictures").glob("*.sh"))
    for example in sorted((ROOT / "examples").glob("*.toml")):
        if f"examples/{example.name}" not in words and f"examples/{example.name}" not in scripts:
            faults.append(f"examples/{example.name} has no row in {LISTED.name}: the gallery shows it without a picture")
    known = {line.split("\t")[0] for line in DIGESTS.read_text(encoding="utf-8").splitlines()}
    wanted = {row[0] for row in rows if row[2] == "quick" and "/" not in row[0]}
    faults += [f"{name} is quick and has no digest; run {renew(name)}" for name in wanted - known]
    faults += [f"{DIGESTS.name} has lines of {name}, which is no quick picture" for name in known - wanted]
    return faults


def renew(name: str) -> str:
    return f"docs/update_pictures.sh build/release/rosin {name}"


def differs(old: str, new: str) -> bool:
    """Names are the same, and numbers within the tolerance."""
    (*names, least, mean, largest), (*others, low, middle, high) = old.split("\t"), new.split("\t")
    size = max(abs(float(least)), abs(float(largest)), abs(float(low)), abs(float(high)))
    return names != others or any(abs(float(a) - float(b)) > TOLERANCE * size
                                  for a, b in ((least, low), (mean, middle), (largest, high)))


def ask(rosin: str, command: str, rows: list[list[str]], folder: Path) -> list[str]:
    """Faults of the pictures that one command draws."""
    folder.mkdir()
    words = ([command, rosin, folder] if command.endswith(".sh") else
             [rosin, *shlex.split(command), "--out", folder, "--quiet", "--no-pictures", "--threads", "1"])
    ran = subprocess.run(words, cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if ran.returncode:
        return [f"{command}: exit status {ran.returncode}: {ran.stderr}"]
    faults = []
    for name, file, _, _ in rows:
        stored = [line for line in DIGESTS.read_text(encoding="utf-8").splitlines() if line.startswith(name + "\t")]
        today = sorted(digest(folder / file, name))
        changed = [f"  was {old}\n  is  {new}" for old, new in zip(sorted(stored), today) if differs(old, new)]
        if changed or len(stored) != len(today):
            faults.append("\n".join([f"docs/pictures/{name} has grown old; renew it by {renew(name)}", *changed[:3]]))
    return faults


# Pictures of kinds that no quick row draws, from fewer points.
OTHERS = [
    "branch examples/both-motions-in-two-parameters.toml --set branch.locus.points=10",
    "map examples/guettler-diagram.toml --set map.x.points=3 --set map.y.points=3",
    "compare examples/ageing-or-slip.toml --design --set map.x.points=4 --set map.y.points=4",
    "compare examples/which-law-plays-the-cello.toml --design --set map.x.points=2 --set map.y.points=2",
    "study examples/stick-slip-study.toml --set study.cases=10",
    "sweep examples/sliding-or-stick-slip.toml --set sweep.points=8",
    "sweep examples/forced-belt-sweep.toml --set sweep.points=8",
    "basin examples/which-motion.toml --set basin.x.points=5 --set basin.y.points=5",
    "run examples/elastic-block.toml --set run.duration=0.2",
]


def draw(script: Path) -> dict[Path, str]:
    """A picture of each format and width, with its name."""
    drawn = {}
    for width in (0, 85, 175):
        for kind in ("svg", "pdf", "png"):
            if kind == "pdf" and not texts.PDFTOTEXT or kind == "png" and width > 0:  # laid out as PDF is
                continue
            picture = script.with_name(f"{script.stem}-{width}.{kind}")
            subprocess.run(["gnuplot", "-e", f"format='{kind}'; output='{picture.name}'; width={width}", script.name],
                           cwd=script.parent, stdin=subprocess.DEVNULL, capture_output=True, check=True)
            drawn[picture] = f"{picture.stem.replace('-0', '')}.{kind}" + (f" of {width} mm" if width else "")
    return drawn


def check_texts(folders: dict[str, Path]) -> list[str]:
    if not texts.BROWSER or not shutil.which("gnuplot"):
        print("texts of pictures are left unmeasured: chromium or gnuplot is missing (apt-get install chromium gnuplot-nox)")
        return []
    names = {file: str(file.relative_to(ROOT)) for file in (ROOT / "docs").rglob("*.svg")}
    titles = {file: [] for file in names}
    for command, folder in folders.items():
        for script in sorted(folder.glob("*.gp")):
            if 'exists("width")' not in script.read_text(encoding="utf-8"):  # a script's own
                continue
            drawn = draw(script)
            names |= {picture: f"{command}: {name}" for picture, name in drawn.items()}
            titles |= dict.fromkeys(drawn, texts.titles_of(script))
    print(f"texts of {len(names)} pictures measured")
    return [f"{names[picture]}: {fault}" for picture, found in texts.faults(titles).items() for fault in found]


def main() -> None:
    rosin = str(Path(sys.argv[1]).resolve())
    rows = [line.split(None, 3) for line in LISTED.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    faults = check_list(rows)
    commands: dict[str, list[list[str]]] = {}
    for row in rows:
        if row[2] == "quick" and "/" not in row[0]:
            commands.setdefault(row[3], []).append(row)
    kinds: dict[str, str] = {}  # one command for all laws
    for command in [row[3] for row in rows if row[2] == "quick"] + OTHERS:
        kinds.setdefault(command.split(" --set law.type")[0], command)
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(2) as pool:
        folders = {command: Path(place) / str(number)
                   for number, command in enumerate(dict.fromkeys([*commands, *kinds.values()]))}
        asked = [pool.submit(ask, rosin, command, commands.get(command, []), folder)
                 for command, folder in folders.items()]
        for one in asked:
            faults += one.result()
        faults += check_texts({command: folders[command] for command in kinds.values()})
    print("\n".join(faults) or f"{len(rows)} pictures, {len(commands)} commands asked again")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
