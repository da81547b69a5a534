#!/usr/bin/env python3
"""Passes of the real-time renderer beside Bevy's: the same glTF, camera, directional light, resolution, shadow-map size and filter, on the same adapter.

    python3 bench/peers/passes.py --kajo target/release/kajo --gltf FlightHelmet.gltf

Bevy (the crate `bench/peers/bevy`, built here) times SSAO and TAA on the device itself; what shadows cost it is the median frame with them less the median
frame without. Kajo's numbers are the device times of a technique's passes, as `kajo compare` reports them. Both programs run in turns; each number is the
median over the rounds.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

CONTACT = "length=0.3,steps=16,thickness=0.1"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kajo", type=pathlib.Path, required=True)
    parser.add_argument("--gltf", type=pathlib.Path, required=True)
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--map", type=int, default=2048, help="side of each shadow map, px")
    parser.add_argument("--frames", type=int, default=20, help="timed frames of a round")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--eye", default="0.35,0.45,0.95")
    parser.add_argument("--target", default="0,0.36,0")
    parser.add_argument("--light", default="-1,-2,-1", help="the way light travels")
    parser.add_argument("--fov", type=float, default=38.0)
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for Bevy's pictures, to be looked at")
    return parser.parse_args()


def build_bevy():
    manifest = pathlib.Path(__file__).parent / "bevy" / "Cargo.toml"
    subprocess.run(["cargo", "build", "--release", "--manifest-path", manifest], check=True)
    return manifest.parent / "target" / "release" / "bevy-passes"


def bevy(program, args, mode):
    width, height = args.size.split("x")
    words = [program, args.gltf, mode, width, height, str(args.map), str(args.frames), str(args.fov), args.eye, args.target, args.light]
    if args.pictures:
        words.append(args.pictures / f"bevy-{mode}.png")
    out = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    return json.loads(out.splitlines()[-1])


def scene(args, folder):
    numbers = lambda text: [float(n) for n in text.split(",")]
    file = folder / "scene.kajo.toml"
    file.write_text(
        f'[[asset]]\nfile = "{args.gltf.resolve()}"\n'
        f'[[light]]\ntype = "directional"\ndirection = {numbers(args.light)}\nlux = 3.0\n'
        f'[[camera]]\nposition = {numbers(args.eye)}\ntarget = {numbers(args.target)}\nyfov_deg = {args.fov}\n'
    )
    return file


TECHNIQUES = {
    "cascades": "shadow/cascades:resolution={map},cascades=4,kernel=2",
    "map": "shadow/map:resolution={map},kernel=2",
    "contact": "shadow/contact:resolution={map},kernel=2," + CONTACT,
    "ssao": "ao/gtao:slices=3,steps=3,denoise=1",
    "taa": "aa/taa",
}


def kajo(args, file, folder):
    names = ",".join(text.format(map=args.map) for text in TECHNIQUES.values())
    command = [args.kajo, "compare", file, "-o", folder / "report", "--technique", names, "--size", args.size]
    command += ["--reference-spp", "1", "--frames", str(args.frames), "--repeat", "1", "--quiet"]
    subprocess.run(command, check=True)
    runs = json.loads((folder / "report" / "report.json").read_text())["runs"]
    for run in runs:
        if run["cost"] is None:
            raise SystemExit(f"{run['technique']}: {run['status']}")
    by_id = {run["technique"]: run["cost"]["gpu_ms"] for run in runs}
    return {name: by_id[text.split(":")[0]] for name, text in TECHNIQUES.items()}


def main():
    args = arguments()
    program = build_bevy()
    if args.pictures:
        args.pictures.mkdir(parents=True, exist_ok=True)
    theirs, ours = [], []
    for number in range(args.rounds):
        modes = {mode: bevy(program, args, mode) for mode in ["plain", "cascades", "contact", "ssao", "taa", "taa-8-bit"]}
        frame = {mode: out["frame_ms"] for mode, out in modes.items()}
        span = lambda mode, name: next(ms for path, ms in modes[mode]["spans_ms"].items() if f"/{name}/" in path)
        theirs.append({
            "cascades, 5x5 filter": frame["cascades"] - frame["plain"],
            "contact shadows": frame["contact"] - frame["cascades"],
            "ambient occlusion": span("ssao", "ssao"),
            "TAA": span("taa", "taa"),
            "TAA, Bevy's in 8 bits": span("taa-8-bit", "taa"),
        })
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            ms = kajo(args, scene(args, folder), folder)
        ours.append({
            "cascades, 5x5 filter": ms["cascades"],
            "contact shadows": ms["contact"] - ms["map"],
            "ambient occlusion": ms["ssao"],
            "TAA": ms["taa"],
            "TAA, Bevy's in 8 bits": ms["taa"],
        })
        print(f"round {number + 1}: Bevy {theirs[-1]}, Kajo {ours[-1]}; Bevy's frames {frame}", flush=True)
    print("\n| pass | Bevy 0.19.1, ms | Kajo, ms | Kajo / Bevy |\n| --- | --- | --- | --- |")
    for name in theirs[0]:
        a, b = (statistics.median(rounds[name] for rounds in side) for side in (theirs, ours))
        print(f"| {name} | {a:.2f} | {b:.2f} | {b / a:.2f} |")


if __name__ == "__main__":
    main()
