"""Runs of the shear cell in sample_dumps, and copies of it side by side, for tools/accuracy."""
import gzip
import pathlib
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
SAMPLE = ROOT / "sample_dumps/shear_cell"


def call(options, verb, *words):
    result = subprocess.run([options.command, verb, ROOT / "pipelines/shear_cell.yaml", *words], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"accuracy: {result.stderr.strip()}")
    return result.stdout


def timed_call(options, verb, *words):
    """Seconds of processor time, user and system, which other work of the machine lengthens little; and what the call prints."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = call(options, verb, "--threads", str(options.threads), *words)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, text


class Dump:
    """Header and rows of a text dump of one frame."""

    def __init__(self, path, rows):
        lines = path.read_text().splitlines()
        behind = lambda title: next(i + 1 for i, line in enumerate(lines) if line.startswith(title))
        start = behind(f"ITEM: {rows}")
        self._head, self.rows = lines[:start], [line.split() for line in lines[start:]]
        self._number, self._bounds = behind("ITEM: NUMBER OF"), behind("ITEM: BOX BOUNDS")
        self.columns = self._head[-1].split()[2:]
        limits = [[float(word) for word in self._head[self._bounds + axis].split()] for axis in range(2)]
        self._low, self.length = [low for low, _ in limits], [high - low for low, high in limits]

    def text(self, rows, copies):
        """That of a dump with these rows, and so many boxes along x and as many along y."""
        head = list(self._head)
        head[self._number] = str(len(rows))
        for axis, (low, length) in enumerate(zip(self._low, self.length)):
            head[self._bounds + axis] = f"{low:.9g} {low + copies * length:.9g}"
        return "\n".join(head + [" ".join(row) for row in rows]) + "\n"


def moved(row, columns, by):
    """The row with so much added to x and y, which stand in these columns."""
    result = list(row)
    for column, length in zip(columns, by):
        result[column] = f"{float(row[column]) + length:.9g}"
    return result


def grains_side_by_side(grains, copies):
    identity, places = grains.columns.index("id"), [grains.columns.index(axis) for axis in "xy"]
    most = max(int(row[identity]) for row in grains.rows)
    result = []
    for i in range(copies):
        for j in range(copies):
            for row in grains.rows:
                copy = moved(row, places, (i * grains.length[0], j * grains.length[1]))
                copy[identity] = str(int(row[identity]) + most * (copies * i + j))
                result.append(copy)
    return grains.text(result, copies)


def contacts_side_by_side(contacts, grains, copies):
    """Where the second grain is nearest across the edge of a box, it is that of the box beside."""
    first, second, point = 6, 7, (16, 17)  # in the order in which LIGGGHTS numbers the columns
    identity, places = grains.columns.index("id"), [grains.columns.index(axis) for axis in "xy"]
    where = {row[identity]: [float(row[place]) for place in places] for row in grains.rows}
    most = max(int(row[identity]) for row in grains.rows)
    result = []
    for i in range(copies):
        for j in range(copies):
            for row in contacts.rows:
                boxes = [round((a - b) / length) for a, b, length in zip(where[row[first]], where[row[second]], grains.length)]
                copy = moved(row, point, (i * grains.length[0], j * grains.length[1]))
                copy[first] = str(int(row[first]) + most * (copies * i + j))
                copy[second] = str(int(row[second]) + most * (copies * ((i + boxes[0]) % copies) + (j + boxes[1]) % copies))
                result.append(copy)
    return contacts.text(result, copies)


def make_dumps(folder, copies):
    """Dumps of grains, plain and compressed, and of their contacts; returns the number of grains."""
    for path in sorted(SAMPLE.glob("dump*.liggghts")):
        grains = Dump(path, "ATOMS")
        text = grains_side_by_side(grains, copies)
        (folder / path.name).write_text(text)
        with gzip.open(folder / (path.name + ".gz"), "wt", compresslevel=1) as file:
            file.write(text)
        name = path.name.replace("dump", "contacts")
        (folder / name).write_text(contacts_side_by_side(Dump(SAMPLE / name, "ENTRIES"), grains, copies))
    return len(grains.rows) * copies**2


def write_between(document, name, text):
    """Replaces what stands between the marks of this name."""
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    before, rest = document.split(begin)
    return before + begin + "\n" + text + "\n" + end + rest.split(end)[1]
