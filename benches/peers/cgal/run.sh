#!/usr/bin/env bash
# Builds and runs lindstrom_turk.cpp against CGAL's headers (Debian: libcgal-dev).
#
#   benches/peers/cgal/run.sh [--runs N] OUT_DIR MESH.ply...
#
# Compare with multires-peers run on the same machine, one right after the other.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
runs=3
if [ "${1:-}" = --runs ]; then
    runs=${2:?"--runs needs a number"}
    shift 2
fi
if [ $# -lt 2 ]; then
    echo "usage: run.sh [--runs N] OUT_DIR MESH.ply..." >&2
    exit 2
fi

target=${CARGO_TARGET_DIR:-$here/../../../target}
binary=$target/cgal/lindstrom_turk
if [ ! "$binary" -nt "$here/lindstrom_turk.cpp" ]; then
    mkdir -p "$target/cgal"
    "${CXX:-g++}" -std=c++17 -O2 -DNDEBUG "$here/lindstrom_turk.cpp" -o "$binary" -lgmp -lmpfr
fi
mkdir -p "$1"
exec "$binary" "$runs" "$@"
