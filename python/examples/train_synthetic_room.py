#!/usr/bin/env python3
"""Trains a synthetic room with simulated priors, and draws its course. Each part between the lines is a cell of a notebook.

    python3 examples/train_synthetic_room.py [FOLDER]      needs the program aligngs; draws plots where matplotlib is installed
"""
import sys

import numpy as np

import aligngs

# ---- Train. The events arrive while the program works.
folder = sys.argv[1] if len(sys.argv) > 1 else "example_run"
course = []


def note(event):
    if "psnr" in event:
        course.append((event["step"], event["psnr"], event["gaussians"]))
        print(f"step {event['step']}: PSNR {event['psnr']:.2f} dB, {event['gaussians']} Gaussians", flush=True)


run = aligngs.demo(folder, "--room", "bedroom", "--views", "12", "--size", "160x120", "-n", "150", overwrite=True, on_event=note)

# ---- Figures of the test views.
print(f"PSNR {run.metrics['nvs']['psnr']:.2f} dB on the test views, with simulated priors")

# ---- Labels: the largest classes by number of splats.
labels = run.labels
for entry in sorted(labels.classes, key=lambda c: -c.gaussians)[:5]:
    print(f"{entry.name:12} {entry.gaussians} splats, confidence {labels.confidence[labels.label == entry.id].mean():.2f}")

# ---- Geometry: the area of the mesh by class.
mesh = run.mesh
corners = mesh.vertices[mesh.triangles]
areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
print(f"mesh: {len(mesh.triangles)} triangles, {areas.sum():.1f} square units")

# ---- Plots.
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
except ImportError:
    print("no plots: matplotlib is not installed (apt-get install python3-matplotlib)")
    sys.exit(0)
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4))
steps, psnr, _ = np.array(course).T
left.plot(steps, psnr)
left.set(xlabel="step", ylabel="PSNR of the training view (dB)")
g = run.gaussians
chosen = g.opacities > 0.3
right.scatter(g.positions[chosen, 0], g.positions[chosen, 1], s=1, c=np.clip(0.5 + 0.282 * g.sh[chosen, 0], 0, 1))
right.set(xlabel="x", ylabel="y", aspect="equal", title="splats")
figure.tight_layout()
figure.savefig(f"{folder}/course.png", dpi=120)
print(f"plots: {folder}/course.png")
