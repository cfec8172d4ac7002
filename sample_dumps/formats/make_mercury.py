#!/usr/bin/env python3
"""Writes two runs of LIGGGHTS as MercuryDPM would, as name.data and name.fstat.

mercury: steps 20 and 40 of in.liggghts. Its floor, whose force is not dumped, bears a made-up 1e-4 N.
mesh_mercury: step 2000 of in.mesh, with the contacts of the meshes as those of walls.

The format is that of MercuryDPM's DPMBase::outputXBallsData, DPMBase::writeFstatHeader and
BaseInteraction::writeToFStat.  Run it where the LIGGGHTS dumps lie.
"""
import math

RADIUS = 0.0005


def rows(path):
    lines = open(path).read().splitlines()
    return [[float(word) for word in line.split()] for line in lines[9:]]


def text(values):
    return " ".join("%.16g" % value for value in values)


def scaled(vector, factor):
    return [factor * component for component in vector]


def difference(first, second):
    return [a - b for a, b in zip(first, second)]


def dot(first, second):
    return sum(a * b for a, b in zip(first, second))


def unit(vector):
    length = math.sqrt(dot(vector, vector))
    return (length, scaled(vector, 1 / length if length > 0 else 0))


def contact_line(time, first, second, point, overlap, normal_force, tangential_force, normal, tangent):
    return text([time, first, second, *point, overlap, 0, normal_force, tangential_force, *normal, *tangent])


def both_lines(time, first, second, point, overlap, normal_force, tangential_force, normal, tangent):
    values = (point, overlap, normal_force, tangential_force)
    yield contact_line(time, first, second, *values, normal, tangent)
    yield contact_line(time, second, first, *values, scaled(normal, -1), scaled(tangent, -1))


def wall_line(time, grain, wall, centre, touched, force):
    """A force on a grain that touches a wall.  Normal and tangent are written with the opposite sign."""
    distance, normal = unit(difference(centre, touched))
    overlap = RADIUS - distance
    point = difference(centre, scaled(normal, RADIUS - overlap / 2))
    normal_force = dot(force, normal)
    tangential_force, tangent = unit(difference(force, scaled(normal, normal_force)))
    return contact_line(
        time, grain, -1 - wall, point, overlap, normal_force, tangential_force, scaled(normal, -1), scaled(tangent, -1)
    )


def pair_lines(time, grains, contacts, period):
    for first, second, force_n, force_t, overlap, point in contacts:
        branch = difference(grains[first][2:5], grains[second][2:5])
        branch[0] -= period * round(branch[0] / period) if period else 0
        _, normal = unit(branch)
        tangential_force, tangent = unit(force_t)
        yield from both_lines(time, first, second, point, overlap, dot(force_n, normal), tangential_force, normal, tangent)


def write(name, frames, bounds):
    """Frames are of time, grains (type, place, velocity and angular velocity) and lines of contacts."""
    with open(f"{name}.data", "w") as data, open(f"{name}.fstat", "w") as fstat:
        for time, grains, lines in frames:
            print(text([len(grains), time, *bounds]), file=data, end=" \n")
            for kind, place, velocity, spin in grains:
                print(text([*place, *velocity, RADIUS, 0, 0, 0, *spin, kind - 1]), file=data)
            print("#", text([time, 1]), file=fstat)
            print("#", text(bounds), file=fstat)
            print("#", text([RADIUS, RADIUS, 0, 0, 0, 0]), file=fstat)
            for line in lines:
                print(line, file=fstat)


def periodic_run():
    for step in (20, 40):
        time = step * 1e-6
        grains = sorted(rows(f"liggghts_{step}.dump"))
        contacts = [
            (int(c[0]) - 1, int(c[1]) - 1, c[6:9], c[9:12], c[12], c[13:16])
            for c in rows(f"liggghts_contacts_{step}.dump")
        ]
        floor = contact_line(time, 0, -1, [*grains[0][2:4], 0], 1e-6, 1e-4, 0, [0, 0, -1], [0, 0, 0])
        yield (
            time,
            [(g[1], g[2:5], g[5:8], g[11:14]) for g in grains],
            [*pair_lines(time, grains, contacts, 0.004), floor],
        )


def mesh_run():
    time = 2000 * 1e-5
    grains = sorted(rows("mesh_grains_2000.dump"))
    contacts = []
    for first, second, *force in rows("mesh_pairs_2000.dump"):
        i, j = int(first) - 1, int(second) - 1
        distance, normal = unit(difference(grains[i][2:5], grains[j][2:5]))
        force_n = scaled(normal, dot(force, normal))
        middle = scaled([a + b for a, b in zip(grains[i][2:5], grains[j][2:5])], 0.5)
        contacts.append((i, j, force_n, difference(force, force_n), 2 * RADIUS - distance, middle))
    walls = [
        wall_line(time, int(w[8]) - 1, int(w[6]), w[3:6], w[0:3], w[9:12]) for w in rows("mesh_walls_2000.dump")
    ]
    yield (
        time,
        [(g[1], g[2:5], g[5:8], [0, 0, 0]) for g in grains],
        [*pair_lines(time, grains, contacts, None), *walls],
    )


write("mercury", periodic_run(), [0, 0, 0, 0.004, 0.01, 0.01])
write("mesh_mercury", mesh_run(), [0, 0, 0, 0.008, 0.006, 0.006])
