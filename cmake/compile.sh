#!/bin/sh
# Compiles by way of ccache: compile.sh CCACHE BASE COMPILER ARGUMENT…
# A precompiled header is never the same bytes twice, and what includes it would never be found in the cache. So it is
# known by a checksum of the command and of the files that it was compiled from. Paths below BASE are hashed relative to
# it: several checkouts share the cache.
set -eu
ccache=$1
export CCACHE_BASEDIR="$2" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=1
shift 2
"$ccache" "$@"
previous=
for argument in "$@"; do
  case "$previous $argument" in
    "-o "*.gch)
      { printf '%s\n' "$*" | sed "s|$CCACHE_BASEDIR||g"; sed 's/^[^:]*://; s/\\$//' "$argument.d" | xargs cat; } |
        cksum >"$argument.sum" ;;
  esac
  previous=$argument
done
