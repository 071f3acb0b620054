#!/bin/sh
# Reports in Debian's chromium, by playwright-core of npm: browser_test.sh ROSIN EXAMPLES FOLDER. Status 77: left out, for
# want of what the last line names.
set -eu
rosin=$1 examples=$2 folder=$3
browser=$(command -v chromium || command -v chromium-browser || true)
for program in node npm "${browser:-chromium}"; do
  if ! command -v "$program" >/dev/null; then
    echo "skipped: $program is missing (apt-get install chromium nodejs npm)"
    exit 77
  fi
done
mkdir -p "$folder"
[ -f "$folder/package.json" ] || echo '{ "private": true }' >"$folder/package.json"
if [ ! -d "$folder/node_modules/playwright-core" ] &&
  ! npm install --prefix "$folder" --no-audit --no-fund --silent playwright-core@1; then
  echo 'skipped: npm cannot install playwright-core'
  exit 77
fi
exec node "$(dirname "$0")/report_test.mjs" "$rosin" "$examples" "$folder" "$browser"
