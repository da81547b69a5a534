#!/usr/bin/env python3
"""Compares `builtin:cornell` with Mitsuba 3's own `cornell_box()`: is the mean radiance the same, and is every pixel's difference noise?

Both render the same box, camera, box filter and path lengths (Mitsuba's max_depth counts segments of a path, Kajo's --max-depth its
surface bounces: Mitsuba = Kajo + 1) with several seeds. The scatter between seeds gives each pixel's standard error, and

    z = (mean of Kajo - mean of Mitsuba) / sqrt(Var Kajo + Var Mitsuba)

follows Student's t with 2 (seeds - 1) degrees of freedom if and only if the two agree up to noise.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy
    venv/bin/python bench/peers/mitsuba_cornell.py --kajo target/release/kajo

Exit code 0 when the means agree within 0.5 % and z looks like noise, else 1.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

SIZE = 256
MAX_BOUNCES = 7


def mitsuba(seeds, spp):
    """Renderings `seeds x SIZE x SIZE x 3` and the seconds they took."""
    scene = mi.cornell_box()
    scene["integrator"] = {"type": "path", "max_depth": MAX_BOUNCES + 1, "rr_depth": 1000}
    scene["sensor"]["film"].update(width=SIZE, height=SIZE, rfilter={"type": "box"}, pixel_format="rgb")
    scene = mi.load_dict(scene)
    mi.render(scene, spp=1, seed=0).numpy()  # compile
    start = time.perf_counter()
    images = [mi.render(scene, spp=spp, seed=seed + 1).numpy() for seed in range(seeds)]
    return np.stack(images).astype(np.float64), time.perf_counter() - start


def kajo(command, seeds, spp):
    """The same from `kajo render`."""
    images, seconds = [], 0.0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(seeds):
            out, stats = pathlib.Path(folder, f"{seed}.exr"), pathlib.Path(folder, f"{seed}.json")
            arguments = ["--size", f"{SIZE}x{SIZE}", "--spp", str(spp), "--seed", str(seed + 1), "--filter", "box", "--no-rr"]
            depth = ["--max-depth", str(MAX_BOUNCES), "--stats", str(stats), "--quiet"]
            subprocess.run([command, "render", "builtin:cornell", "-o", str(out), *arguments, *depth], check=True)
            bitmap = mi.Bitmap(str(out))
            names = [field.name for field in bitmap.struct_()]
            pixels = np.array(bitmap, dtype=np.float64)
            images.append(np.stack([pixels[..., names.index(channel)] for channel in "RGB"], axis=-1))
            seconds += json.loads(stats.read_text())["render_seconds"]
    return np.stack(images), seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", default="target/release/kajo", help="the program to test")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel and seed")
    parser.add_argument("--seeds", type=int, default=16, help="renderings of each")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="Mitsuba variant")
    args = parser.parse_args()
    mi.set_variant(args.variant)

    theirs, their_seconds = mitsuba(args.seeds, args.spp)
    ours, our_seconds = kajo(args.kajo, args.seeds, args.spp)

    ratio = ours.mean() / theirs.mean()
    per_channel = ours.mean(axis=(0, 1, 2)) / theirs.mean(axis=(0, 1, 2))
    of_image = [x.mean(axis=(1, 2, 3)).std(ddof=1) / np.sqrt(args.seeds) / x.mean() for x in (ours, theirs)]
    variance = lambda x: x.var(axis=0, ddof=1) / args.seeds
    ours_variance, theirs_variance = variance(ours), variance(theirs)
    total = ours_variance + theirs_variance
    seen = total > 0
    z = ((ours.mean(axis=0) - theirs.mean(axis=0))[seen] / np.sqrt(total[seen])).ravel()
    freedom = 2 * (args.seeds - 1)
    expected = np.sqrt(freedom / (freedom - 2))

    print(f"Mitsuba {mi.__version__} ({args.variant}), {args.seeds} seeds x {args.spp} spp, {SIZE} x {SIZE}, {MAX_BOUNCES} bounces")
    print(f"mean radiance   Kajo {ours.mean():.6f}  Mitsuba {theirs.mean():.6f}  ratio {ratio:.5f} +- {np.hypot(*of_image):.5f}")
    print(f"ratio by channel {per_channel.round(5)}")
    print(f"z: mean {z.mean():+.4f}  standard deviation {z.std():.4f} (noise alone: {expected:.4f})  largest {np.abs(z).max():.2f}")
    print(f"pixels with |z| > 4: {np.mean(np.abs(z) > 4):.2e}")
    print(f"time            Kajo {our_seconds:.2f} s  Mitsuba {their_seconds:.2f} s")
    print(f"mean variance   Kajo {ours_variance.mean() * args.seeds:.3e}  Mitsuba {theirs_variance.mean() * args.seeds:.3e}")
    efficiency = (their_seconds * theirs_variance.mean()) / (our_seconds * ours_variance.mean())
    print(f"efficiency 1 / (time x variance), Kajo over Mitsuba: {efficiency:.2f}")

    agree = abs(ratio - 1) < 0.005 and abs(z.mean()) < 0.05 and abs(z.std() / expected - 1) < 0.05
    print("agree" if agree else "DIFFER")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
