#!/usr/bin/env python3
"""Draws the tables that apeiron_convergence writes as one picture: PSNR over seconds of rendering, a panel for each size of picture.

    bench/plot_convergence.py [--linear] FILE.csv... FILE.svg

PSNR is that of display values, or of linear radiance.
"""

import csv
import math
import pathlib
import sys

PANEL, HEIGHT, LEFT, TOP, GAP, RIGHT, BOTTOM = 270, 380, 50, 36, 16, 130, 50
COLOURS = ["#4c9f70", "#c8702a", "#5b6ee1", "#a04a9c"]


def main():
    arguments = [a for a in sys.argv[1:] if a != "--linear"]
    column = "psnr_linear" if "--linear" in sys.argv else "psnr_display"
    lines = {}
    for source in map(pathlib.Path, arguments[:-1]):
        for row in csv.DictReader(source.open(encoding="utf-8")):
            key = (int(row["size"]), int(row["grid"]), row["renderer"])
            lines.setdefault(key, []).append((float(row["seconds"]), float(row[column])))
    if not lines:
        sys.exit("there are no looks to draw")
    points = [p for line in lines.values() for p in line]
    first = math.floor(3 * math.log10(min(p[0] for p in points))) / 3
    last = math.ceil(3 * math.log10(max(p[0] for p in points))) / 3
    low = 5 * math.floor(min(p[1] for p in points) / 5)
    high = 5 * math.ceil(max(p[1] for p in points) / 5)
    sizes = sorted({key[0] for key in lines})
    colours = dict(zip(sorted({key[1] for key in lines}), COLOURS))
    width = LEFT + len(sizes) * (PANEL + GAP) + RIGHT
    bottom = HEIGHT - BOTTOM

    def y(psnr):
        return TOP + (high - psnr) / (high - low) * (bottom - TOP)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" font-family="sans-serif" font-size="13">',
           f'<rect width="{width}" height="{HEIGHT}" fill="#fff"/>']
    for psnr in range(low, high + 1, 5):
        out.append(f'<text x="{LEFT - 8}" y="{y(psnr) + 4:.1f}" text-anchor="end">{psnr}</text>')
    for i, size in enumerate(sizes):
        left = LEFT + i * (PANEL + GAP)

        def x(seconds):
            return left + (math.log10(seconds) - first) / (last - first) * PANEL

        out.append(f'<text x="{left + PANEL / 2}" y="{TOP - 12}" text-anchor="middle">{size} × {size} pixels</text>')
        for psnr in range(low, high + 1, 5):
            out.append(f'<path d="M{left} {y(psnr):.1f}h{PANEL}" stroke="#ddd"/>')
        for power in range(math.ceil(first), math.floor(last) + 1):
            at = x(10.0 ** power)
            out.append(f'<path d="M{at:.1f} {TOP}V{bottom}" stroke="#ddd"/>'
                       f'<text x="{at:.1f}" y="{bottom + 18}" text-anchor="middle">{10.0 ** power:g}</text>')
        out.append(f'<text x="{left + PANEL / 2}" y="{HEIGHT - 12}" text-anchor="middle">rendering [s]</text>')
        for (_, grid, renderer), line in sorted(item for item in lines.items() if item[0][0] == size):
            dash = ' stroke-dasharray="5 4"' if renderer == "mcs" else ""
            path = "L".join(f"{x(seconds):.1f} {y(psnr):.1f}" for seconds, psnr in line)
            out.append(f'<path d="M{path}" stroke="{colours[grid]}" stroke-width="2" fill="none"{dash}/>')
            # Where the reference allows one look only, there is no line.
            out += [f'<circle cx="{x(seconds):.1f}" cy="{y(psnr):.1f}" r="3" fill="{colours[grid] if renderer == "mcm" else "#fff"}" '
                    f'stroke="{colours[grid]}" stroke-width="1.5"/>' for seconds, psnr in line]
    out.append(f'<text transform="translate(14 {(TOP + bottom) / 2}) rotate(-90)" text-anchor="middle">PSNR [dB]</text>')
    for i, (grid, renderer) in enumerate(sorted({key[1:] for key in lines})):
        at = TOP + 8 + 20 * i
        dash = ' stroke-dasharray="5 4"' if renderer == "mcs" else ""
        left = width - RIGHT + 8
        out.append(f'<path d="M{left} {at}h28" stroke="{colours[grid]}" stroke-width="2"{dash}/>'
                   f'<text x="{left + 35}" y="{at + 4}">{renderer}, {grid}³</text>')
    out.append("</svg>\n")
    pathlib.Path(arguments[-1]).write_text("\n".join(out), encoding="utf-8")
    print(f"\nThe plot is {arguments[-1]}")


if __name__ == "__main__":
    main()
