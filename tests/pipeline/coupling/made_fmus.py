"""FMUs for tests: the controller of `pd.c`, with descriptions and archives as wished."""

import subprocess
import zipfile
from pathlib import Path

import pytest

fmpy = pytest.importorskip("fmpy")

HERE = Path(__file__).parent
SOURCE = HERE / "pd.c"

VARIABLES = (
    # name, reference, type, causality, variability, unit, start
    ("x", 0, "Real", "input", "continuous", "m", "0"),
    ("v", 1, "Real", "input", "continuous", "m/s", "0"),
    ("force", 2, "Real", "output", "continuous", "kN", ""),
    ("stiffness", 3, "Real", "parameter", "fixed", "N/m", "20000"),
    ("damping", 4, "Real", "parameter", "fixed", "N.s/m", "60000"),
    ("limit", 5, "Real", "parameter", "fixed", "N", "100000"),
    ("sum", 6, "Real", "output", "continuous", "s", ""),
    ("fault", 7, "Integer", "parameter", "fixed", "", "0"),
    ("place", 8, "String", "parameter", "fixed", "", ""),
)


def library(folder, version, *flags):
    """The controller as a shared library."""
    path = folder / f"pd{version}{''.join(flags)}.so"
    if not path.is_file():
        command = [
            "cc",
            "-shared",
            "-fPIC",
            "-O1",
            f"-DFMI={version}",
            *flags,
            "-o",
            str(path),
            str(SOURCE),
            "-lm",
        ]
        subprocess.run(command, check=True, stdin=subprocess.DEVNULL)
    return path


def description(
    version,
    *,
    identifier="pd",
    known_as="pd",
    state=True,
    force="N",
    interface="CoSimulation",
    step="",
    sources=False,
):
    """A model description; `force` is the unit of the force, "N" or "kN", or another one that is not defined."""
    yes = "true" if state else "false"
    units = "".join(
        f'<Unit name="{name}"><BaseUnit {base}/></Unit>'
        for name, base in {
            "m": 'm="1"',
            "m/s": 'm="1" s="-1"',
            "N": 'kg="1" m="1" s="-2"',
            "kN": 'kg="1" m="1" s="-2" factor="1000"',
            "N.m": 'kg="1" m="2" s="-2"',
            "N/m": 'kg="1" s="-2"',
            "N.s/m": 'kg="1" s="-1"',
            "s": 's="1"',
        }.items()
    )
    listed = '<SourceFiles><File name="pd.c"/></SourceFiles>' if sources and version == 2 else ""
    rows = [(*row[:5], force if row[0] == "force" else row[5], row[6]) for row in VARIABLES]
    if version == 2:
        attributes = (
            f'canGetAndSetFMUstate="{yes}" canSerializeFMUstate="{yes}"'
            if interface == "CoSimulation"
            else ""
        )
        lines = []
        for name, reference, kind, causality, variability, unit, start in rows:
            inner = (f' unit="{unit}"' if unit else "") + (
                f' start="{start}"' if causality != "output" else ""
            )
            lines.append(
                f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
                f'variability="{variability if kind == "Real" else "fixed"}"><{kind}{inner}/></ScalarVariable>'
            )
        head = f'fmiVersion="2.0" modelName="pd" guid="{known_as}"'
        structure = '<Outputs><Unknown index="3"/><Unknown index="7"/></Outputs>'
    else:
        attributes = f'canGetAndSetFMUState="{yes}" canSerializeFMUState="{yes}" {step}'
        lines = ['<Float64 name="time" valueReference="9" causality="independent" variability="continuous"/>']
        for name, reference, kind, causality, variability, unit, start in rows:
            word = {"Real": "Float64", "Integer": "Int32", "String": "String"}[kind]
            inner = (f' unit="{unit}"' if unit else "") + (
                f' start="{start}"' if causality != "output" and kind != "String" else ""
            )
            content = '<Start value=""/>' if kind == "String" else ""
            lines.append(
                f'<{word} name="{name}" valueReference="{reference}" causality="{causality}" '
                f'variability="{variability}"{inner}>{content}</{word}>'
            )
        head = f'fmiVersion="3.0" modelName="pd" instantiationToken="{known_as}"'
        structure = '<Output valueReference="2"/><Output valueReference="6"/>'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {head}>'
        f'<{interface} modelIdentifier="{identifier}" {attributes}>{listed}</{interface}>'
        f'<UnitDefinitions>{units}<Unit name="km"/><Unit name="lift"/></UnitDefinitions>'
        f"<ModelVariables>{''.join(lines)}</ModelVariables>"
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )


def make_fmu(path, version, binary, **changes):
    """Write an .fmu with the controller; `binary` is its library, `changes` are those of `description`."""
    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description(version, **changes))
        archive.write(binary, f"binaries/{platform}/{changes.get('identifier', 'pd')}.so")
    return path
