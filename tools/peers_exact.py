"""Sums of the Lucy kernel in double precision, point by point, with nothing but NumPy: what the programs are held against."""
import numpy as np

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def lucy(distance, cutoff):
    q = np.minimum(distance / cutoff, 1)
    return 105 / (16 * np.pi * cutoff**3) * (1 - q) ** 3 * (1 + 3 * q)


def mean_along(start, branch, points, cutoff):
    """The mean of W along a line from start to start + branch, at every point: Gauss-Legendre on either side of the foot of the
    perpendicular, within the support, where W is smooth."""
    away = points - start
    square = branch @ branch
    foot = away @ branch / square
    chord = np.sqrt(np.maximum(cutoff**2 - np.maximum((away**2).sum(axis=1) - foot**2 * square, 0), 0) / square)
    low, middle, high = (np.clip(end, 0, 1) for end in (foot - chord, foot, foot + chord))
    total = np.zeros(len(points))
    for begin, end in ((low, middle), (middle, high)):
        half = (end - begin) / 2
        along = (begin + half)[:, None] + half[:, None] * NODES
        distance = np.linalg.norm(away[:, None, :] - along[:, :, None] * branch, axis=2)
        total += half * (lucy(distance, cutoff) @ WEIGHTS)
    return total


class Lattice:
    def __init__(self, scene, voxel):
        low, _ = scene.corners
        self.axes = [start + (np.arange(count) + 0.5) * voxel for start, count in zip(low, scene.points(voxel))]
        self.shape = tuple(len(axis) for axis in self.axes)

    def near(self, low, high):
        """The part of the lattice within a box, and its points."""
        part = tuple(slice(*np.searchsorted(axis, limits)) for axis, *limits in zip(self.axes, low, high))
        grid = np.meshgrid(*(axis[cut] for axis, cut in zip(self.axes, part)), indexing="ij")
        return part, np.stack(grid, axis=-1)


def exact_fields(scene, voxel, cutoff, density):
    """Time means of the sums that MercuryCG writes, the stress positive in tension; and the kinetic stress about the mean velocity at the grains."""
    lattice = Lattice(scene, voxel)
    fields = {name: np.zeros(lattice.shape + extra) for name, extra in
              (("phi", ()), ("momentum", (3,)), ("flux", ()), ("contact_stress", (3, 3)), ("kinetic_stress", (3, 3)))}
    means = velocities_at_grains(scene, cutoff)
    for frame, mean in zip(scene.frames, means):
        for x, v, u, volume in zip(frame.position, frame.velocity, mean, frame.volume):
            part, points = lattice.near(x - cutoff, x + cutoff)
            weight = volume * lucy(np.linalg.norm(points - x, axis=-1), cutoff)
            fields["phi"][part] += weight
            fields["momentum"][part] += density * weight[..., None] * v
            fields["flux"][part] += density * weight * (v @ v)
            fields["kinetic_stress"][part] -= density * weight[..., None, None] * np.outer(v - u, v - u)
        add_contacts(fields["contact_stress"], lattice, frame, cutoff)
    return {name: values / len(scene.frames) for name, values in fields.items()}


def add_contacts(stress, lattice, frame, cutoff):
    for (first, second), force in zip(frame.pairs, frame.force):
        start, end = frame.position[first], frame.position[second]
        part, points = lattice.near(np.minimum(start, end) - cutoff, np.maximum(start, end) + cutoff)
        mean = mean_along(start, end - start, points.reshape(-1, 3), cutoff).reshape(points.shape[:3])
        stress[part] += mean[..., None, None] * np.outer(force, end - start)  # force on the first, branch to the second


def velocities_at_grains(scene, cutoff):
    """The mean velocity of all frames where the grains of each are."""
    places = np.concatenate([frame.position for frame in scene.frames])
    volumes = np.concatenate([frame.volume for frame in scene.frames])
    velocities = np.concatenate([frame.velocity for frame in scene.frames])
    for frame in scene.frames:
        weight = volumes * lucy(np.linalg.norm(frame.position[:, None] - places, axis=2), cutoff)
        yield weight @ velocities / weight.sum(axis=1, keepdims=True)
