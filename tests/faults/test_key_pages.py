"""Pages of keys are written into a folder, with `--tables` alone."""

import pytest

from heavylift.pipeline.case.schema import key_pages


@pytest.mark.slow
def test_pages_are_written_with_tables_alone(tmp_path, heavylift):
    assert heavylift("schema", "--tables", "--out", tmp_path / "keys").code == 0
    assert (tmp_path / "keys" / "README.md").read_text("utf-8") == key_pages()["README.md"]
    (tmp_path / "file").write_text("")
    for words in (("--out", tmp_path / "x"), ("ropes", "--tables", "--out", tmp_path / "x")):
        run = heavylift("schema", *words)
        assert run.code == 2
        assert "--out" in run.error
    assert heavylift("schema", "--tables", "--out", tmp_path / "file").code == 2
