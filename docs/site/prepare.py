#!/usr/bin/env python3
"""Lays out for Sphinx what the site is made of: prepare.py SOURCE FOLDER ROSIN.

The pages stand below FOLDER as they stand in the tree, so that links lead where they lead on GitHub. Beside them stand a page
for each example (scene, command, picture), and the pages of the C++ and Python interfaces. What docs/index.md links, in the
order of its headings, is the navigation: a page that it leaves out is a warning of Sphinx.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Doors of rooms, with what they include, and what a user of the library meets in the other folders.
ROOMS = ("analysis", "solvers")
HEADERS = """laws/catalogue.hpp laws/law.hpp laws/adapter.hpp laws/formula.hpp
    oscillators/model.hpp oscillators/structure.hpp oscillators/block.hpp oscillators/rigid_block.hpp
    oscillators/pin_on_disk.hpp oscillators/bowed_string.hpp
    app/add_oscillator.hpp app/command.hpp
    core/error.hpp core/parameters.hpp core/signal.hpp core/units.hpp core/system.hpp""".split()
NAMESPACES = {"rosin": "Errors, signals, units, parameters (core/)", "rosin::laws": "Laws (laws/)",
              "rosin::oscillators": "Sliders, structures, strings (oscillators/)",
              "rosin::app": "The command, and oscillators added to it (app/)"}


written: set[Path] = set()


def write(path: Path, text: str) -> None:
    """A file is left as it is where its text is the same, so that Sphinx reads changed pages only."""
    written.add(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def table(source: Path) -> list[tuple[str, str, str, str]]:
    """Rows of docs/pictures.txt: picture, file of the results, quick or slow, command."""
    lines = (source / "docs/pictures.txt").read_text(encoding="utf-8").splitlines()
    return [tuple(line.split(None, 3)) for line in lines if line and not line.startswith("#")]


def sections(index: str, folder: Path) -> list[tuple[str, list[str]]]:
    """Pages that docs/index.md links in its lists and tables, by heading; each page once."""
    seen, found = {"index"}, []
    for part in re.split(r"^## ", index, flags=re.MULTILINE)[1:]:
        heading, _, text = part.partition("\n")
        pages = []
        for target in re.findall(r"\]\(([^)#]+\.md)(?:#[^)]*)?\)", text):
            page = os.path.relpath((folder / target).resolve(), folder.resolve()).removesuffix(".md")
            if page not in seen and not heading.startswith("What can I ask"):
                seen.add(page)
                pages.append(page)
        if pages:
            found.append((heading.strip(), pages))
    return found


def toctree(caption: str, pages: list[str]) -> str:
    return f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"


def to_gallery(text: str) -> str:
    """Links to examples lead to their pages, which show them, rather than to files to be downloaded."""
    text = re.sub(r"\]\(((?:\.\./)*)examples/((?:python/)?[\w-]+)\.(toml|cpp|py)\)", r"](\1gallery/\2-\3.md)", text)
    return re.sub(r"\]\(((?:\.\./)*)examples/?\)", r"](\1gallery/index.md)", text)


class Gallery:
    """A page for each example, and one with all of them."""

    def __init__(self, source: Path, stage: Path, rosin: Path) -> None:
        self.source, self.stage, self.rosin = source, stage, rosin
        self.rows = table(source)
        self.pages = {page: page.read_text(encoding="utf-8") for page in sorted((source / "docs").rglob("*.md"))}

    def draw(self) -> None:
        """Pictures of examples that no page of docs/ shows; those that are newer than the program and what they show stay."""
        def one(row: tuple[str, str, str, str]) -> None:
            picture, file, _, command = row
            target, work = self.stage / picture, self.stage.parent / "results" / Path(picture).stem
            files = [word for word in shlex.split(command) if (self.source / word).is_file()]
            newest = max((self.source / file).stat().st_mtime for file in [self.rosin, *files])
            if target.exists() and target.stat().st_mtime > newest:
                return
            shutil.rmtree(work, ignore_errors=True)
            work.mkdir(parents=True)
            words = ([command, self.rosin, work] if command.endswith(".sh") else
                     [self.rosin, *shlex.split(command), "--out", work, "--quiet", "--threads", "1"])
            ran = subprocess.run(words, cwd=self.source, stdin=subprocess.DEVNULL, capture_output=True, text=True)
            if ran.returncode:
                raise SystemExit(f"rosin {command}: {ran.stderr}")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(work / file, target)

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(one, [row for row in self.rows if row[0].startswith("gallery/")]))

    def of(self, example: str) -> dict[str, list[str]]:
        """Pictures of an example, from the folder of the gallery, by the line of shell that draws them."""
        found: dict[str, list[str]] = {}
        for picture, _, _, command in self.rows:
            place = picture.removeprefix("gallery/") if "/" in picture else f"../docs/pictures/{picture}"
            if command.endswith(".sh") and example in (self.source / command).read_text(encoding="utf-8"):
                found.setdefault(f"{command} build/release/rosin FOLDER", []).append(place)
            elif example in shlex.split(command):
                found.setdefault(f"rosin {command}", []).append(place)
        return found

    def shown_on(self, example: str) -> list[str]:
        links = []
        for page, text in self.pages.items():
            if example in text and "verification" not in page.parts:
                title = re.search(r"^# (.*)", text, re.MULTILINE)[1]
                links.append(f"[{title}](../{page.relative_to(self.source)})")
        return links

    def write(self) -> None:
        entries, names = [], []
        for path in sorted((self.source / "examples").glob("**/*")):
            if path.suffix not in (".toml", ".cpp", ".py") or "out" in path.parts:
                continue
            example = str(path.relative_to(self.source))
            name = example.removeprefix("examples/").replace(path.suffix, f"-{path.suffix[1:]}")
            text = path.read_text(encoding="utf-8")
            comment = re.match(r"(?:(?:#|///?) ?.*\n)*", text)[0]
            question = " ".join(re.sub(r"^(#|///?) ?", "", line) for line in comment.splitlines())
            title = re.search(r'^title = "(.*)"', text, re.MULTILINE)
            title = title[1] if title else example.removeprefix("examples/")
            up = "../" * name.count("/")
            language = {".toml": "toml", ".cpp": "cpp", ".py": "python"}[path.suffix]
            page = f"# {title}\n\n{escaped(question)}\n"
            drawn = self.of(example)
            for command, pictures in drawn.items():
                page += f"\n```sh\n{command}\n```\n"
                page += "".join(f"\n![{escaped(title)}]({up}{picture})\n" for picture in pictures)
            if path.suffix == ".cpp":
                page += f"\n```sh\nbuild/release/examples/example_{path.stem}\n```\n"
            if path.suffix == ".py":
                page += f"\n```sh\nPYTHONPATH=build/release/python python3 {example}\n```\n"
            page += f"\n`{example}`:\n\n```{{literalinclude}} {up}../{example}\n:language: {language}\n```\n"
            shown = [link.replace("](", f"]({up}") for link in self.shown_on(example)]
            if shown:
                page += "\nExplained in: " + ", ".join(shown) + ".\n"
            write(self.stage / f"gallery/{name}.md", page)
            names.append(name)
            first = next(iter(drawn.values()), [""])[0]
            entries.append((title, name, first, question))
        overview = "# Examples\n\nEach is a file of `examples/`; its page shows it with its command and its picture.\n\n"
        overview += "::::{container} gallery\n"
        for title, name, picture, question in entries:
            image = f"[![{escaped(title)}]({picture})]({name}.md)\n\n" if picture else f"{escaped(question)}\n\n"
            overview += f":::{{container}} example\n{image}[{escaped(title)}]({name}.md)\n:::\n"
        overview += "::::\n" + toctree("Examples", names)
        write(self.stage / "gallery/index.md", overview)


def escaped(text: str) -> str:
    return re.sub(r"([*_\[\]<])", r"\\\1", text)


def headers(source: Path) -> list[str]:
    found = list(HEADERS)
    for room in ROOMS:
        for door in sorted((source / room).glob("*/*.hpp")):
            if door.stem == door.parent.name:
                included = re.findall(rf'#include "({room}/[^"]*)"', door.read_text())
                found += included or [str(door.relative_to(source))]
    return found


def write_doxyfile(source: Path, stage: Path) -> None:
    """Doxygen's settings: the first comment of a header is the file's, not that of the namespace below it."""
    write(stage.parent / "Doxyfile", "\n".join([
        f"INPUT = {' '.join(headers(source))}", f"OUTPUT_DIRECTORY = {stage.parent / 'doxygen'}",
        "GENERATE_XML = YES", "XML_PROGRAMLISTING = NO", "GENERATE_HTML = NO", "GENERATE_LATEX = NO", "QUIET = YES",
        "EXTRACT_ALL = YES", "JAVADOC_AUTOBRIEF = YES", "WARN_IF_INCOMPLETE_DOC = NO", "WARN_AS_ERROR = FAIL_ON_WARNINGS",
        "MACRO_EXPANSION = YES", "PREDEFINED = ROSIN_INLINE=", "EXCLUDE_SYMBOLS = *::detail detail",
        r"""INPUT_FILTER = "sed '1s,^///,/// \\file\n///,'" """]) + "\n")


def write_interfaces(source: Path, stage: Path) -> list[str]:
    namespaces = {**NAMESPACES}
    for room in ROOMS:
        for door in sorted((source / room).glob("*/*.hpp")):
            if door.stem == door.parent.name:
                first = re.match(r"/// ?(.*?)[.:]", door.read_text())[1]
                namespaces["::".join(["rosin", *door.parent.relative_to(source).parts])] = first
    pages = []
    for name, title in namespaces.items():
        folder = name.removeprefix("rosin").removeprefix("::").replace("::", "/")
        door = f"rosin/{folder}/{folder.split('/')[-1]}.hpp"
        included = (f"`#include <{door}>`\n\n" if "/" in folder else
                    "Headers: " + ", ".join(f"`<rosin/{one}>`" for one in HEADERS if one.startswith(folder or "core")) + "\n\n")
        body = f"```{{doxygennamespace}} {name}\n:content-only:\n:members:\n:undoc-members:\n```\n"
        pages.append(name.replace("::", "-"))
        write(stage / f"interface/{pages[-1]}.md", f"# {name}\n\n{title}.\n\n{included}{body}")
    python = ["The Python package", "==================", "", "How it is used: :doc:`from Python </docs/python>`.", "",
              ".. py:module:: rosin", ""]
    python += [f".. autofunction:: rosin.{one}\n" for one in ("load", "laws", "plot")]
    python += [f".. autoclass:: rosin.{one}\n   :members:\n" for one in
               ("Scene", "Result", "Law", "InputError", "IncompleteWarning")]
    write(stage / "interface/python.rst", "\n".join(python))
    return [f"../interface/{page}" for page in ("python", *pages)]


def main() -> None:
    source, stage, rosin = (Path(word).resolve() for word in sys.argv[1:4])
    for page in [source / "README.md", source / "CONTRIBUTING.md", *(source / "docs").rglob("*.md")]:
        write(stage / page.relative_to(source), to_gallery(page.read_text(encoding="utf-8")))
    for file in [source / "LICENSE", *(source / "docs/pictures").iterdir(), *(source / "docs/verification").iterdir()]:
        if file.is_file() and file.suffix != ".md":
            target = stage / file.relative_to(source)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(file, target)
    for folder in ("examples", "cases", "bench", "notebooks"):  # files that pages link to
        if not (stage / folder).is_symlink():
            (stage / folder).symlink_to(source / folder)
    (stage / "_static").mkdir(exist_ok=True)
    shutil.copy2(source / "docs/site/rosin.css", stage / "_static")
    shutil.copy2(source / "docs/site/conf.py", stage)
    write(stage / "extra/index.html", '<!doctype html><meta http-equiv="refresh" content="0; url=docs/index.html">\n')

    gallery = Gallery(source, stage, rosin)
    gallery.draw()
    gallery.write()
    write_doxyfile(source, stage)
    interfaces = write_interfaces(source, stage)
    index = to_gallery((source / "docs/index.md").read_text(encoding="utf-8"))
    for caption, pages in sections(index, source / "docs"):
        index += toctree(caption, pages)
    index += toctree("Interfaces", interfaces)
    write(stage / "docs/index.md", index)
    for folder in ("docs", "gallery", "interface"):  # pages that the tree no longer has
        for page in (stage / folder).rglob("*"):
            if page.suffix in (".md", ".rst") and page not in written:
                page.unlink()


if __name__ == "__main__":
    main()
