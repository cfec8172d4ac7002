"""Dumps of grains on a lattice, for tools/accuracy: what fields must come out of them is known."""
import numpy as np

PHASE = np.pi / 4  # of the wave, which has both a value and a gradient at the ends of the packing
PHI = np.pi / 6  # of the lattice, whose neighbours touch: diameter and spacing are 1


def lattice(edge, height, spacing=1):
    """Places of the grains."""
    along = [spacing * (np.arange(round(n / spacing)) + 0.5) for n in (edge, edge, height)]
    return np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)


def write(folder, name, places, box, periodic, frames, diameter=1, types=None, masses=None):
    """One dump for each pair of velocities and spins. Grains are of type 1 and have the mass 1 unless it says otherwise."""
    types = np.ones(len(places), int) if types is None else types
    masses = np.ones(len(places)) if masses is None else masses
    bounds = " ".join("pp" if p else "ff" for p in periodic)
    for step, (velocity, spin) in enumerate(frames):
        with open(folder / f"{name}{step}.dump", "w") as out:
            out.write(f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(places)}\nITEM: BOX BOUNDS {bounds}\n")
            out.writelines(f"0 {length}\n" for length in box)
            out.write("ITEM: ATOMS id type x y z vx vy vz omegax omegay omegaz radius mass\n")
            rows = np.concatenate([places, velocity, spin], axis=1)
            out.writelines(f"{i + 1} {types[i]} " + " ".join(f"{x:.9g}" for x in row) + f" {diameter / 2:.9g} {masses[i]:g}\n"
                           for i, row in enumerate(rows))


def fluctuations(random, count):
    """Vectors that are independent of each other, with a mean square of 1 and no mean."""
    vectors = random.standard_normal((count, 3))
    vectors -= vectors.mean(axis=0)
    return vectors / np.sqrt(np.mean(np.sum(vectors**2, axis=1)))


def at_rest(folder, edge, frames):
    """A periodic packing whose mean velocity and spin are 0, T = 1 and δω² = 1."""
    random, places = np.random.default_rng(1), lattice(edge, edge)
    write(folder, "rest", places, 3 * [edge], 3 * [True],
          [(fluctuations(random, len(places)), fluctuations(random, len(places))) for _ in range(frames)])


def in_shear(folder, edge, height, rate, frames):
    """The same with u = ω = rate z along x, periodic along x and y."""
    random, places = np.random.default_rng(2), lattice(edge, height)
    mean = np.outer(rate * places[:, 2], [1, 0, 0])
    write(folder, "shear", places, [edge, edge, height], [True, True, False],
          [(mean + fluctuations(random, len(places)), mean + fluctuations(random, len(places))) for _ in range(frames)])


def column(folder, edge, height):
    """Grains of mass 1 at rest under a weight of 1 each, stacked on a layer of wall grains of type 2 whose centres lie at z = 0.5, with
    the contacts that bear them."""
    places = lattice(edge, height)
    box = [edge, edge, height + 1]
    layers = places[:, 2] - 0.5
    write(folder, "column", places, box, [True, True, False], [(0 * places, 0 * places)], types=np.where(layers == 0, 2, 1))
    pairs = [(i, i + 1) for i in range(len(places) - 1) if layers[i + 1] == layers[i] + 1]
    with open(folder / "column_contacts0.dump", "w") as out:
        out.write(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n{len(pairs)}\nITEM: BOX BOUNDS pp pp ff\n")
        out.writelines(f"0 {length}\n" for length in box)
        out.write("ITEM: ENTRIES id1 id2 fx fy fz px py pz\n")
        for below, above in pairs:
            x, y, z = places[below]
            out.write(f"{above + 1} {below + 1} 0 0 {height - 1 - layers[below]:.9g} {x:.9g} {y:.9g} {z + 0.5:.9g}\n")


def mixture(folder, edge, height, heavy):
    """Grains of two materials and one size, those of mass `heavy` more of them the higher, in a share of z/height; they alone move, with
    u = 1 along x."""
    random, places = np.random.default_rng(3), lattice(edge, height)
    is_heavy = random.random(len(places)) < places[:, 2] / height
    velocity = np.outer(is_heavy, [1, 0, 0])
    write(folder, "mixture", places, [edge, edge, height], [True, True, False], [(velocity, 0 * velocity)],
          types=np.where(is_heavy, 2, 1), masses=np.where(is_heavy, heavy, 1))


def in_a_wave(folder, name, edge, height, length, spacing):
    """A velocity along x that is a sine of z, and no fluctuation."""
    places = lattice(edge, height, spacing)
    velocity = np.outer(np.sin(2 * np.pi * places[:, 2] / length + PHASE), [1, 0, 0])
    write(folder, name, places, [edge, edge, height], [True, True, False], [(velocity, 0 * velocity)], spacing)
