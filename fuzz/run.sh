#!/bin/sh
# Fuzzes every importer, from seeds that code makes, and the building and tracing of any triangles, from none. `fuzz/run.sh SECONDS` searches with new random numbers for that long each; `fuzz/run.sh` is the
# check that can be repeated: a fixed number of runs with fixed random numbers. Exit 0: nothing found. Exit 1: a finding, whose input lies in fuzz/artifacts.
# Exit 2: fuzzing is not possible here. The sanitizer is off, since the importers are safe Rust (the hierarchy has
# some that is not, which only its answers judge here): panics, hangs and memory are what is looked for.
set -eu
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
    limit="-max_total_time=$1" corpus=fuzz/corpus
else
    limit="-runs=200000 -seed=1" corpus=fuzz/target/corpus
    rm -rf "$corpus"
fi

if ! command -v c++ >/dev/null && ! command -v g++ >/dev/null && ! command -v clang++ >/dev/null; then
    echo "fuzz: libFuzzer is C++ and there is no C++ compiler; install g++" >&2
    exit 2
fi
command -v cargo-fuzz >/dev/null || cargo install --locked cargo-fuzz || exit 2

cargo run --release --quiet -p kajo-scene --example fuzz_seeds -- "$corpus"
export CARGO_TARGET_DIR="$PWD/fuzz/target"
# The coverage flags of cargo-fuzz are those of a nightly compiler.
export RUSTC_BOOTSTRAP=1
cargo fuzz build --sanitizer none

found=0
for target in gltf glb obj hdr texture kajo_toml rgl bvh; do
    echo "fuzz: $target, $limit"
    mkdir -p "$corpus/$target"
    length=65536
    # The judge of the hierarchy takes all triangles for each ray.
    [ "$target" != bvh ] || length=2048
    # shellcheck disable=SC2086 # the words of $limit are arguments
    cargo fuzz run --sanitizer none "$target" "$corpus/$target" -- $limit -timeout=10 -rss_limit_mb=4096 -max_len=$length -verbosity=0 || found=1
done
exit $found
