"""One table of all mistakes, and how a diagnosis is said."""

from __future__ import annotations

from rigsim.present.kit.mistakes.of_answer import ANSWER
from rigsim.present.kit.mistakes.of_cameras import CAMERAS
from rigsim.present.kit.mistakes.of_distortion import DISTORTION
from rigsim.present.kit.mistakes.of_fitted import FITTED
from rigsim.present.kit.mistakes.of_lens import PIXELS
from rigsim.present.kit.mistakes.of_numbers import NUMBERS
from rigsim.present.kit.mistakes.of_pose import POSE
from rigsim.present.kit.mistakes.of_rigs import CONDITIONS, UNKNOWN
from rigsim.present.kit.mistakes.of_symptoms import ROWS, SYMPTOMS
from rigsim.present.kit.sayings import Sentences, spoken
from rigsim.study.saying import Saying
from rigsim.study.verify.result import Diagnosis

MISTAKES: Sentences = {
    **CAMERAS,
    **POSE,
    **PIXELS,
    **NUMBERS,
    **DISTORTION,
    **ANSWER,
    **FITTED,
    **SYMPTOMS,
    **ROWS,
    **UNKNOWN,
    **CONDITIONS,
}
"""The sentence of every mistake: what it is, and what to look for in the code."""


def in_words(said: Saying) -> str:
    """What a mistake is, one sentence."""
    return spoken(said, MISTAKES).strip()


def says(found: Diagnosis) -> str:
    """What a mistake is and which rigs bring it out, one sentence."""
    said = in_words(found.said)
    return said if found.only is None else f"{said.removesuffix('.')}; {in_words(found.only)}."
