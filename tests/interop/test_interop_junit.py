"""JUnit XML: it parses, its counts agree with its cases, and nothing a program says can break it."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import pytest

from rigsim.interop.files.junit import junit_bytes
from rigsim.present.verify import words
from rigsim.study.verify.result import VerifyResult
from tests.helpers.verify_results import DIAGNOSES, breaks_on_far, result_of, right, swapped, wasteful

ALL = (right, swapped, wasteful, breaks_on_far)
# the children of a testcase, and those of a testsuite, in the order of the schema that Jenkins reads
SUITE_ORDER = ["properties", "testcase", "system-out"]
CASE_ORDER = ["skipped", "error", "failure", "system-out"]


def parsed(result: VerifyResult, strict: bool = False) -> ElementTree.Element:
    return ElementTree.fromstring(junit_bytes(result, words, strict))


@pytest.mark.parametrize("strict", [False, True])
def test_the_counts_agree_with_the_cases(strict: bool) -> None:
    root = parsed(result_of(*ALL), strict)
    assert [suite.get("name") for suite in root] == [one.__name__ for one in ALL]
    failures = [0, 7, 2 if strict else 0, 0]
    errors = [0, 0, 0, 1]
    for suite, n_failed, n_errors in zip(root, failures, errors, strict=True):
        assert suite.tag == "testsuite"
        assert suite.get("tests") == str(len(suite.findall("testcase"))) == "8"
        assert suite.get("failures") == str(len(suite.findall("testcase/failure"))) == str(n_failed)
        assert suite.get("errors") == str(len(suite.findall("testcase/error"))) == str(n_errors)
        assert suite.get("skipped") == str(len(suite.findall("testcase/skipped"))) == "0"
    assert root.get("tests") == "32"
    assert root.get("failures") == str(sum(failures))
    assert root.get("errors") == "1"


def test_the_order_is_the_schemas() -> None:
    result = result_of(swapped)
    diagnosed = replace(result, triangulators=(replace(result.triangulators[0], diagnoses=DIAGNOSES),))
    (suite,) = parsed(diagnosed)
    tags = [child.tag for child in suite]
    assert tags == sorted(tags, key=SUITE_ORDER.index)
    assert "swapped-images" in (suite.findtext("system-out") or "")
    for case in suite.iter("testcase"):
        assert {"name", "classname", "time"} == set(case.keys())
        assert float(case.get("time", "nan")) >= 0
        inside = [child.tag for child in case]
        assert inside == sorted(inside, key=CASE_ORDER.index)
    assert len({(case.get("classname"), case.get("name")) for case in suite.iter("testcase")}) == 8


def test_a_failure_says_what_was_found_and_allowed_and_why() -> None:
    (suite,) = parsed(result_of(swapped))
    case = next(case for case in suite.iter("testcase") if case.get("name") == "verged exact")
    (failure,) = case
    assert failure.get("type") == "exact"
    assert " off, allowed at most 1.00 nm" in (failure.get("message") or "")
    assert "toe in by 20 deg" in (failure.text or "")
    assert "Largest distance to the true point" in (failure.text or "")


def test_not_applicable_is_skipped() -> None:
    result = result_of(right)
    one = result.triangulators[0]
    skipped = replace(one.results[0], not_applicable="the rig is not rectified")
    (suite,) = parsed(replace(result, triangulators=(replace(one, results=(skipped, *one.results[1:])),)))
    assert suite.get("skipped") == "1"
    assert suite.find("testcase/skipped[@message='the rig is not rectified']") is not None


def test_what_a_program_says_cannot_break_it() -> None:
    (suite,) = parsed(result_of(breaks_on_far))
    (error,) = suite.iter("error")
    assert error.get("message") == "it broke <?&>"
