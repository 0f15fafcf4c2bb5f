"""A case as a functional mock-up unit: its description, its resources, and the library that serves it to a host.

The library (``heavylift_fmu.c``) is compiled here, by the C compiler of the system; it drives ``heavylift serve`` in a
child process. The unit holds the case folder, so it needs an installed heavylift and nothing else.
"""

from __future__ import annotations

import hashlib
import math
import os
import platform
import re
import struct
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Literal
from xml.sax.saxutils import quoteattr

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import parse_unit
from heavylift.pipeline.coupling.compiler import compile_library
from heavylift.pipeline.exchange.protocol import msgpack_library
from heavylift.pipeline.results.storage import replacing
from heavylift.pipeline.stepping.simulation import InputInfo, Simulation

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from heavylift.pipeline.stepping.simulation import OutputInfo

__all__ = ["FmiVersion", "export_fmu", "structured_name"]

FmiVersion = Literal[2, 3]
"""Versions of the standard."""

HERE = Path(__file__).parent
LARGEST_FOLDER = 2**30
"""Bytes of a case folder that is put into a unit."""
WHEN = (1980, 1, 1, 0, 0, 0)
"""Date of all files: the same case makes the same unit."""
PURE = {"1", ""}
"""Units of pure numbers."""
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")


def structured_name(name: str) -> str:
    """A name as the variable naming convention "structured" of FMI has it: odd parts in quotes.

    >>> structured_name("module.position.x"), structured_name("edge-1.force.12")
    ('module.position.x', "'edge-1'.force.'12'")
    """
    parts = []
    for part in name.split("."):
        quoted = part.replace("\\", "\\\\").replace("'", "\\'")
        parts.append(part if _PLAIN.match(part) else f"'{quoted}'")
    return ".".join(parts)


def export_fmu(
    path: Path | str,
    fmi: FmiVersion = 3,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
) -> Path:
    """Write a case as a unit for co-simulation.

    Parameters
    ----------
    path
        Case folder, or its case.toml.
    fmi
        Version of the standard.
    out
        The file; ``NAME.fmu`` in the current folder by default.
    overrides
        As ``--set``; the unit runs with them.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the case is wrong, there is no C compiler, or the file cannot be written.
    """
    if fmi not in {2, 3}:
        raise InputError(f"{fmi!r}", source="fmu", key="--fmi", expected="2 or 3")
    msgpack_library()  # by which the unit speaks with its child
    with tempfile.TemporaryDirectory(prefix="heavylift-") as scratch:
        return _export(Path(scratch), path, fmi, out, overrides)


def _export(
    scratch: Path, path: Path | str, fmi: FmiVersion, out: Path | None, overrides: Sequence[str]
) -> Path:
    """Write a unit; what is made for it goes to a folder."""
    made = scratch / "out"
    simulation = Simulation(path, out=made, overrides=overrides)
    case = simulation.case
    identifier = re.sub(r"\W", "_", case.name, flags=re.ASCII)
    identifier = identifier if _PLAIN.match(identifier) else f"case_{identifier}"
    target = Path(f"{case.name}.fmu") if out is None else out
    if target.is_dir():
        raise InputError(f"{target} is a folder", source="fmu", key="--out", expected="the name of a file")
    inputs, outputs = list(simulation.inputs.values()), list(simulation.outputs.values())
    files = dict(_case_files(case.folder, target))
    command = ["-P", "-c", "from heavylift.pipeline.commands.start import main; main()", "serve"]
    command += [f"@/case/{case.file.name}", "--pipe", "--quiet"]
    for change in overrides:
        command += ["--set", change]
    if any("\n" in word for word in command):
        raise InputError("a line break", source="fmu", key="--set", expected="changes of one line")
    digest = hashlib.blake2b(digest_size=16)
    for name, file in files.items():
        digest.update(f"{name}\0".encode() + hashlib.blake2b(file.read_bytes()).digest())
    digest.update("\0".join([str(fmi), *command]).encode())
    token = f"{{{digest.hexdigest()}}}"
    texts = {
        "modelDescription.xml": _description(fmi, simulation, identifier, token, inputs, outputs),
        "resources/variables.txt": _variables(inputs, outputs),
        "resources/command.txt": "".join(f"{word}\n" for word in command),
        "resources/python.txt": f"{sys.executable}\n",
        "resources/token.txt": token,
    }
    library = scratch / f"{identifier}{_ending()}"
    options = ["-std=c99", "-fvisibility=hidden", f"-DFMI={fmi}"]
    compile_library([*options, str(HERE / "heavylift_fmu.c")], library, scratch)
    outputs_of_case = case.output_folder.relative_to(case.folder).as_posix()
    for stage in ("mesh", "modes", "derived"):  # an instance takes them from there
        for name, file in _case_files(made / stage, target) if (made / stage).is_dir() else ():
            if file.suffix != ".vtu":  # a picture
                files[f"{outputs_of_case}/{stage}/{name}"] = file
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            _put(archive, name, text.encode())
        _put(archive, f"binaries/{_platform(fmi)}/{library.name}", library.read_bytes())
        for name, file in files.items():
            _put(archive, f"resources/case/{name}", file.read_bytes())
    return target


def _put(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    entry = zipfile.ZipInfo(name, WHEN)
    entry.external_attr = 0o644 << 16
    archive.writestr(entry, data, zipfile.ZIP_DEFLATED)


def _case_files(folder: Path, target: Path) -> Iterable[tuple[str, Path]]:
    """Files of a case folder by their names below it: no outputs, nothing hidden, no links out of it."""
    size, root = 0, folder.resolve()
    for place, folders, names in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith((".", "__pycache__")) and (here / name) != folder / "out"
        )
        for name in sorted(names):
            file = here / name
            if name.startswith(".") or not file.is_file() or file.resolve() == target.resolve():
                continue
            if not file.resolve().is_relative_to(root):
                raise InputError("leads out of the case folder", source=file, expected="files inside of it")
            size += file.stat().st_size
            if size > LARGEST_FOLDER:
                raise InputError(
                    "more than 1 GiB of files",
                    source=folder,
                    expected="a folder with what the case needs, without more",
                )
            yield file.relative_to(folder).as_posix(), file


