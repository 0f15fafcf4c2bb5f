"""What an .fmu says of itself, and what a case may say of it: refused before anything of it runs."""

import re
import stat
import zipfile

import pytest
from made_fmus import SOURCE, description, fmpy, library, make_fmu

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.fmus import FmuSection
from heavylift.pipeline.coupling.fmu_file import read_fmu, unit_factor
from heavylift.pipeline.coupling.fmu_process import FmuError, FmuProcess
from heavylift.pipeline.coupling.fmus import check_fmu


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fmus")


@pytest.mark.parametrize("version", [2, 3])
def test_a_description_is_read(folder, version):
    fmu = read_fmu(make_fmu(folder / f"pd{version}.fmu", version, library(folder, version)))
    assert (fmu.version, fmu.identifier, fmu.token) == (version, "pd", "pd")
    assert fmu.gets_state
    assert fmu.serializes
    force = fmu.variables["force"]
    assert (force.causality, force.reference, force.unit.name) == ("output", 2, "N")
    read_only = make_fmu(folder / "still.fmu", version, library(folder, version), state=False)
    assert not read_fmu(read_only).gets_state


@pytest.mark.parametrize(
    ("theirs", "ours", "factor"),
    [("kN", "N", 1e-3), ("N", "N", 1.0), ("N", "kN", 1e3), ("km", "m", 1e-3), ("", "m", 1.0)],
)
def test_units_are_converted(folder, theirs, ours, factor):
    fmu = read_fmu(make_fmu(folder / "units.fmu", 2, library(folder, 2), force=theirs))
    assert unit_factor(fmu.variables["force"], ours) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("theirs", "ours", "words"),
    [
        ("N.m", "N", r"'force' is in N.m, a moment or energy; expected a force \[N\]"),
        ("kN", "m", r"'force' is in kN, a force; expected a length \[m\]"),
        ("lift", "N", r"unit 'lift', which its description does not define; expected a BaseUnit"),
    ],
)
def test_units_that_do_not_fit_are_refused(folder, theirs, ours, words):
    fmu = read_fmu(make_fmu(folder / "units.fmu", 2, library(folder, 2), force=theirs))
    with pytest.raises(InputError, match=words):
        unit_factor(fmu.variables["force"], ours)


