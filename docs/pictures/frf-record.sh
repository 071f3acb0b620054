#!/bin/sh
# A response out of a record, that of the experiment in examples/frf-noise.toml: frf-record.sh ROSIN FOLDER
set -eu
rosin=$1 folder=$(realpath "$2")
"$rosin" frf examples/frf-noise.toml --out "$folder/noise" --quiet --no-pictures
"$rosin" frf examples/frf-record.toml --set "frf.record.file=$folder/noise/frf-record.csv" --out "$folder" --quiet