def _variables(inputs: Sequence[InputInfo], outputs: Sequence[OutputInfo]) -> str:
    """What the library reads of the variables, in the order of their references."""
    lines = [f"{one.interpolation} {struct.pack('>d', one.value).hex()} {one.name}" for one in inputs]
    return "".join(f"{line}\n" for line in [*lines, *(f"output {one.name}" for one in outputs)])


def _element(name: str, attributes: Mapping[str, object], inside: str = "") -> str:
    """An element of XML; attributes that are None are left out, numbers are written in full."""
    words = "".join(
        f" {key}={quoteattr(_word(value))}" for key, value in attributes.items() if value is not None
    )
    return f"<{name}{words}>{inside}</{name}>" if inside else f"<{name}{words}/>"


def _word(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)


def _units(names: Iterable[str]) -> str:
    """Definitions of units; one with a power that is no integer has no base unit in FMI."""
    found = ""
    for name in sorted(set(names) - PURE):
        factor, dimension = parse_unit(name)
        powers = {"kg": dimension.mass, "m": dimension.length, "s": dimension.time, "rad": dimension.angle}
        base = ""
        if all(power == int(power) for power in powers.values()):
            words: dict[str, object] = {key: int(power) for key, power in powers.items() if power}
            base = _element("BaseUnit", words | ({} if factor == 1.0 else {"factor": factor}))
        found += _element("Unit", {"name": name}, base)
    return _element("UnitDefinitions", {}, found) if found else ""


def _number(one: InputInfo | OutputInfo) -> dict[str, object]:
    """Attributes of a variable as a number: unit, and of an input limits and start."""
    found: dict[str, object] = {"unit": None if one.unit in PURE else one.unit}
    if isinstance(one, InputInfo):
        found["min"] = one.smallest if math.isfinite(one.smallest) else None
        found["max"] = one.largest if math.isfinite(one.largest) else None
        found["start"] = one.value
    return found


def _description(
    fmi: FmiVersion,
    simulation: Simulation,
    identifier: str,
    token: str,
    inputs: Sequence[InputInfo],
    outputs: Sequence[OutputInfo],
) -> str:
    """The model description."""
    case, section = simulation.case, simulation.case.simulate
    assert section is not None
    ports: list[InputInfo | OutputInfo] = [*inputs, *outputs]
    references = range(len(inputs) + 1, len(ports) + 1)
    lines = []
    for k, one in enumerate(ports):
        is_input = k < len(inputs)
        about: dict[str, object] = {
            "name": structured_name(one.name),
            "valueReference": k + 1,
            "causality": "input" if is_input else "output",
            "variability": "continuous",
            "initial": None if is_input else "calculated",
            "description": one.sentence,
        }
        if fmi == 2:
            lines.append(_element("ScalarVariable", about, _element("Real", _number(one))))
        else:
            lines.append(_element("Float64", about | _number(one)))
    can: dict[str, object] = {
        "modelIdentifier": identifier,
        "needsExecutionTool": True,
        "canHandleVariableCommunicationStepSize": True,
    }
    if fmi == 2:
        head: dict[str, object] = {"fmiVersion": "2.0", "guid": token}
        can |= {
            "canInterpolateInputs": True,
            "canNotUseMemoryManagementFunctions": True,
            "canGetAndSetFMUstate": True,
            "canSerializeFMUstate": True,
        }
        unknowns = "".join(_element("Unknown", {"index": k}) for k in references)
        structure = _element("Outputs", {}, unknowns) + _element("InitialUnknowns", {}, unknowns)
    else:
        head = {"fmiVersion": "3.0", "instantiationToken": token}
        can |= {
            "canGetAndSetFMUState": True,
            "canSerializeFMUState": True,
            "fixedInternalStepSize": simulation.step_size,
        }
        time = {"name": "time", "valueReference": 0, "causality": "independent", "variability": "continuous"}
        lines.insert(0, _element("Float64", time))
        structure = "".join(_element("Output", {"valueReference": k}) for k in references)
        structure += "".join(_element("InitialUnknown", {"valueReference": k}) for k in references)
    head |= {
        "modelName": case.name,
        "description": case.title,
        "generationTool": "heavylift",
        "variableNamingConvention": "structured",
    }
    experiment = {"startTime": 0.0, "stopTime": simulation.duration, "stepSize": section.output_interval}
    parts = [
        _element("CoSimulation", can),
        _units(one.unit for one in ports),
        _element("DefaultExperiment", experiment),
        _element("ModelVariables", {}, "\n" + "\n".join(lines) + "\n"),
        _element("ModelStructure", {}, structure),
    ]
    inside = "\n" + "\n".join(filter(None, parts)) + "\n"
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + _element("fmiModelDescription", head, inside) + "\n"


def _platform(fmi: FmiVersion) -> str:
    """Folder of binaries for this machine."""
    machine, system = platform.machine().lower(), platform.system().lower()
    words = {"amd64": "x86_64", "arm64": "aarch64"}
    machine = words.get(machine, machine)
    if fmi == 3:
        return f"{machine}-{system}"
    plain = {"linux": "linux", "darwin": "darwin", "windows": "win"}.get(system, system)
    return f"{plain}64" if machine == "x86_64" else f"{machine}-{plain}"


def _ending() -> str:
    return ".dylib" if platform.system() == "Darwin" else ".so"
