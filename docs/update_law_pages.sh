#!/bin/sh
# Renews what is generated in docs/laws: each page's card (`rosin laws NAME`). docs/update_pictures.sh draws the
# pictures below: the steady curve, and those that docs/pictures.txt lists as law-NAME-step, -hold, -loop or -run.
# Usage, from the repository: docs/update_law_pages.sh build/release/rosin
set -eu
rosin=$(realpath "$1")
root=$(dirname "$(realpath "$0")")/..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for page in "$root"/docs/laws/*.md; do
  law=$(basename "$page" .md)
  sed '/^<!-- card -->$/,$d' "$page" >"$work/page"
  {
    cat "$work/page"
    echo '<!-- card -->'
    echo '## Card and steady curve'
    echo
    printf '```sh\nrosin laws %s\n```\n\n```text\n' "$law"
    "$rosin" laws "$law" | sed '/^$/d'
    printf '```\n\n![Steady friction curve of the law with its default parameters](../pictures/law-%s.svg)\n' "$law"
    for shown in 'step:Answer to velocity steps (`rosin lab velocity-step`)' \
        'hold:Peaks after holds (`rosin lab slide-hold-slide`)' 'loop:To and fro (`rosin lab reciprocation`)' \
        'run:Stick-slip under a drive that slows down (`rosin run`)'; do
      if grep -q "^law-$law-${shown%%:*}\.svg " "$root/docs/pictures.txt"; then
        printf '\n![%s of the law](../pictures/law-%s-%s.svg)\n' "${shown#*:}" "$law" "${shown%%:*}"
      fi
    done
  } >"$page.new"
  mv "$page.new" "$page"
done
