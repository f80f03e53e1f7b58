#!/bin/sh
# The cases of the multibody manual in Fallwerk, MuJoCo, Exudyn and Rapier: one table. See README.md in this folder.
# usage: benches/peers/run.sh [OUTPUT] [options of peers.py]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
output=${1:-$root/out/peers}
[ $# -gt 0 ] && shift
build=${PEERS_BUILD:-${TMPDIR:-/tmp}/fallwerk-peers}
mkdir -p "$build"

[ -x "$root/target/release/fallwerk" ] || (cd "$root" && cargo build --release)
[ -x "$build/venv/bin/python" ] || python3 -m venv "$build/venv"
"$build/venv/bin/python" -c 'import mujoco, exudyn' 2>/dev/null ||
    "$build/venv/bin/pip" install --quiet 'mujoco==4.0.0' 'exudyn==1.13.6' numpy
(cd "$here/rapier" && CARGO_TARGET_DIR="$build/target" cargo build --release --quiet)

fallwerk=$root/target/release/fallwerk
nice -n 10 "$fallwerk" verify mbs --models "$build/models"
# one thread for every linear algebra that might take more
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
nice -n 10 "$build/venv/bin/python" "$here/check_mjcf.py" "$fallwerk" "$build/models"
nice -n 10 "$build/venv/bin/python" "$here/peers.py" "$fallwerk" "$build/models" "$build" "$output" "$@"
echo "$output/peers.md"