def _archive(path, *entries, **changes):
    """A zip of names and contents, with a description."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description(2, **changes))
        for name, content in entries:
            archive.writestr(name, content)
    return path


def _link(name):
    entry = zipfile.ZipInfo(name)
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    return entry


PLATFORM = f"binaries/{fmpy.platform}"

BAD = {
    "up": (
        ("resources/../../evil.txt", "x"),
        r"resources/../../evil.txt: would be unpacked outside of its folder",
    ),
    "root": (("/etc/evil.txt", "x"), "/etc/evil.txt: would be unpacked outside"),
    "back": (("resources\\..\\evil.txt", "x"), "would be unpacked outside"),
    "link": ((_link("resources/link"), "/etc/passwd"), "resources/link: is a link or a device"),
    "machine": (
        ("binaries/win16/pd.dll", "x"),
        f"has binaries for win16; expected one for this machine, in {PLATFORM}",
    ),
    "sources": (("sources/pd.c", "x"), "has sources that its description does not list"),
    "name": ((f"{PLATFORM}/other.so", "x"), f"{PLATFORM}/pd.so: is missing"),
}


@pytest.mark.parametrize("case", BAD)
def test_an_archive_that_is_none_of_an_fmu_is_refused(tmp_path, case):
    entry, words = BAD[case]
    path = _archive(tmp_path / "bad.fmu", entry)
    with pytest.raises(InputError, match=re.escape(words).replace(re.escape("\\"), ".")):
        read_fmu(path)
    assert not (tmp_path.parent / "evil.txt").exists()


@pytest.mark.parametrize(
    ("encoding", "bom", "words"),
    [
        ("utf-8", b"", "defines entities"),
        ("utf-8", b"\xef\xbb\xbf", "defines entities"),
        ("iso-8859-1", b"", "defines entities"),
        ("utf-16", b"", "is not in UTF-8"),
        ("utf-7", b"", "is not in UTF-8"),
        ("cp037", b"", "is not in UTF-8"),
    ],
)
def test_a_description_that_names_other_files_is_refused_however_it_is_written(
    tmp_path, encoding, bom, words
):
    (tmp_path / "secret").write_text("secret")
    text = description(2).replace("UTF-8", encoding)
    entity = f"<!DOCTYPE fmi [<!ENTITY x SYSTEM '{(tmp_path / 'secret').as_uri()}'>]><fmiModelDescription"
    text = text.replace("<fmiModelDescription", entity, 1).replace('modelName="pd"', 'modelName="&x;"')
    data = text.encode(encoding)
    if encoding == "utf-7":
        data = data.replace(b"<!", b"+ADwAIQ-")
    with zipfile.ZipFile(tmp_path / "bad.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", bom + data)
    with pytest.raises(InputError, match=words):
        read_fmu(tmp_path / "bad.fmu")


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "bad.fmu"
    path.write_bytes(b"PK\x03\x04 nothing")
    with pytest.raises(InputError, match="is no zip file that can be read"):
        read_fmu(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "x")
    with pytest.raises(InputError, match=r"has no modelDescription\.xml"):
        read_fmu(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription fmiVersion='2.0'>")
    with pytest.raises(
        InputError, match=r"modelDescription.xml: .*expected a description as the FMI standard has it"
    ):
        read_fmu(path)
    with pytest.raises(InputError, match="has model exchange only; expected co-simulation"):
        read_fmu(_archive(path, interface="ModelExchange"))
    with pytest.raises(InputError, match=r"model identifier '\.\./pd'; expected letters"):
        read_fmu(_archive(path, identifier="../pd"))


def _section(**changes):
    given = {
        "name": "pd",
        "file": "pd.fmu",
        "sample_time": 0.1,
        "reads": {"x": "module.position.x"},
        "writes": {"force": "push"},
        "parameters": {"stiffness": 1e4, "fault": 0, "place": "bilge"},
    }
    return FmuSection.model_validate(given | changes)


WRONG = {
    "no variable": ({"reads": {"y": "a.b"}}, r"reads.y: pd.fmu has no variable 'y'.*expected one of: x, v"),
    "near": ({"writes": {"forse": "push"}}, r"writes.forse: .*did you mean 'force'"),
    "causality": (
        {"reads": {"force": "a.b"}},
        r"reads.force: 'force' is of causality output; expected input: one of: x, v",
    ),
    "type of a parameter": (
        {"parameters": {"fault": 0.5}},
        r"parameters.fault: 0.5 for 'fault' of type Integer; expected an integer",
    ),
    "truth for a number": (
        {"parameters": {"limit": True}},
        r"parameters.limit: True for 'limit' of type Real; expected a number",
    ),
    "no parameter": (
        {"parameters": {"x": 0.5}},
        r"parameters.x: 'x' is of causality input; expected parameter",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_a_case_says_must_fit(folder, case):
    make_fmu(folder / "pd.fmu", 2, library(folder, 2))
    check_fmu(_section(), folder)
    changes, words = WRONG[case]
    with pytest.raises(InputError, match=words):
        check_fmu(_section(**changes), folder)


def test_a_step_and_a_coupling_that_it_cannot_do_are_refused(folder):
    make_fmu(folder / "fixed.fmu", 3, library(folder, 3), state=False, step='fixedInternalStepSize="0.03"')
    with pytest.raises(
        InputError,
        match=r"sample_time: 0.1 s is 3.33333333 times the fixed step of fixed.fmu; expected a multiple of 0.03 s",
    ):
        check_fmu(_section(file="fixed.fmu"), folder)
    check_fmu(_section(file="fixed.fmu", sample_time=0.09), folder)
    with pytest.raises(
        InputError, match=r"coupling: 'iterated' with fixed.fmu, which cannot get and set its state"
    ):
        check_fmu(_section(file="fixed.fmu", sample_time=0.09, coupling="iterated"), folder)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("packed", [True, False])
def test_an_fmu_of_sources_is_compiled(tmp_path, version, packed, monkeypatch):
    text = description(version, sources=True)
    files = {"modelDescription.xml": text, "sources/pd.c": SOURCE.read_text(encoding="utf-8")}
    if version == 3:
        files["sources/buildDescription.xml"] = (
            '<?xml version="1.0" encoding="UTF-8"?><fmiBuildDescription fmiVersion="3.0"><BuildConfiguration '
            'modelIdentifier="pd"><SourceFileSet language="C99"><SourceFile name="pd.c"/><PreprocessorDefinition '
            'name="FMI" value="3"/></SourceFileSet></BuildConfiguration></fmiBuildDescription>'
        )
    else:
        files["sources/pd.c"] = "#define FMI 2\n" + files["sources/pd.c"]
    path = tmp_path / "pd.fmu"
    if packed:
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in files.items():
                archive.writestr(name, content)
    else:
        for name, content in files.items():
            (tmp_path / "pd" / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / "pd" / name).write_text(content, encoding="utf-8")
        path = tmp_path / "pd" / "modelDescription.xml"
    made = FmuProcess(read_fmu(path), "pd", ("x", "v"), ("force",), {"stiffness": 1e3}, 20.0)
    made.start({"x": 0.5, "v": 0.0})
    assert made.outputs() == {"force": -500.0}
    made.close()
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(InputError, match="no C compiler 'no-such-compiler' is found"):
        read_fmu(path)
    monkeypatch.setenv("CC", "false")
    with pytest.raises(FmuError, match=r"FMU 'pd' \(pd.*\): false does not compile the library"):
        FmuProcess(read_fmu(path), "pd", ("x",), ("force",), {}, 20.0)


def test_an_unpacked_fmu_has_no_files_of_others(tmp_path):
    folder = tmp_path / "pd"
    (folder / "sources").mkdir(parents=True)
    (folder / "modelDescription.xml").write_text(description(2, sources=True))
    with pytest.raises(
        InputError, match=r"sources/pd.c: is missing; expected a source that the description lists"
    ):
        read_fmu(folder / "modelDescription.xml")
    (folder / "sources" / "pd.c").symlink_to("/etc/passwd")
    with pytest.raises(InputError, match="leads out of the folder of the FMU"):
        read_fmu(folder / "modelDescription.xml")
