"""One run at a time in a folder, and no lock that outlives its process."""

from __future__ import annotations

import subprocess
import sys

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages.lock import locked

HOLD = (
    "import sys, pathlib, time\n"
    "from heavylift.pipeline.stages.lock import locked\n"
    "with locked(pathlib.Path(sys.argv[1])):\n"
    "    print('held', flush=True)\n"
    "    time.sleep(60)\n"
)


@pytest.mark.slow
def test_the_second_run_is_told_who_holds_the_folder(tmp_path):
    with subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE) as holder:
        try:
            assert holder.stdout.readline().strip() == b"held"
            with pytest.raises(StopError, match=f"process {holder.pid} on") as caught, locked(tmp_path):
                pass
            assert caught.value.outcome is Outcome.LOCKED
            assert "--out" in str(caught.value)
        finally:
            holder.kill()
    with locked(tmp_path):  # the kill released it
        pass


def test_a_folder_can_be_locked_again_afterwards(tmp_path):
    for _ in range(2):
        with locked(tmp_path / "out"):
            pass
    with pytest.raises(RuntimeError), locked(tmp_path / "out"):
        raise RuntimeError
    with locked(tmp_path / "out"):
        pass
