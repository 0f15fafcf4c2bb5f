"""Files of other programs that are not read here: whose they are by their ending, and what makes one that is read."""

from __future__ import annotations

from pathlib import PurePath

__all__ = ["converter_words"]

_MESHIO = "`meshio convert FILE FILE.vtu` writes a mesh that is read"
_STEP = "save it there as STEP (.step)"
_WAMIT = "BEMRosetta reads it and writes WAMIT files (.1, .3, .hst)"

FOREIGN = {
    # wave databases
    (".ah1", ".lis"): ("AQWA or Wadam", _WAMIT),
    (".qtf", ".hyd"): ("AQWA or HydroStar", _WAMIT),
    (".cal", ".tec"): ("Nemoh", f"{_WAMIT}, bemio a .h5"),
    (".owd", ".owr"): ("OrcaWave", "save its results there as WAMIT files (.1, .3, .hst)"),
    (".sim", ".yml", ".yaml"): ("OrcaFlex or OrcaWave", _WAMIT),
    (".sif", ".fem1", ".g1"): ("Sesam", "HydroD writes WAMIT files; GeniE saves a mesh as STEP or Nastran (.bdf)"),
    (".mat",): ("MATLAB", "bemio or WEC-Sim writes .h5; a spreadsheet or script columns with commas"),
    (".gdf", ".pnl", ".mar"): ("WAMIT, HAMS or Nemoh", "meshmagick or BEMRosetta writes the panels as .stl"),
    # geometry
    (".dwg", ".dxf"): ("AutoCAD", f"{_STEP}, or as .stl"),
    (".sldprt", ".sldasm"): ("SolidWorks", _STEP),
    (".ipt", ".iam"): ("Inventor", _STEP),
    (".catpart", ".catproduct"): ("CATIA", _STEP),
    (".prt", ".asm", ".par"): ("NX, Creo or Solid Edge", _STEP),
    (".x_t", ".x_b", ".xmt_txt", ".sat", ".sab", ".jt"): ("Parasolid, ACIS or JT", f"{_STEP} by any CAD program"),
    (".fcstd",): ("FreeCAD", _STEP),
    (".3dm",): ("Rhino", f"{_STEP}, or as .stl"),
    (".skp", ".blend", ".3ds", ".dae", ".fbx", ".glb", ".gltf", ".3mf", ".wrl"): (
        "a modeller of surfaces",
        "Blender, MeshLab or `trimesh` saves it as .stl or .ply",
    ),
    (".ifc",): ("a building model", "IfcConvert (IfcOpenShell) writes STEP or .obj"),
    # meshes and decks
    (".rst", ".db", ".mechdat"): ("ANSYS", "CDWRITE writes an archive (.cdb) that is read"),
    (".odb", ".cae", ".fil", ".sim"): ("Abaqus", "the deck of the job (.inp) is read"),
    (".frd", ".cvg", ".sta"): ("CalculiX", "the deck of the job (.inp) is read"),
    (".op2", ".f06", ".xdb", ".h3d"): ("Nastran or OptiStruct", "the deck of the job (.bdf, .fem) is read"),
    (".k", ".key", ".dyn"): ("LS-DYNA", "LS-PrePost writes Nastran (.bdf) or .stl"),
    (".cgns",): ("CGNS", "`gmsh FILE -save -o FILE.msh` writes a mesh that is read"),
    (".mail", ".comm"): ("Code_Aster", "save the mesh as .med"),
    (
        ".e", ".exo", ".ex2", ".mesh", ".meshb", ".off", ".su2", ".ugrid", ".vol", ".h5m", ".mdpa", ".post", ".dato",
        ".avs", ".ele", ".node", ".vtp",
    ): ("another mesher", _MESHIO),
    (".mphtxt", ".mphbin", ".mph"): ("COMSOL", "save the mesh there as Nastran (.nas) or .stl"),
}  # fmt: skip
"""Program and converter by endings."""


def converter_words(file: str | PurePath) -> str:
    """What makes a file that is read of one that is not, with a semicolon before it; ``""`` of an unknown ending."""
    suffix = PurePath(file).suffix.lower()
    for endings, (program, how) in FOREIGN.items():
        if suffix in endings:
            return f"; {suffix} is a file of {program}: {how}"
    return ""
