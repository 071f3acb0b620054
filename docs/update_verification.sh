#!/bin/sh
# Renews docs/verification: the page and pictures of all cases, as `rosin verify` writes them.
# Usage, from the repository: docs/update_verification.sh build/release/rosin
set -eu
cd "$(dirname "$(realpath "$0")")/.."
"$1" verify --cases cases --out docs/verification || [ $? -eq 1 ] # what disagrees is shown too
cd docs/verification
find . -mindepth 1 -maxdepth 1 ! -name verify.md ! -name 'verify-*.svg' -exec rm -r {} +
