"""The shear cell in sample_dumps, copies of it side by side in an open box, and the same in the files that other programs read.

MercuryCG sees no periodic images in .data and .fstat files. So contacts across the edge of the box are left out for everybody, and the box is
open, unless the scene is to be periodic. All grains count, those of the walls too, and have the density 1: MercuryCG finds another one in restart files alone."""
from dataclasses import dataclass

import numpy as np

from accuracy_runs import SAMPLE, Dump

DIAMETER = 0.8e-3  # mean of the mobile grains [m]
DT = 1e-6  # of the sample [s]
LOW, HEIGHT = -0.0016, 0.0144  # of the lattice along z [m]
DENSITY = 1.0


@dataclass
class Frame:
    step: int
    position: np.ndarray  # (grains, 3)
    velocity: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    pairs: np.ndarray  # (contacts, 2) rows of grains
    force: np.ndarray  # (contacts, 3) on the first of them

    @property
    def volume(self):
        return 4 / 3 * np.pi * self.radius**3


@dataclass
class Scene:
    frames: list
    edge: float  # of the box along x and y
    name: str
    periodic: bool = False  # along x and y

    def points(self, voxel):
        """Of the lattice along each axis."""
        return [round(length / voxel) for length in (self.edge, self.edge, HEIGHT)]

    @property
    def corners(self):
        return (0.0, 0.0, LOW), (self.edge, self.edge, LOW + HEIGHT)

    def branch(self, frame, first, second):
        """From the second grain to the first, or its nearest image."""
        between = frame.position[first] - frame.position[second]
        if self.periodic:
            between[:2] -= self.edge * np.rint(between[:2] / self.edge)
        return between


def numbers(rows):
    return np.array([[float(word) for word in row] for row in rows])


def one_cell(path):
    """The grains in the order of their ids, and the contacts with the number of boxes along x and y from the first grain to the second."""
    dump = Dump(path, "ATOMS")
    rows = numbers(dump.rows)
    rows = rows[np.argsort(rows[:, dump.columns.index("id")])]
    column = lambda *names: rows[:, [dump.columns.index(name) for name in names]]
    contacts = numbers(Dump(SAMPLE / path.name.replace("dump", "contacts"), "ENTRIES").rows)
    pairs = np.searchsorted(column("id")[:, 0], contacts[:, 6:8])  # in the order in which LIGGGHTS numbers the columns
    position = column("x", "y", "z")
    boxes = np.rint((position[pairs[:, 0], :2] - position[pairs[:, 1], :2]) / dump.length).astype(int)
    grains = (position, column("vx", "vy", "vz"), column("omegax", "omegay", "omegaz"), column("radius")[:, 0])
    return grains, pairs, boxes, contacts[:, 9:12], dump.length[0]


def frame_of(path, copies, periodic):
    (position, velocity, spin, radius), pairs, boxes, force, length = one_cell(path)
    places, all_pairs, all_forces = [], [], []
    for i in range(copies):
        for j in range(copies):
            places.append(position + [i * length, j * length, 0])
            other = boxes + [i, j]
            inside = np.logical_or(periodic, (other == other % copies).all(axis=1))
            first = pairs[:, 0] + len(radius) * (i * copies + j)
            second = pairs[:, 1] + len(radius) * (other % copies @ [copies, 1])
            all_pairs.append(np.stack([first, second], axis=1)[inside])
            all_forces.append(force[inside])
    again = lambda values: np.concatenate([values] * copies**2)
    return Frame(int("".join(filter(str.isdigit, path.stem))), np.concatenate(places), again(velocity), again(spin), again(radius),
                 np.concatenate(all_pairs), np.concatenate(all_forces)), length


def make_scene(copies, periodic=False):
    """So many cells along x and as many along y."""
    frames = [frame_of(path, copies, periodic) for path in sorted(SAMPLE.glob("dump*.liggghts"))]
    name = f"cells{copies}" + ("_periodic" if periodic else "")
    return Scene([frame for frame, _ in frames], copies * frames[0][1], name, periodic)


def text(values):
    return " ".join(f"{value:.12g}" for value in values)


def write_mercury(scene, folder):
    """NAME.data and NAME.fstat, as MercuryDPM's DPMBase::outputXBallsData and BaseInteraction::writeToFStat write them."""
    low, high = scene.corners
    with open(folder / f"{scene.name}.data", "w") as data, open(folder / f"{scene.name}.fstat", "w") as fstat:
        for frame in scene.frames:
            time = frame.step * DT
            print(len(frame.radius), text([time, *low, *high]), file=data)
            for x, v, r, w in zip(frame.position, frame.velocity, frame.radius, frame.spin):
                print(text([*x, *v, r, 0, 0, 0, *w, 0]), file=data)
            print(f"# {time:.12g} 1\n# {text([*low, *high])}\n# 0 0 0 0 0 0", file=fstat)
            for pair, force in zip(frame.pairs, frame.force):
                for line in contact_lines(scene, frame, time, *pair, force):
                    print(line, file=fstat)


def contact_lines(scene, frame, time, first, second, force):
    branch = scene.branch(frame, first, second)
    distance = np.linalg.norm(branch)
    normal = branch / distance
    overlap = frame.radius[first] + frame.radius[second] - distance
    point = frame.position[first] - (frame.radius[first] - overlap / 2) * normal
    tangential = force - (force @ normal) * normal
    size = np.linalg.norm(tangential)
    tangent = tangential / size if size > 0 else np.zeros(3)
    for p, i, sign in ((first, second, 1), (second, first, -1)):
        yield text([time, p, i, *point, overlap, 0, force @ normal, size, *(sign * normal), *(sign * tangent)])


def write_text_dumps(scene, folder):
    """NAME.dump and NAME.contacts, text dumps of LIGGGHTS with all frames one after another, as NDDEM reads them."""
    low, high = scene.corners
    box = "ITEM: BOX BOUNDS ff ff ff\n" + "\n".join(f"{a:.12g} {b:.12g}" for a, b in zip(low, high))
    with open(folder / f"{scene.name}.dump", "w") as grains, open(folder / f"{scene.name}.contacts", "w") as contacts:
        for frame in scene.frames:
            head = f"ITEM: TIMESTEP\n{frame.step}\nITEM: NUMBER OF"
            mass = DENSITY * frame.volume
            print(f"{head} ATOMS\n{len(mass)}\n{box}\nITEM: ATOMS id type x y z vx vy vz radius mass ", file=grains)
            for n, (x, v, r, m) in enumerate(zip(frame.position, frame.velocity, frame.radius, mass)):
                print(text([n + 1, 1, *x, *v, r, m]), "", file=grains)
            print(f"{head} ENTRIES\n{len(frame.pairs)}\n{box}\nITEM: ENTRIES c_cl[1] c_cl[2] c_cl[3] c_cl[4] c_cl[5] ", file=contacts)
            for pair, force in zip(frame.pairs, frame.force):
                print(text([*(pair + 1), *force]), "", file=contacts)
        print("ITEM: TIMESTEP", file=grains)  # it rewinds no file that it has read to the end
        print("ITEM: TIMESTEP", file=contacts)
