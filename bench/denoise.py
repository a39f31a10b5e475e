#!/usr/bin/env python3
"""What the denoiser brings: PSNR against the converged picture, with it and without, as a table for docs/performance.md.

    bench/denoise.py [--program build/release/apps/cli/apeiron] [--size 256x256] [--samples 1 4 16 64] [--reference 512] [--scenes ...]

The converged picture has another seed. PSNR is of 16-bit display values, by OpenImageIO's idiff.
"""

import argparse
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# A gallery scene, what is changed in it, and the denoiser's own settings there.
SCENES = {
    "mandelbulb, pathtrace": ("mandelbulb", ["renderer.type=pathtrace"], '{"type": "denoise"}'),
    "cloud, mcm": ("volume_cloud", ["subject.resolution=96"], '{"type": "denoise", "textures": false, "depths": 20}'),
    "smoke, mcs": ("volume_smoke", [], '{"type": "denoise", "textures": false, "depths": 20}'),
}


def render(program, scene, edits, samples, seed, size, effect, target):
    edits = [*edits, f"post.effects=[{effect}]", f"output.seed={seed}"]
    subprocess.run([program, "render", scene, "-o", target, "--bits", "16", "--size", size, "--samples", str(samples), "--quiet",
                    *(word for edit in edits for word in ("--set", edit))], check=True)


def psnr(a, b):
    """[dB]"""
    said = subprocess.run(["idiff", "-fail", "1", "-warn", "1", "-allowfailures", "1000000000", "-v", a, b], capture_output=True, text=True).stdout
    match = re.search(r"Peak SNR = (\S+)", said)
    if not match:
        raise SystemExit(f"idiff does not say how {a} and {b} differ: {said}")
    return float(match.group(1))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", default=ROOT / "build/release/apps/cli/apeiron")
    arguments.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    arguments.add_argument("--size", default="256x256")
    arguments.add_argument("--samples", type=int, nargs="+", default=[1, 4, 16, 64])
    arguments.add_argument("--reference", type=int, default=512)
    wanted = arguments.parse_args()
    print("| scene | " + " | ".join(f"{n} sample{'s' if n > 1 else ''}" for n in wanted.samples) + " |")
    print("|---|" + "---|" * len(wanted.samples))
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name in wanted.scenes:
            scene, edits, effect = SCENES[name]
            converged = folder / "converged.png"
            render(wanted.program, scene, edits, wanted.reference, 4711, wanted.size, "", converged)
            cells = []
            for samples in wanted.samples:
                pair = []
                for effects in ("", effect):
                    picture = folder / "picture.png"
                    render(wanted.program, scene, edits, samples, 1, wanted.size, effects, picture)
                    pair.append(psnr(picture, converged))
                cells.append(f"{pair[0]:.1f} → {pair[1]:.1f}")
            print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
