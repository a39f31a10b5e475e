#!/usr/bin/env python3
"""Draws the table that apeiron_convergence writes as one picture: PSNR over seconds of rendering.

    bench/plot_convergence.py FILE.csv FILE.svg
"""

import csv
import math
import pathlib
import sys

WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 860, 480, 60, 20, 230, 50
COLOURS = {"64": "#4c9f70", "128": "#c8702a", "256": "#5b6ee1"}


def main():
    source, target = map(pathlib.Path, sys.argv[1:3])
    lines = {}
    for row in csv.DictReader(source.open(encoding="utf-8")):
        lines.setdefault((row["renderer"], row["size"], row["grid"]), []).append((float(row["seconds"]), float(row["psnr"])))
    if not lines:
        sys.exit(f"{source}: there are no looks in it")
    points = [p for line in lines.values() for p in line]
    first = math.floor(math.log10(min(p[0] for p in points)))
    last = math.ceil(math.log10(max(p[0] for p in points)))
    low = 5 * math.floor(min(p[1] for p in points) / 5)
    high = 5 * math.ceil(max(p[1] for p in points) / 5)

    def x(seconds):
        return LEFT + (math.log10(seconds) - first) / (last - first) * (WIDTH - LEFT - RIGHT)

    def y(psnr):
        return TOP + (high - psnr) / (high - low) * (HEIGHT - TOP - BOTTOM)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>']
    for power in range(first, last + 1):
        at = x(10.0 ** power)
        out.append(f'<path d="M{at:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{10.0 ** power:g}</text>')
    for psnr in range(low, high + 1, 5):
        out.append(f'<path d="M{LEFT} {y(psnr):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 8}" y="{y(psnr) + 4:.1f}" text-anchor="end">{psnr}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 12}" text-anchor="middle">rendering [s]</text>')
    out.append(f'<text transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">PSNR [dB]</text>')
    widths = {size: 1 + 0.8 * i for i, size in enumerate(sorted({key[1] for key in lines}, key=int))}
    for i, ((renderer, size, grid), line) in enumerate(lines.items()):
        style = (f'stroke="{COLOURS.get(grid, "#555")}" stroke-width="{widths[size]}" fill="none"'
                 + (' stroke-dasharray="5 4"' if renderer == "mcs" else ""))
        path = "L".join(f"{x(seconds):.1f} {y(psnr):.1f}" for seconds, psnr in line)
        at = TOP + 8 + 18 * i
        out.append(f'<path d="M{path}" {style}/><path d="M{WIDTH - RIGHT + 15} {at}h30" {style}/>'
                   f'<text x="{WIDTH - RIGHT + 52}" y="{at + 4}">{renderer}, {size}², {grid}³</text>')
    out.append("</svg>\n")
    target.write_text("\n".join(out), encoding="utf-8")
    print(f"\nThe plot is {target}")


if __name__ == "__main__":
    main()
