"""A verification as a document; docs/reference/verify.md says what each key means."""

from __future__ import annotations

import math
from typing import Any

from rigsim.rig.arrays import Array
from rigsim.study.verify.golden import VERDICTS, GoldenReport
from rigsim.study.verify.result import CaseResult, Check, Status, TriangulatorResult, VerifyResult
from rigsim.study.verify.runner import FALSE_ALARM
from rigsim.study.verify.worst import WorstRow, worst_rows

_STATUSES: tuple[Status, ...] = ("passed", "inefficient", "failed", "error", "not applicable")


def verify_document(
    result: VerifyResult, strict: bool = False, golden: GoldenReport | None = None
) -> dict[str, Any]:
    """The verification with stable keys and units in their names; null where there is no number.

    Args:
        result: the verification.
        strict: whether efficiency counts.
        golden: how it compares with golden results; None when it was not asked.
    """
    return {
        "passed": result.passed(strict) and (golden is None or golden.passed),
        "strict": strict,
        "suite": result.suite,
        "seed": result.seed,
        "false_alarm": FALSE_ALARM,
        "triangulators": [_triangulator(one, strict) for one in result.triangulators],
        "left_out": list(result.left_out),
        "golden": None if golden is None else _golden(golden),
        "provenance": dict(result.provenance),
    }


def _golden(golden: GoldenReport) -> dict[str, Any]:
    comparison = golden.comparison
    return {
        "folder": golden.folder,
        "passed": golden.passed,
        "counts": {name.replace(" ", "_"): comparison.count(name) for name in VERDICTS},
        "moves": [
            {
                "record": move.record,
                "number": move.number,
                "unit": move.unit,
                "before": _finite(move.before),
                "now": _finite(move.now),
                "bound": _finite(move.bound),
                "verdict": move.verdict,
            }
            for move in comparison.moves
            if move.verdict != "same"
        ],
        "remarks": list(comparison.remarks),
        "troubles": list(golden.troubles),
    }


def _triangulator(result: TriangulatorResult, strict: bool) -> dict[str, Any]:
    status = [case.status(strict) for case in result.results]
    return {
        "triangulator": result.triangulator,
        "passed": result.passed(strict),
        "counts": {name.replace(" ", "_"): status.count(name) for name in _STATUSES},
        "seconds": sum(case.seconds for case in result.results),
        "diagnoses": [
            {
                "mistake": one.mistake,
                "says": one.says,
                "explained": _finite(one.explained),
                "cases": list(one.cases),
            }
            for one in result.diagnoses
        ],
        "cases": [_case(case, strict) for case in result.results],
    }


def _case(result: CaseResult, strict: bool) -> dict[str, Any]:
    case, status = result.case, result.status(strict)
    return {
        "case": case.name,
        "group": case.group,
        "kind": case.kind,
        "about": case.about,
        "rows": len(case),
        "status": status,
        "error": result.error or None,
        "not_applicable": result.not_applicable or None,
        "seconds": result.seconds,
        "efficiency": _finite(result.efficiency),
        "depth_rms_mm": _finite(result.depth_rms_m * 1e3),
        "predicted_depth_rms_mm": _finite(result.predicted_depth_rms_m * 1e3),
        "notes": list(result.notes),
        "checks": [_check(check) for check in result.checks],
        "worst_rows": [_row(row) for row in worst_rows(result)] if status == "failed" else [],
    }


def _check(check: Check) -> dict[str, Any]:
    return {
        "check": check.name,
        "ok": check.ok,
        "value": _finite(check.value),
        "low": _finite(check.low),
        "high": _finite(check.high),
        "unit": check.unit,
        "only_strict": check.only_strict,
        "why": check.why,
    }


def _row(row: WorstRow) -> dict[str, Any]:
    return {
        "row": row.row,
        "uv_left_px": _list(row.uv_left),
        "uv_right_px": _list(row.uv_right),
        "expected_m": _list(row.expected_left),
        "found_m": _list(row.found_left),
        "distance_m": _finite(row.distance_m),
    }


def _list(values: Array) -> list[float | None]:
    return [_finite(float(value)) for value in values]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
