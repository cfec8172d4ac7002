"""The published silo of the spot model, 50 x 8 x 110 diameters and 55,000 grains, or one like it: its runs, and what is measured of them."""
import csv
import dataclasses
import math
import pathlib
import re
import resource
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[1]
PHI = 0.58  # of the random packing that it starts from
DEPTH, ORIFICE = 8, 8
RISE = 2.8  # of spots, diameters per time
RADIUS = 2.6
SIDEWAYS, UPWARDS = 0.676, 0.1  # the published step
SPOT_FILE = """grainvdb: 1
packing: {packing}
container:
  lo: [{x0}, 0, 0]
  hi: [{x1}, {depth}, {height}]
  periodic: [y]
  orifice: {{width: {orifice}}}
spots:
  radius: {radius}
  influence: 399
  step: [{sideways:.6g}, {sideways:.6g}, {upwards:.6g}]
  hop_rate: {hop_rate:.6g}
  insertion_rate: 375
  entry: spread
  wall_distance: 1
relaxation: {{every: {every}, radius: {zone:.6g}, strength: {strength:.6g}}}
output: {{interval: {interval}, end: {end}, from: {start}}}
"""
MEASURE = """grainvdb: 1
input: {{particles: {dumps}/spot_*.dump}}
lattice: {{voxel: 0.5}}
kernel: {{cutoff: 3}}
measure:
  pair_correlation: {{lo: {lo}, hi: {hi}, reach: 2.5, bins: 500}}
  overlap: {{lo: {lo}, hi: {hi}}}
  voronoi: {{lo: {lo}, hi: {hi}}}
"""


@dataclasses.dataclass(frozen=True)
class Setting:
    """How long the steps of spots are and how grains are relaxed: what changes the cost of a run, and not its mean flow."""
    scale: float = 1     # of steps along x and y; its square those along z, so that b stays, and the time of a step, so that spots rise as fast
    every: int = 1       # steps that are followed by a relaxation; 0: none
    strength: float = 0.8
    margin: float = 1    # of the zone of relaxation around the spot

    def values(self):
        upwards = UPWARDS * self.scale**2
        return {"radius": RADIUS, "sideways": SIDEWAYS * self.scale, "upwards": upwards, "hop_rate": RISE / upwards, "every": self.every,
                "zone": RADIUS + self.margin, "strength": self.strength}


def add_arguments(parser):
    parser.add_argument("--command", default=ROOT / "build/release/grainvdb", help="the grainvdb command")
    parser.add_argument("--grains", type=int, default=55000)
    parser.add_argument("--width", type=int, default=50, help="of the silo, an even number of diameters")


def add_setting_arguments(parser):
    parser.add_argument("--step-scale", type=float, default=1, metavar="S",
                        help="steps of S dx sideways and S^2 dz upwards, S^2 times as seldom: the same b and speed of spots")
    parser.add_argument("--every", type=int, default=1, help="steps of spots that are followed by a relaxation; 0: none")
    parser.add_argument("--strength", type=float, default=0.8, help="the share of an overlap that a relaxation undoes")
    parser.add_argument("--margin", type=float, default=1, help="how far the zone of relaxation reaches beyond the spot")


def setting(options):
    return Setting(options.step_scale, options.every, options.strength, options.margin)


def settings(options):
    height = options.grains * math.pi / 6 / (PHI * options.width * DEPTH)
    return {"x0": -options.width / 2, "x1": options.width / 2, "height": height, "depth": DEPTH, "orifice": ORIFICE,
            "packing": f"{{random: {{phi: {PHI}}}}}"}


def packed(command, folder, silo):
    """The silo with its random packing in a dump, so that runs do not take the time to make it."""
    run(command, folder, silo, Setting(), 1e-9, 1e-9)
    return {**silo, "packing": f"{{dump: {(folder / 'dumps/spot_0000000.dump').resolve()}}}"}


def filled(silo):
    """The time at which spots have filled it."""
    return round(1.1 * silo["height"] / RISE, 1)


def processor_time():
    """Of the commands that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@dataclasses.dataclass
class SpotRun:
    seconds: float  # of processor time, which others on the machine hardly change
    at_start: int   # grains
    drained: int
    steps: int      # of spots


def run(command, folder, silo, chosen, interval, end, start=0):
    """Runs the silo into a folder of its own. Snapshots begin at `start`."""
    folder.mkdir(parents=True)
    file = folder / "silo.yaml"
    file.write_text(SPOT_FILE.format(interval=interval, end=end, start=start, **chosen.values(), **silo))
    began = processor_time()
    said = subprocess.run([command, "spot", "run", file, "--output", folder / "dumps"], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    seconds = processor_time() - began
    number = lambda words: int(re.search(words, said).group(1))
    return SpotRun(seconds, number(r"(\d+) at the start"), number(r"(\d+) drained"), number(r"(\d+) steps"))


@dataclasses.dataclass
class Stretch:
    """A stretch of a run that was timed."""
    seconds: float
    left: int   # grains
    steps: int  # of spots


def timed_stretch(command, folder, silo, chosen, begin, length, repeats=2):
    """What the run takes between two times: the difference of two runs, each of them the fastest of some."""
    def fastest(end):
        runs = [run(command, folder / f"{end}_{n}", silo, chosen, end, end) for n in range(repeats)]
        return min(runs, key=lambda one: one.seconds)
    before, after = fastest(begin), fastest(round(begin + length, 1))
    return Stretch(after.seconds - before.seconds, after.drained - before.drained, after.steps - before.steps)


def table(path):
    """The rows of a table, as words."""
    with open(path, encoding="utf-8") as file:
        return list(csv.reader(line for line in file if not line.startswith("#")))[1:]


def measured(command, pipeline, out, frames):
    """The numbers of the measurements that a pipeline file makes of some frames; tables are left in the folder `out`."""
    subprocess.run([command, "measure", pipeline, "--output", out, "--frames", frames, "--quiet"], check=True)
    return {(row[0], row[1]): row[2:] for row in table(out / "tables/numbers.csv")}


def pair_correlation(out):
    """Distances and g."""
    return [(float(row[0]), float(row[1])) for row in table(out / "tables/pair_correlation.csv")]


def mean(g, lo, hi):
    values = [y for x, y in g if lo <= x < hi]
    return sum(values) / len(values)
