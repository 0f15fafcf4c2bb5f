"""What is heavy is imported where it is used: a page is put together without a renderer and without plots."""

from __future__ import annotations

import subprocess
import sys


def test_a_page_needs_no_renderer():
    code = (
        "import sys\n"
        "import numpy as np\n"
        "from heavylift.pipeline.drawn.build import draw_scene\n"
        "from heavylift.pipeline.page.packing import Block\n"
        "from heavylift.pipeline.page.page import drawn_header\n"
        "from heavylift.solver.scene.scene import RigidBody, Scene\n"
        "drawn = draw_scene(Scene((RigidBody('block', 1.0, np.eye(3)),)))\n"
        "assert drawn_header(drawn, Block())['surfaces']\n"
        "names = {name.partition('.')[0] for name in sys.modules}\n"
        "print(sorted(names & {'pyvista', 'vtkmodules', 'matplotlib'}))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
