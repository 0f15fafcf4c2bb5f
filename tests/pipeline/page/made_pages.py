"""Cases with records that are made here, so that what a page must show is known without a simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands.new_case import new_case
from heavylift.pipeline.drawn.build import case_scene
from heavylift.pipeline.page.page import Judged, page_content
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

TIMES = np.linspace(0.0, 8.0, 81)


def made_results(arrays, times=TIMES, **metadata):
    """Results with channels of given arrays, shape (nr,) or (nr, c); units by their names."""
    units = {"position": "m", "orientation": "1", "tension": "N", "force": "N", "phase": "1"}
    channels, columns, column = {}, {}, 0
    for name, values in arrays.items():
        table = np.asarray(values, dtype=float).reshape(len(times), -1)
        letters = {1: ("",), 3: ("x", "y", "z"), 4: ("q0", "q1", "q2", "q3")}
        components = letters.get(table.shape[1], tuple(str(k) for k in range(table.shape[1])))
        unit = units.get(name.rpartition(".")[2], "1")
        channels[name] = ChannelInfo(name, unit, components, column)
        columns[name] = table
        column += table.shape[1]
    return Results(Path("made"), np.asarray(times, dtype=float), channels, columns, metadata)


def turned(angle):
    """Quaternions of turns about z, shape (nr, 4)."""
    return np.column_stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)])


def lifted(times=TIMES):
    """Channels of the case `lift`: the module rises by 0.5 m/s and turns by 0.1 rad/s, the hook rises with it."""
    none = 0.0 * times
    return {
        "module.position": np.column_stack([none, none, 2.0 + 0.5 * times]),
        "module.orientation": turned(0.1 * times),
        "hook.position": np.column_stack([none, none, 14.0 + 0.5 * times]),
        "hook.orientation": turned(none),
        "hoist.tension": 1.0e6 + 1.0e5 * np.sin(times),
        **{f"sling_{k}.tension": 2.8e5 + 1e4 * np.cos(k * times) for k in range(1, 5)},
    }


def lift_case(folder, change=lambda text: text):
    """The case `lift` with its surfaces, perhaps with another text; and its output folder."""
    new_case("lift", folder)
    file = folder / "case.toml"
    file.write_text(change(file.read_text()))
    case = load_case(folder)
    stages = OutputFolder(case.output_folder)
    run_case(case, stages=("mesh",))
    return case, stages


def lift_motion(folder, arrays=None, times=TIMES):
    """Case, results and motion of a lift with given records."""
    case, stages = lift_case(folder)
    results = made_results(lifted(times) if arrays is None else arrays, times)
    return case, results, case_scene(case, stages, assemble_scene(case, stages), results)


def made_content(case, motion, results, **more):
    """Page of a lift with a check that governs at 3 s."""
    check = Judged(
        "height", "5 m", "≤ 6 m", "83 %", "module at 3 s", "passed", True, 3.0, ("module.position", "z"),
        ("module",), (("maximum", 6.0),),
    )  # fmt: skip
    more = {"judged": [check], "verdict": ("Passed: the only check.", True), **more}
    return page_content(case, motion, results, **more)
