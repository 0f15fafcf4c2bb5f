"""Exudyn's ANCF cable on the flexible pendulum of `ancf_pendulum.py`, in the same process: error against CPU time.

    pip install ".[peers]" && python benchmarks/ancf_peers.py

Same elements, strains (``|r'| - 1``, material curvature), quadrature (5 and 3 points) and samples; errors are those of
the time integration, against our accurate integrator with a tolerance of 1e-11 m. Trapezoidal rule of index 2 with
Exudyn's own modified Newton, sparse solver, no output but the sensor.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))

from ancf_pendulum import DURATION, SAMPLES, pendulum, run

STEP_COUNTS = (200, 500, 1000, 2000, 5000)


def exudyn_tip(count: int, steps: int) -> tuple[Any, float]:
    """Tip at the samples in the plane, shape (20, 2), and CPU time of the solver [s]; None if it fails."""
    import exudyn as exu
    from exudyn.beams import GenerateStraightLineANCFCable2D
    from exudyn.utilities import Cable2D, SensorNode

    container = exu.SystemContainer()
    system = container.AddSystem()
    cable = Cable2D(
        physicsMassPerLength=5540.0 * 0.0018,
        physicsBendingStiffness=0.7e6 * 1.215e-8,
        physicsAxialStiffness=0.7e6 * 0.0018,
        useReducedOrderIntegration=0,
    )
    made = GenerateStraightLineANCFCable2D(
        mbs=system,
        positionOfNode0=[0.0, 0.0, 0.0],
        positionOfNode1=[1.2, 0.0, 0.0],
        numberOfElements=count,
        cableTemplate=cable,
        massProportionalLoad=[0.0, -9.81, 0.0],
        fixedConstraintsNode0=[1, 1, 0, 0],
        fixedConstraintsNode1=[0, 0, 0, 0],
    )
    sensor = system.AddSensor(
        SensorNode(
            nodeNumber=made[0][-1],
            storeInternal=True,
            writeToFile=False,
            outputVariableType=exu.OutputVariableType.Position,
        )
    )
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = DURATION / SAMPLES
    settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.displayStatistics = False
    begin = time.process_time()
    try:
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2, showHints=False)
    except (ValueError, RuntimeError):
        return None, time.process_time() - begin
    seconds = time.process_time() - begin
    return system.GetSensorStoredData(sensor)[1:, 1:3], seconds


def main() -> None:
    """Print a table for each number of elements."""
    print("Exudyn: elements, steps, error [m], CPU time [ms]")
    for count in (10, 20, 40):
        reference, _ = run(pendulum(count, "exact", "carried"), count, tolerance=1e-11)
        for steps in STEP_COUNTS:
            tips, times = zip(*(exudyn_tip(count, steps) for _ in range(3)), strict=True)
            if tips[0] is None or len(tips[0]) != SAMPLES:
                print(f"  {count:3d} {steps:6d} failed")
                continue
            error = float(np.abs(tips[0] - reference[:, :2]).max())
            print(f"  {count:3d} {steps:6d} {error:9.1e} {1e3 * sorted(times)[1]:9.1f}", flush=True)


if __name__ == "__main__":
    main()
