"""The index of the theses in the docs is what docstrings and cases say, and everything that it names is there."""

from __future__ import annotations

import re

from where import ROOT, SECTIONS, cited, table

PAGE = ROOT / "docs" / "where.md"


def test_the_page_is_that_of_the_sources():
    assert PAGE.read_text(encoding="utf-8") == table(), "python tests/docs/where.py"


def test_every_link_leads_to_a_file_or_case():
    links = re.findall(r"\]\(\.\./([^)]+)\)", PAGE.read_text(encoding="utf-8"))
    assert len(links) > 80
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_citations_are_understood():
    assert cited('"Integrated simulation ... (2018)", eqs. 163-164.') == {("2018", "2.4.1")}
    assert cited('"Integrated simulation ... (2018)", eqs. 181-185 and 219 for the path') == {
        ("2018", "2.4.7"),
        ("2018", "2.7.2"),
    }
    assert cited("Integrated simulation ... (2018), section 3.3.3, Tables 3-18") == {("2018", "3.3.3")}
    assert cited('"Deformable bodies ..." (2014), eqs. 2.66-2.79') == {("2014", "2.4")}
    assert cited("Eq. 49 of the 2018 thesis without joints") == {("2018", "2.1.6")}
    assert cited("a paper (2018), section 3 of nothing") <= {("2018", "3.1.1")}


def test_sections_stand_in_order():
    for sections in SECTIONS.values():
        assert [first for _, _, first in sections] == sorted(first for _, _, first in sections)
        assert len({number for number, _, _ in sections}) == len(sections)
