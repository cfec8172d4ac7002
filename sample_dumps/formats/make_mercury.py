#!/usr/bin/env python3
"""Writes steps 20 and 40 of the LIGGGHTS run as MercuryDPM would: mercury.data and mercury.fstat.

The format is that of MercuryDPM's DPMBase::outputXBallsData, DPMBase::writeFstatHeader and
BaseInteraction::writeToFStat.  Run it where the LIGGGHTS dumps lie.
"""
import math

RADIUS, BOX = 0.0005, ((0.0, 0.004), (0.0, 0.01), (0.0, 0.01))


def rows(path):
    lines = open(path).read().splitlines()
    return [[float(word) for word in line.split()] for line in lines[9:]]


def text(values):
    return " ".join("%.16g" % value for value in values)


def scaled(vector, factor):
    return [factor * component for component in vector]


def length(vector):
    return math.sqrt(sum(component**2 for component in vector))


def contact_line(time, first, second, point, overlap, normal_force, tangential_force, normal, tangent):
    return text([time, first, second, *point, overlap, 0, normal_force, tangential_force, *normal, *tangent])


with open("mercury.data", "w") as data, open("mercury.fstat", "w") as fstat:
    for step in (20, 40):
        time = step * 1e-6
        grains = sorted(rows(f"liggghts_{step}.dump"))
        bounds = [low for low, high in BOX] + [high for low, high in BOX]
        print(text([len(grains), time, *bounds]), file=data, end=" \n")
        for grain in grains:
            print(text([*grain[2:8], RADIUS, 0, 0, 0, *grain[11:14], grain[1] - 1]), file=data)
        print("#", text([time, 1]), file=fstat)
        print("#", text(bounds), file=fstat)
        print("#", text([RADIUS, RADIUS, 0, 0, 0, 0]), file=fstat)
        for contact in rows(f"liggghts_contacts_{step}.dump"):
            first, second = int(contact[0]) - 1, int(contact[1]) - 1
            force_n, force_t, overlap, point = contact[6:9], contact[9:12], contact[12], contact[13:16]
            branch = [a - b for a, b in zip(grains[first][2:5], grains[second][2:5])]
            branch[0] -= 0.004 * round(branch[0] / 0.004)
            normal = scaled(branch, 1 / length(branch))
            normal_force = sum(f * n for f, n in zip(force_n, normal))
            tangential_force = length(force_t)
            tangent = scaled(force_t, 1 / tangential_force)
            values = (point, overlap, normal_force, tangential_force)
            print(contact_line(time, first, second, *values, normal, tangent), file=fstat)
            print(contact_line(time, second, first, *values, scaled(normal, -1), scaled(tangent, -1)), file=fstat)
        floor = (0, -1, [*grains[0][2:4], 0], 1e-6, 1e-4, 0, [0, 0, -1], [0, 0, 0])
        print(contact_line(time, *floor), file=fstat)
