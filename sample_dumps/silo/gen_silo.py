#!/usr/bin/python3
"""Dilute, overlap-free start of the silo as a LAMMPS data file; lengths in grain diameters, density 1.
usage: gen_silo.py out.data seed grains packing_fraction
Needs numpy and scipy."""
import sys

import numpy as np
from scipy.spatial import cKDTree

out, seed, n, phi0 = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
W, D, ORIFICE = 20.0, 8.0, 6.0  # inner width, periodic depth, width of the opening
rng = np.random.default_rng(seed)
H = n * np.pi / 6 / (phi0 * W * D)
lo = np.array([-W / 2 + 0.5, 0, 0.5])
hi = np.array([W / 2 - 0.5, D, H + 0.5])
X = lo + rng.random((n, 3)) * (hi - lo)

# Push overlapping grains apart until none overlap.
for _ in range(3000):
    X[:, 1] %= D
    pairs = cKDTree(X + [100, 0, 100], boxsize=[1e4, D, 1e4]).query_pairs(1.0, output_type="ndarray")
    if len(pairs) == 0:
        break
    dx = X[pairs[:, 1]] - X[pairs[:, 0]]
    dx[:, 1] -= D * np.round(dx[:, 1] / D)
    r = np.sqrt((dx**2).sum(1))
    overlap = 1 - r
    if overlap.max() < 1e-4:
        break
    s = 0.45 * (overlap + 1e-5)[:, None] * dx / r[:, None]
    for k in range(3):
        X[:, k] += np.bincount(pairs[:, 1], s[:, k], n) - np.bincount(pairs[:, 0], s[:, k], n)
    X[:, 0] = np.clip(X[:, 0], lo[0], hi[0])
    X[:, 2] = np.clip(X[:, 2], lo[2], hi[2])
X[:, 1] %= D

# Rough floor of fixed grains with their tops at z = 0: type 2, and type 3 where the orifice will open.
gx, gy = np.meshgrid(np.arange(-W / 2 + 0.5, W / 2), np.arange(D) + 0.5, indexing="ij")
gx, gy = gx.ravel(), gy.ravel()
types = np.r_[np.ones(n, int), np.where(abs(gx) < ORIFICE / 2, 3, 2)]
X = np.r_[X, np.c_[gx, gy, np.full(len(gx), -0.5)]]

with open(out, "w") as f:
    f.write(f"silo, gen_silo.py seed {seed}\n\n{len(X)} atoms\n3 atom types\n\n")
    f.write(f"{-W / 2 - 1:g} {W / 2 + 1:g} xlo xhi\n0 {D:g} ylo yhi\n-10 60 zlo zhi\n\nAtoms # sphere\n\n")
    for i, (t, x) in enumerate(zip(types, X)):
        f.write("%d %d 1 1 %.9g %.9g %.9g\n" % (i + 1, t, *x))
