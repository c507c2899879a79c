"""A verification as JUnit XML, the report that continuous integration reads.

One testsuite a triangulator, one testcase a case, in the order and with the attributes of the schema
that Jenkins and GitLab read.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Protocol
from xml.etree import ElementTree

from rigsim.study.verify.case import Case
from rigsim.study.verify.result import CaseResult, Check, Diagnosis, TriangulatorResult, VerifyResult

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Words(Protocol):
    """The sentences of the report, made by whoever calls: `rigsim.present.verify.words` has them."""

    def reason(self, result: CaseResult, strict: bool) -> str:
        """Why a case failed, one line."""

    def about(self, what: Case) -> str:
        """What a case shows."""

    def why(self, check: Check) -> str:
        """Where the bounds of a check come from."""

    def diagnoses(self, found: Sequence[Diagnosis]) -> Sequence[str]:
        """What the failures look like, best first."""


def junit_bytes(result: VerifyResult, words: Words, strict: bool = False) -> bytes:
    """The verification as an XML document in UTF-8."""
    root = ElementTree.Element("testsuites")
    for one in result.triangulators:
        root.append(_suite(one, result, words, strict))
    for name in ("tests", "failures", "errors", "skipped"):
        root.set(name, str(sum(int(suite.get(name, "0")) for suite in root)))
    root.set("time", f"{sum(float(suite.get('time', '0')) for suite in root):.6f}")
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _suite(one: TriangulatorResult, result: VerifyResult, words: Words, strict: bool) -> ElementTree.Element:
    status = [case.status(strict) for case in one.results]
    suite = ElementTree.Element(
        "testsuite",
        {
            "name": _clean(one.triangulator),
            "tests": str(len(status)),
            "failures": str(status.count("failed")),
            "errors": str(status.count("error")),
            "skipped": str(status.count("not applicable")),
            "time": f"{sum(case.seconds for case in one.results):.6f}",
        },
    )
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in {"suite": result.suite, "seed": result.seed, **result.provenance}.items():
        ElementTree.SubElement(properties, "property", {"name": name, "value": _clean(str(value))})
    for case in one.results:
        suite.append(_case(case, words, strict))
    if one.diagnoses:
        ElementTree.SubElement(suite, "system-out").text = _clean("\n".join(words.diagnoses(one.diagnoses)))
    return suite


def _case(result: CaseResult, words: Words, strict: bool) -> ElementTree.Element:
    element = ElementTree.Element(
        "testcase",
        {
            "name": _clean(result.case.name),
            "classname": _clean(f"rigsim.verify.{result.case.group}"),
            "time": f"{result.seconds:.6f}",
        },
    )
    status, why = result.status(strict), _clean(words.reason(result, strict))
    if status == "not applicable":
        ElementTree.SubElement(element, "skipped", {"message": _clean(result.not_applicable)})
    elif status == "error":
        ElementTree.SubElement(element, "error", {"message": why, "type": "error"}).text = why
    elif status == "failed":
        bad = result.failures(strict)
        says = [words.about(result.case), *(f"{check.name}: {words.why(check)}" for check in bad)]
        failure = ElementTree.SubElement(element, "failure", {"message": why, "type": bad[0].name})
        failure.text = _clean("\n".join([why, *says]))
    if result.notes:
        ElementTree.SubElement(element, "system-out").text = _clean("\n".join(result.notes))
    return element


def _clean(text: str) -> str:
    """Text without the characters that XML cannot hold."""
    return _NOT_XML.sub("?", text)
