"""The report stage: pictures, plots and tables of what the other stages have written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.numerics.outcome import Outcome
from heavylift.numerics.side_by_side import cpu_seconds
from heavylift.pipeline.results.provenance import report_digest, source_digest, versions
from heavylift.pipeline.results.storage import read_json, stored, unchanged, write_json
from heavylift.pipeline.stages.work import StageReport

if TYPE_CHECKING:
    from heavylift.pipeline.report.interactive import JudgedRun
    from heavylift.pipeline.stages.work import Work

__all__ = ["report_stage"]


def report_stage(work: Work) -> StageReport:
    """Write the report, unless all it shows is unchanged."""
    manifest_file = work.folder.manifest("report")
    folder = work.folder.stage("report")
    manifest = read_json(manifest_file) or {}
    digest = report_digest(work.case, work.folder)
    files = manifest.get("files", {})
    verdict = manifest.get("verdict")
    complete = isinstance(verdict, dict) and {"text", "passed"} <= verdict.keys()
    if "report" not in work.force and manifest.get("digest") == digest and files and complete:
        if all(unchanged(folder / name, entry) for name, entry in files.items()):
            work.log.say("report: unchanged, skipped")
            return StageReport(
                "report",
                Outcome.COMPLETED,
                skipped=True,
                cpu_s=manifest["cpu_s"],
                details={"files": files, "verdict": verdict},
            )
        work.log.say("report: files are missing or damaged, written again")
    from heavylift.pipeline.report.report import write_report

    begin = cpu_seconds()
    folder.mkdir(parents=True, exist_ok=True)
    judged: list[JudgedRun] = []
    paths = write_report(work.case, folder, work.folder.root, work.log, tell=judged.append)
    verdict = {"text": judged[0].verdict.text, "passed": judged[0].passed}
    files = {str(path.relative_to(folder)): stored(path) for path in paths}
    cpu_s = cpu_seconds() - begin
    write_json(
        manifest_file,
        {
            "stage": "report",
            "outcome": Outcome.COMPLETED.name.lower(),
            "case": work.case.name,
            "digest": digest,
            "sources_digest": source_digest("report"),
            "versions": versions("report"),
            "cpu_s": cpu_s,
            "verdict": verdict,
            "files": files,
        },
    )
    work.log.say(f"report: {paths[0]} and {len(files) - 1} files beside it; {cpu_s:.2f} s CPU")
    return StageReport(
        "report",
        Outcome.COMPLETED,
        skipped=False,
        cpu_s=cpu_s,
        details={"files": files, "verdict": verdict},
    )
