#!/usr/bin/env python3
"""How fast mcs and mcm converge: PSNR against a reference of many samples with another seed, and iterations a second.

The method of figure 7 and table 1 of Lesar, Bohak & Marolt (2018), for volumes that the program generates. Both pictures are display
values of the linear tone mapper, 16 bits; rendering times are without start and compilation.

    bench/volume/convergence.py build/release/apps/cli/apeiron                     # everything: hours on a CPU
    bench/volume/convergence.py APEIRON --sizes 256 --grids 64 --reference 400     # a look
    bench/volume/convergence.py APEIRON --volume bonsai128.raw --raw 128x128x128:uint8
"""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

SCENE = {
    "apeiron": 1,
    "subject": {"type": "volume", "density": 100},
    "renderer": {"type": "mcm", "bounces": 8},
    "lights": [],
    "environment": {"type": "constant"},
    "post": {"tonemapper": "linear"},
}
LAMP = [{"type": "sun", "elevation": 50, "azimuth": 240, "intensity": 3, "size": 2}]


def render(apeiron, folder, scene, name, settings):
    stats = folder / f"{name}.json"
    command = [apeiron, "render", scene, "-o", folder / f"{name}.png", "--bits", "16", "-q", "--stats", stats]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    subprocess.run([str(part) for part in command], check=True)
    return json.loads(stats.read_text())


def psnr(folder, a, b):
    command = ["oiiotool", "--diff", folder / f"{a}.png", folder / f"{b}.png"]
    text = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False).stdout
    return float(re.search(r"Peak SNR = ([\d.einf+]+)", text).group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("apeiron")
    parser.add_argument("--sizes", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--grids", type=int, nargs="+", default=[64, 128, 256])
    parser.add_argument("--renderers", nargs="+", default=["mcs", "mcm"])
    parser.add_argument("--samples", type=int, nargs="+", default=[1, 4, 16, 64])
    parser.add_argument("--reference", type=int, default=4000)
    parser.add_argument("--lamp", action="store_true", help="a small bright lamp in the dark instead of a white sky")
    parser.add_argument("--volume", default="cloud")
    parser.add_argument("--raw", default="")
    parser.add_argument("--transfer", default="")
    options = parser.parse_args()

    scene = json.loads(json.dumps(SCENE))
    scene["subject"].update(source=options.volume, raw=options.raw)
    if options.transfer:
        scene["subject"]["transfer"] = json.loads(options.transfer)
    if options.lamp:
        scene["lights"] = LAMP
        scene["environment"]["color"] = [0, 0, 0]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        file = folder / "scene.json"
        file.write_text(json.dumps(scene))
        print("| renderer | picture | volume | samples | seconds | iterations/s | PSNR [dB] |")
        print("|---|---|---|---|---|---|---|")
        for renderer in options.renderers:
            for grid in options.grids:
                for size in options.sizes:
                    settings = {
                        "renderer.type": renderer,
                        "subject.resolution": grid,
                        "output.width": size,
                        "output.height": size,
                    }
                    render(options.apeiron, folder, file, "reference",
                           {**settings, "output.samples": options.reference, "output.seed": 1})
                    for samples in options.samples:
                        stats = render(options.apeiron, folder, file, "picture", {**settings, "output.samples": samples})
                        seconds = 1e-3 * stats["phases"]["render"]["wall_ms"]
                        print(f"| {renderer} | {size}² | {grid}³ | {samples} | {seconds:.2f} | {samples / seconds:.1f} | "
                              f"{psnr(folder, 'picture', 'reference'):.1f} |", flush=True)


if __name__ == "__main__":
    main()
