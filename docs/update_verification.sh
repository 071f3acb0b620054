#!/bin/sh
# Renews docs/verification: the page and pictures of all cases, as `rosin verify` writes them.
# Usage, from the repository: docs/update_verification.sh build/release/rosin
set -eu
rosin=$(realpath "$1")
root=$(dirname "$(realpath "$0")")/..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$rosin" verify --cases "$root/cases" --out "$work" || [ $? -eq 1 ] # what disagrees is shown too
rm -rf "$root/docs/verification"
mkdir "$root/docs/verification"
cp "$work"/verify.md "$work"/verify-*.svg "$root/docs/verification/"
