"""Draws the README's plots from plot_data's numbers: draw.py numbers.json FOLDER."""

import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def slope(samples, rms):
    """Of the log-log line through the ends."""
    from math import log
    return log(rms[-1] / rms[0]) / log(samples[-1] / samples[0])


numbers = json.loads(pathlib.Path(sys.argv[1]).read_text())
folder = pathlib.Path(sys.argv[2])

figure, axes = plt.subplots(figsize=(8, 4.5), dpi=110)
for line in numbers["albedo"]:
    style = "--" if "multiscatter" in line["name"] else "-"
    axes.plot(line["cos"], line["albedo"], style, label=line["name"])
axes.axhline(1, color="grey", linewidth=0.7)
axes.set(xlabel="cosine of the view", ylabel="directional albedo in a white furnace", ylim=(0.25, 1.45),
         title="Energy: what each model gives back of light from everywhere")
axes.legend(fontsize=7, ncol=2)
figure.tight_layout()
figure.savefig(folder / "furnace.png")

figure, axes = plt.subplots(figsize=(8, 4.5), dpi=110)
for line in numbers["fall"]:
    ours = "ours" in line["name"]
    axes.loglog(line["samples"], line["rms"], "o-" if ours else "s--",
                label=f"{line['name']}: N^{slope(line['samples'], line['rms']):.2f}")
axes.set(xlabel="samples", ylabel="rms relative error of E, 200 seeds",
         title="How errors fall")
axes.grid(True, which="both", linewidth=0.3)
axes.legend(fontsize=8)
figure.tight_layout()
figure.savefig(folder / "convergence.png")
