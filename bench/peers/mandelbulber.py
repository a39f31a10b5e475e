#!/usr/bin/env python3
"""Compares Apeiron with Debian's mandelbulber2 on the power-8 Mandelbulb: CPU seconds of the rendering phase.

Both programs render the same view with all cores and without anti-aliasing, alternately, so that both see the same weather
on the machine: bulb_SCENE.fract and bulb_SCENE.json in this folder. What is held equal: camera (1.2, -2.4, 0.8) towards the origin, z up,
53.13 degrees of vertical field of view; hit threshold one pixel (distance / picture height); at most 32 iterations; escape
radius 10; one sun, Lambertian surface of one colour.

CPU seconds are user + system time of the whole process. mandelbulber2 does not say what part of it rendering took, so its start-up is
measured by the same scene at 8x8 pixels and subtracted. Apeiron says it itself (--stats, phases.render.cpu_ms).
Prints a Markdown table for each scene and size; figures are medians, ranges in brackets. `taskset -c 0 bench/peers/mandelbulber.py` measures on one core: two
threads of mandelbulber2 disturb each other, so it needs less CPU time there.
"""

import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SCENES = ["plain", "lit", "rays"]


class Failure(Exception):
    pass


def measure(command, environment=None):
    """Runs a command; returns its (CPU seconds of the process and its children, wall seconds)."""
    with tempfile.TemporaryFile() as log:
        begin = time.monotonic()
        process = subprocess.Popen(
            [str(part) for part in command], stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            log.seek(0)
            words = log.read().decode(errors="replace").strip()
            raise Failure(f"{command[0]} failed with {process.returncode}:\n{words}")
        return usage.ru_utime + usage.ru_stime, wall


class Mandelbulber:
    name = "mandelbulber2"

    def __init__(self, scene, home):
        self.scene = HERE / f"bulb_{scene}.fract"
        # A home of its own: nobody's settings, and nothing left behind. C: a decimal point is a point.
        self.environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": str(home), "LC_ALL": "C"}

    def render(self, size, picture):
        picture.unlink(missing_ok=True)
        result = measure(["mandelbulber2", "--nogui", "--no-cli-color", "--format", "png", "--res", f"{size}x{size}",
                          "--output", picture, self.scene], self.environment)
        if not picture.exists():
            raise Failure(f"mandelbulber2 wrote no {picture}")
        return result


class Apeiron:
    name = "Apeiron"

    def __init__(self, scene, program):
        self.scene = HERE / f"bulb_{scene}.json"
        self.program = program
        self.device = "?"

    def render(self, size, picture):
        """Returns CPU seconds of the rendering phase, of the whole process, and wall seconds."""
        stats_file = picture.with_suffix(".stats.json")
        total, wall = measure([self.program, "render", self.scene, "-o", picture, "--size", f"{size}x{size}",
                               "--samples", "1", "--stats", stats_file, "--quiet"])
        stats = json.loads(stats_file.read_text())
        self.device = f"{stats['device']}, {stats['stage']}"
        return stats["phases"]["render"]["cpu_ms"] / 1000, total, wall


def figure(values):
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def compare(scene, size, options, out, home):
    """Renders one scene in one size, prints its table and returns the ratio of the medians."""
    stem = f"bulb_{scene}_{size}"
    peer = Mandelbulber(scene, home)
    ours = Apeiron(scene, options.apeiron.resolve()) if options.apeiron.exists() else None
    peer_picture = out / f"{stem}_mandelbulber.png"
    our_picture = out / f"{stem}_apeiron.png"

    startup, peer_runs, our_runs = [], [], []
    for run in range(options.runs + 1):
        results = (peer.render(8, out / "startup.png"), peer.render(size, peer_picture),
                   ours.render(size, our_picture) if ours else None)
        if run == 0:
            continue
        print(f"\r{scene} {size}: run {run} of {options.runs}", end="", file=sys.stderr, flush=True)
        startup.append(results[0][0])
        peer_runs.append(results[1])
        our_runs.append(results[2])
    print(file=sys.stderr)
    (out / "startup.png").unlink()

    begin = statistics.median(startup)
    peer_total = [cpu for cpu, _ in peer_runs]
    peer_net = [cpu - begin for cpu in peer_total]
    rows = [[peer.name, figure(peer_net), figure(startup), figure(peer_total), figure([wall for _, wall in peer_runs])]]
    cores = len(os.sched_getaffinity(0))
    result = {"scene": scene, "size": size, "cores": cores, "mandelbulber2":
              {"render_cpu_s": peer_net, "startup_cpu_s": startup, "total_cpu_s": peer_total}}
    ratio = None
    if ours:
        net, total, wall = ([run[i] for run in our_runs] for i in range(3))
        rows.append([f"{ours.name} ({ours.device})", figure(net), figure([t - n for t, n in zip(total, net)]),
                     figure(total), figure(wall)])
        ratio = statistics.median(peer_net) / statistics.median(net)
        result["apeiron"] = {"device": ours.device, "render_cpu_s": net, "total_cpu_s": total}
        least = min(peer_net) / min(net)
        result["ratio"] = {"medians": ratio, "minima": least}

    print(f"\nMandelbulb, power 8, {scene}, {size} x {size}, {cores} core{'s'[:cores > 1]}, "
          f"medians of {options.runs} (smallest to largest):\n")
    print("| program | rendering, CPU s | start-up and the rest, CPU s | whole process, CPU s | wall s |")
    print("|---|---|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    if ours:
        print(f"\nmandelbulber2 needs {ratio:.2f} times the CPU seconds that Apeiron needs "
              f"({least:.2f} times when the least of each is compared).")
        if shutil.which("oiiotool"):
            pair = out / f"{stem}.png"
            measure(["oiiotool", peer_picture, "--ch", "R,G,B", our_picture, "--ch", "R,G,B", "--mosaic", "2x1", "-o", pair])
            print(f"Side by side, mandelbulber2 on the left: {pair}")
    (out / f"{stem}.json").write_text(json.dumps(result, indent=2) + "\n")
    return ratio


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", choices=SCENES, action="append",
                        help="plain: direct light only; lit: with hard shadows and fast ambient occlusion; rays: with hard "
                             "shadows and ambient occlusion by rays (default: all)")
    parser.add_argument("--size", type=int, action="append", help="width and height [px] (default: 512 and 1024)")
    parser.add_argument("--runs", type=int, default=3, help="timed runs of each program, after one that is not timed")
    parser.add_argument("--apeiron", type=pathlib.Path, default=ROOT / "build/release/apps/cli/apeiron",
                        help="the program; when it is not there, mandelbulber2 is measured alone")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/peers", help="folder for pictures and figures")
    options = parser.parse_args()

    if not shutil.which("mandelbulber2"):
        raise Failure("mandelbulber2 is missing; run scripts/install peers")
    if not options.apeiron.exists():
        print(f"no {options.apeiron}: measuring mandelbulber2 alone", file=sys.stderr)
    options.out.mkdir(parents=True, exist_ok=True)
    ratios = []
    with tempfile.TemporaryDirectory() as home:
        for scene in options.scene or SCENES:
            for size in options.size or [512, 1024]:
                ratios.append((scene, size, compare(scene, size, options, options.out.resolve(), home)))
    if all(ratio for _, _, ratio in ratios):
        print("\n| picture | size | mandelbulber2 / Apeiron |\n|---|---|---|")
        for scene, size, ratio in ratios:
            print(f"| {scene} | {size} | **{ratio:.1f}** |")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"mandelbulber.py: {failure}")
