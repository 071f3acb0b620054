#!/bin/sh
# Draws the pictures of docs/pictures anew, each by the command that stands beside it in docs/pictures.txt, and renews the numbers
# in docs/pictures/digests.txt by which a test finds pictures that have grown old. Without names all but those of times.
# Usage, from the repository: docs/update_pictures.sh build/release/rosin [PICTURE…]
set -eu
rosin=$(realpath "$1")
shift
cd "$(dirname "$(realpath "$0")")/.."
for name in "$@"; do
  grep -q "^$name  *[^ ]*  *\(quick\|slow\|measured\) " docs/pictures.txt || { echo "no picture '$name' in docs/pictures.txt" >&2; exit 2; }
done
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
digests=docs/pictures/digests.txt
grep -v -e '^#' -e '^$' -e '^gallery/' docs/pictures.txt >"$results/rows"
while read -r picture file speed command; do
  [ "$speed" != browser ] || continue
  case " $* " in
    *" $picture "*) ;;
    '  ') [ "$speed" != measured ] || continue ;;
    *) continue ;;
  esac
  folder=$results/$(printf %s "$command" | cksum | tr ' ' -) # pictures of one command are drawn together
  if [ ! -d "$folder" ]; then
    mkdir "$folder"
    case $command in
      *.sh) "$command" "$rosin" "$folder" ;;
      *) eval "\"$rosin\" $command --out \"$folder\" --quiet" ;;
    esac </dev/null >"$folder.log" 2>&1 || { cat "$folder.log" >&2; exit 1; }
  fi
  cp "$folder/$file" "docs/pictures/$picture"
  echo "$picture"
  if [ "$speed" = quick ]; then
    docs/pictures/digest.py "$folder/$file" "$picture" >"$results/digest"
    grep -v "^$picture	" "$digests" >"$results/others" || true
    LC_ALL=C sort "$results/digest" "$results/others" >"$digests"
  fi
done <"$results/rows"
