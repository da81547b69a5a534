#!/bin/sh
# Fuzzes every importer for SECONDS each (default 20), from seeds that code makes. Exit 0: nothing found. Exit 1: a finding, whose input lies in
# fuzz/artifacts. Exit 2: fuzzing is not possible here. The sanitizer is off, since the importers are safe Rust: panics, hangs and memory are what is looked for.
set -eu
seconds=${1:-20}
cd "$(dirname "$0")/.."

if ! command -v c++ >/dev/null && ! command -v g++ >/dev/null && ! command -v clang++ >/dev/null; then
    echo "fuzz: libFuzzer is C++ and there is no C++ compiler; install g++" >&2
    exit 2
fi
command -v cargo-fuzz >/dev/null || cargo install --locked cargo-fuzz || exit 2

cargo run --release --quiet -p kajo-scene --example fuzz_seeds -- fuzz/corpus
export CARGO_TARGET_DIR="$PWD/fuzz/target"
# The coverage flags of cargo-fuzz are those of a nightly compiler.
export RUSTC_BOOTSTRAP=1
cargo fuzz build --sanitizer none

found=0
for target in gltf glb obj hdr kajo_toml; do
    echo "fuzz: $target for $seconds s"
    cargo fuzz run --sanitizer none "$target" -- -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 || found=1
done
exit $found
