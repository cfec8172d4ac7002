"""The published silo of the spot model, 50 x 8 x 110 diameters and 55,000 grains, or one like it."""
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
SPOT_FILE = """grainvdb: 1
packing: {{random: {{phi: {phi}}}}}
container:
  lo: [{x0}, 0, 0]
  hi: [{x1}, {depth}, {height}]
  periodic: [y]
  orifice: {{width: {orifice}}}
spots:
  radius: 2.6
  influence: 399
  step: [0.676, 0.676, 0.1]
  hop_rate: 28
  insertion_rate: 375
  entry: spread
  wall_distance: 1
relaxation: {{every: {every}}}
output: {{interval: {interval}, end: {end}}}
"""


def add_arguments(parser):
    parser.add_argument("--command", default=ROOT / "build/release/grainvdb", help="the grainvdb command")
    parser.add_argument("--grains", type=int, default=55000)
    parser.add_argument("--width", type=int, default=50, help="of the silo, an even number of diameters")


def settings(options):
    height = options.grains * math.pi / 6 / (PHI * options.width * DEPTH)
    return {"x0": -options.width / 2, "x1": options.width / 2, "height": height, "phi": PHI, "depth": DEPTH,
            "orifice": ORIFICE}


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


def run(command, folder, interval, end, silo, every=1):
    """Runs the silo into a folder of its own."""
    folder.mkdir(parents=True)
    file = folder / "silo.yaml"
    file.write_text(SPOT_FILE.format(interval=interval, end=end, every=every, **silo))
    began = processor_time()
    said = subprocess.run([command, "spot", "run", file, "--output", folder / "dumps"], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    seconds = processor_time() - began
    number = lambda words: int(re.search(words, said).group(1))
    return SpotRun(seconds, number(r"(\d+) at the start"), number(r"(\d+) drained"), number(r"(\d+) steps"))
