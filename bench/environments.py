#!/usr/bin/env python3
"""Time of a direction on maps of growing size: by the blocks of the kd-tree, by alias tables, by inversion of the cumulative distribution.

The maps are one sky, made here at each size: a bright sun, a gradient, and clouds of noise at every scale. The number of blocks is the same for all.

    python3 -m venv venv && venv/bin/pip install numpy
    venv/bin/python bench/environments.py --kajo target/release/kajo
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

WIDTHS = (128, 256, 512, 1024, 2048, 4096)


def sky(width):
    """Radiance of a latitude-longitude map, `width / 2 x width x 3`."""
    height, rng = width // 2, np.random.default_rng(1)
    clouds = np.zeros((height, width))
    for cells in (8 << k for k in range(12) if 8 << k <= height):
        noise = rng.normal(size=(cells, 2 * cells))
        clouds += noise.repeat(height // cells, 0).repeat(height // cells, 1) * (8 / cells) ** 0.5
    theta = (np.arange(height)[:, None] + 0.5) / height * np.pi
    phi = (np.arange(width)[None, :] + 0.5) / width * 2 * np.pi
    to_sun = np.sin(theta) * np.cos(phi - 2) * np.sin(0.9) + np.cos(theta) * np.cos(0.9)
    light = (0.2 + 0.8 * (1 + np.cos(theta)) / 2) * np.exp(0.5 * clouds) + 2e4 * np.exp((to_sun - 1) / 2e-4)
    return light[..., None] * np.array([0.8, 0.9, 1.0])


def write_hdr(path, pixels):
    """A Radiance file, without compression."""
    exponent = np.floor(np.log2(pixels.max(-1))) + 1
    mantissas = pixels * (256 / 2.0**exponent)[..., None]
    data = np.dstack([mantissas, exponent + 128]).astype(np.uint8)
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % pixels.shape[:2] + data.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", default="target/release/kajo", help="the program to test")
    parser.add_argument("--blocks", type=int, default=1024, help="blocks of the kd-tree")
    parser.add_argument("--turns", type=int, default=3, help="measurements of each map; the least counts")
    arguments = parser.parse_args()
    print("| map | kd, ns | alias, ns | inversion, ns | reads of an inversion |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for width in WIDTHS:
            path = pathlib.Path(folder, f"{width}.hdr")
            write_hdr(path, sky(width))
            command = [arguments.kajo, "bench", "environment", "--env", path, "--blocks", str(arguments.blocks), "--json"]
            reports = [json.loads(subprocess.run(command, check=True, capture_output=True).stdout) for _ in range(arguments.turns)]
            least = [min(report["sample_ns"][name] for report in reports) for name in ("kd", "alias", "cdf")]
            times = " | ".join(f"{ns:.1f}" for ns in least)
            print(f"| {width} × {width // 2} | {times} | {reports[0]['sample_reads']['cdf']:.0f} |", flush=True)


if __name__ == "__main__":
    main()
