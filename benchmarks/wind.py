"""Times of wind and current loads: all forces of one evaluation, and of making a wind record.

    python benchmarks/wind.py

Medians of CPU time after compilation. *Tables* are coefficient loads over the angle of attack, 37 rows; *drag* is
one area, *box* its projection. The wind is logarithmic with a fluctuation; *gust* is a constant one.
"""

from __future__ import annotations

import time

import numpy as np

from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    add_forces,
)
from heavylift.solver.joints.packing import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.wind_loads import (
    CurrentField,
    CurrentProfile,
    DragElement,
    WindField,
    fluctuation_record,
)
from heavylift.solver.water.wind.coefficients import CoefficientLoad
from heavylift.solver.water.wind.packing import add_fluid_channels, fluid_markers, pack_fluid_loads
from heavylift.solver.water.wind.spectrum import wind_components, wind_record

CALLS = 20000


@kernel
def repeat(forces, work, times):
    for i in range(times.shape[0]):
        add_forces(forces, times[i], work)


def median(function, repeats):
    spent = []
    for _ in range(repeats):
        begin = time.thread_time()
        function()
        spent.append(time.thread_time() - begin)
    return float(np.median(spent))


def table(number, fluid):
    angles = np.radians(np.arange(-180.0, 180.0, 10.0))
    return CoefficientLoad(
        name=f"load {number}", body="body", point=np.zeros(3), angles=angles,
        cx=np.cos(angles), cy=np.sin(angles), cn=0.1 * np.sin(2.0 * angles),
        area_x=400.0, area_y=900.0, length=90.0, fluid=fluid,
    )  # fmt: skip


def drag(number, fluid):
    return DragElement(name=f"load {number}", body="body", point=np.zeros(3), area=20.0, fluid=fluid)


def box(number, fluid):
    return DragElement(
        name=f"load {number}",
        body="body",
        point=np.zeros(3),
        area=(20.0, 30.0, 10.0),
        vertical=True,
        fluid=fluid,
    )


def measure(field, load, count, height):
    loads = [load(number, field.name) for number in range(count)]
    book = MarkerBook()
    markers = fluid_markers(book, loads)
    kind = pack_fluid_loads([field], loads, markers, add_fluid_channels(ChannelBook(), [field], loads))
    work = Workspace.empty(6, book.count)
    rng = np.random.default_rng(0)
    for name in ("point", "velocity"):
        work.markers[name] = rng.uniform(-1.0, 1.0, (book.count, 3))
    for point, _ in markers:
        work.markers[point].point[2] = height * rng.uniform(1.0, 2.0)
    times = np.linspace(0.0, 600.0, max(CALLS // count, 200))
    repeat((kind,), work, times[:1])
    return 1e9 * median(lambda: repeat((kind,), work, times), 21) / len(times)


def main():
    record = fluctuation_record(10.0, 600.0, seed=1)
    fields = (
        (WindField(speed=10.0, fluctuation=record), 20.0),
        (WindField(name="gust", speed=10.0, gust=3.0), 20.0),
        (CurrentField(speed=CurrentProfile(np.array([0.0, 10.0, 30.0]), np.array([1.0, 0.6, 0.2]))), -5.0),
    )
    print("time of one evaluation in ns, and per load")
    print("field    load       1 load         10 loads        100 loads")
    for field, height in fields:
        for name, load in (("tables", table), ("drag", drag), ("box", box)):
            spent = [(count, measure(field, load, count, height)) for count in (1, 10, 100)]
            text = "".join(f"{t:8.0f} ({t / count:5.1f})" for count, t in spent)
            print(f"{field.name:8s} {name:6s}{text}")
    components = wind_components(10.0, seed=1)
    times = 0.1 * np.arange(36001)
    seconds = median(lambda: wind_record(components, times), 5)
    print(f"record of one hour at 0.1 s from 200 components: {seconds:.3f} s")


if __name__ == "__main__":
    main()
