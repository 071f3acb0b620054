"""Texts of pictures: which stand over others, which are cut by the edge. A browser measures SVG by its own fonts and finds what
touches the edge of a PNG; pdftotext of poppler measures PDF."""

import base64
import html
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from xml.etree import ElementTree

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
PDFTOTEXT = shutil.which("pdftotext")
CLEARANCE = 0.5  # pixels by which boxes may reach into each other

# Boxes of all texts, from the left, top, right and bottom edge of the first picture's corner. Above capitals and below descenders a
# box of the browser has air, which is no text.
MEASURE = """
const found = {};
for (const picture of document.querySelectorAll('.svg')) {
  const frame = picture.querySelector('svg').getBoundingClientRect();
  const boxes = [];
  for (const text of picture.querySelectorAll('text')) {
    const parts = text.querySelectorAll('tspan').length ? text.querySelectorAll('tspan') : [text];
    for (const part of parts) {
      if (!part.textContent.trim() || getComputedStyle(part).visibility === 'hidden') continue;
      let {left, top, right, bottom} = part.getBoundingClientRect();
      const {a, b} = text.getScreenCTM();
      if (Math.abs(a) > Math.abs(b)) top += 0.15 * (bottom - top);
      else if (b < 0) left += 0.15 * (right - left);
      else right -= 0.15 * (right - left);
      boxes.push([part.textContent.trim(), left - frame.left, top - frame.top, right - frame.left, bottom - frame.top,
                  boxes.text === text ? boxes.at(-1)[5] : boxes.length]);
      boxes.text = text;
    }
  }
  found[picture.id] = [frame.width, frame.height, boxes];
}
for (const picture of document.querySelectorAll('img')) {
  const [width, height] = [picture.naturalWidth, picture.naturalHeight];
  const canvas = Object.assign(document.createElement('canvas'), {width, height}).getContext('2d');
  canvas.drawImage(picture, 0, 0);
  const edges = [[0, 0, width, 1], [0, height - 1, width, 1], [0, 0, 1, height], [width - 1, 0, 1, height]];
  found[picture.id] = edges.every(edge => canvas.getImageData(...edge).data.every(value => value === 255));
}
const answer = document.createElement('pre');
answer.textContent = JSON.stringify(found);
document.body.replaceChildren(answer);
"""


def texts_alone(svg: str) -> str:
    """A picture of gnuplot without its curves, which would make one page of all pictures too large."""
    svg = re.sub(r"<(path|polygon|use|rect|circle)\b[^>]*/>|<image\b.*?/>", "", svg[svg.index("<svg"):], flags=re.DOTALL)
    return re.sub(r"<defs>.*?</defs>", "", svg, flags=re.DOTALL)


def in_browser(pictures: list[Path]) -> dict:
    page = ['<!doctype html><meta charset="utf-8"><body style="margin: 0">']
    for picture in pictures:
        name = html.escape(str(picture))
        if picture.suffix == ".svg":
            page.append(f'<div class="svg" id="{name}">{texts_alone(picture.read_text(encoding="utf-8"))}</div>')
        else:
            page.append(f'<img id="{name}" src="data:image/png;base64,{base64.b64encode(picture.read_bytes()).decode()}">')
    page.append(f"<script>onload = () => {{{MEASURE}}}</script>")
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "pictures.html"
        file.write_text("\n".join(page), encoding="utf-8")
        ran = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={place}/profile",
                              "--virtual-time-budget=60000", "--dump-dom", file.as_uri()],
                             stdin=subprocess.DEVNULL, capture_output=True, text=True)
    answer = re.search(r"<pre>(.*)</pre>", ran.stdout, re.DOTALL)
    if not answer:
        raise SystemExit(f"{BROWSER} measured nothing: {ran.stderr}")
    return json.loads(html.unescape(answer[1]))


def boxes_of_pdf(picture: Path) -> tuple[float, float, list]:
    """In points; each word is a text, and words of a row touch nowhere."""
    ran = subprocess.run([PDFTOTEXT, "-bbox", picture, "-"], capture_output=True, text=True, check=True)
    page = next(ElementTree.fromstring(ran.stdout).iter("{http://www.w3.org/1999/xhtml}page"))
    boxes = []
    for number, word in enumerate(page):
        left, top, right, bottom = (float(word.get(side)) for side in ("xMin", "yMin", "xMax", "yMax"))
        boxes.append([word.text, left, top + 0.15 * (bottom - top), right, bottom, number])
    return float(page.get("width")), float(page.get("height")), boxes


def faults_of(width: float, height: float, boxes: list) -> list[str]:
    faults = [f"cut by the edge: {text}" for text, left, top, right, bottom, _ in boxes
              if min(left, top, width - right, height - bottom) < -CLEARANCE]
    for i, (text, left, top, right, bottom, whole) in enumerate(boxes):
        for other, begin, high, end, low, of in boxes[:i]:
            if whole != of and min(right, end) - max(left, begin) > CLEARANCE and min(bottom, low) - max(top, high) > CLEARANCE:
                faults.append(f"one over the other: {other} | {text}")
    return faults


def titles_of(script: Path) -> list[str]:
    """Titles of the curves of a script: gnuplot leaves out a key that has no room."""
    titles = re.findall(r"(?<!set) title '((?:[^']|'')*)'", script.read_text(encoding="utf-8"))
    return [re.sub(r"\\(.)", r"\1", title.replace("''", "'")) for title in dict.fromkeys(titles) if title]


def faults(pictures: dict[Path, list[str]]) -> dict[Path, list[str]]:
    """What is wrong with the texts of SVGs, PNGs and PDFs, each with the titles that it should show."""
    faulty = {}
    measured = in_browser([picture for picture in pictures if picture.suffix != ".pdf"])
    for picture, titles in pictures.items():
        if picture.suffix == ".png":
            found = [] if measured[str(picture)] else ["something reaches the edge"]
        else:
            width, height, boxes = boxes_of_pdf(picture) if picture.suffix == ".pdf" else measured[str(picture)]
            shown = "".join("".join(box[0].split()) for box in boxes)
            found = faults_of(width, height, boxes)
            found += [f"left out of the key: {title}" for title in titles
                      if any(word not in shown for word in title.split())]
        if found:
            faulty[picture] = found
    return faulty
