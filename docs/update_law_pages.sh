#!/bin/sh
# Renews what is generated in docs/laws: each page's card (`rosin laws NAME`) and its figure (`rosin curve`).
# Usage, from the repository: docs/update_law_pages.sh build/release/rosin
set -eu
rosin=$(realpath "$1")
root=$(dirname "$(realpath "$0")")/..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for page in "$root"/docs/laws/*.md; do
  law=$(basename "$page" .md)
  printf '[law]\ntype = "%s"\n' "$law" >"$work/$law.toml"
  case $law in coulomb | stribeck | hyperbolic | two-exponential | tabulated | lugre | dahl | \
    slip-distance | slip-weakening | static-growth | kato-growth | loading-rate | thermal | thermal-disc | thermal-layer | lugre-unscaled) printf '[curve]\nfrom = 1e-4\nto = 1\n' >>"$work/$law.toml" ;;
    flash-heating) printf '[curve]\nfrom = 1e-6\nto = 10\n' >>"$work/$law.toml" ;; esac
  "$rosin" curve "$work/$law.toml" --out "$work/$law" --quiet >/dev/null
  cp "$work/$law/curve.svg" "$root/docs/pictures/law-$law.svg"
  sed '/^<!-- card -->$/,$d' "$page" >"$work/page"
  {
    cat "$work/page"
    echo '<!-- card -->'
    echo '## Card and steady curve'
    echo
    printf '```sh\nrosin laws %s\n```\n\n```text\n' "$law"
    "$rosin" laws "$law" | sed '/^$/d'
    printf '```\n\n![Steady friction curve of the law with its default parameters](../pictures/law-%s.svg)\n' "$law"
  } >"$page.new"
  mv "$page.new" "$page"
done
