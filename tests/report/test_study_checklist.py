"""The reporting checklist of a study: each entry is what its trials and tables say; what nobody knows is marked."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest
from plain_pages import plain

from elbowscrew.report.checklist import MISSING, common_of
from elbowscrew.report.facts import SummaryFacts
from elbowscrew.report.study import Failure, Study, read_study
from elbowscrew.report.study_page import study_page
from elbowscrew.results.trial_views import view_of_result

UNKNOWN = {
    "Participants (age, sex, health) and ethics approval",
    "How the number of subjects was chosen",
    "Criteria of inclusion and exclusion",
    "Trials left out, and why",
    "Order of the conditions, randomization and blinding",
    "Task, instructions, load and speed",
    "Measuring system, its calibration and accuracy",
    "Where recordings and results can be had",
    "Soft-tissue motion",
    # Of recordings that come from no file and of no side:
    "Format of the files",
    "Side",
}


@pytest.fixture(scope="module")
def read(study: Path) -> Study:
    return read_study(study)


def entries(study: Study) -> dict[str, str]:
    """What the page's checklist says."""
    page = plain(study_page(study))
    inside = page[page.index('id="h-checklist"') : page.index("<footer")]
    rows = re.findall(r'<tr><th scope="row">(.*?)</th><td>(.*?)</td></tr>', inside)
    assert f"{sum(MISSING not in text for _, text in rows)} of {len(rows)} entries are filled in" in inside
    return {unescape(title): unescape(re.sub(r"<[^>]+>", "", text)) for title, text in rows}


def crossed(study: Study) -> Study:
    """Six subjects with three trials each, of which one is under the other condition."""
    trials = [
        replace(trial, factors={"subject": f"p{k // 3}", "condition": "slow" if k % 3 else "fast"})
        for k, trial in enumerate(study.trials)
    ]
    return replace(study, trials=tuple(trials))


def test_entries_are_what_the_study_holds(read: Study) -> None:
    said = entries(read)
    assert {title for title, text in said.items() if text == MISSING} == UNKNOWN
    assert said["Subjects"] == "2, with 9 trials each"
    assert said["Trials"] == "18 analyzed"
    assert said["Failures"] == "2 of 20 trials failed and are in no number (RecordingError 1, OSError 1)"
    assert said["Conditions"] == "condition: fast (9 trials of 1 subject), slow (9 trials of 1 subject)"
    assert said["Design"] == "between subjects: none has trials under two conditions"
    assert said["Comparison of conditions"] == "none: no subject has trials under two conditions"
    assert said["Multiple comparisons"] == "no comparisons were made"
    assert said["Bands of the curves"] == "none: fewer than 6 subjects"
    assert said["Reliability"].startswith("no ICC: ")
    assert re.match(r"\d+ trials? flagged by \d+ tests?, none left out; ", said["Outliers"])
    assert said["Sampling rate"] == "100 Hz"
    assert said["Settings"] == "the same for all trials"


def test_the_design_within_subjects_is_told(read: Study) -> None:
    said = entries(crossed(read))
    assert said["Subjects"] == "6, with 3 trials each"
    assert said["Conditions"] == "condition: fast (6 trials of 6 subjects), slow (12 trials of 6 subjects)"
    assert said["Design"] == "6 of 6 subjects have trials under all 2 conditions"
    assert said["Comparison of conditions"].startswith("paired by subject (6 pairs), ")
    assert said["Bands of the curves"].endswith("(2000 resamples, seed 2010)")
    assert said["Reliability"].startswith("ICC(1,1), one-way random effects, absolute agreement, single trial, ")
    one = crossed(read).trials
    some = replace(
        read, trials=(*one[:15], *(replace(k, factors={**k.factors, "condition": "slow"}) for k in one[15:]))
    )
    assert entries(some)["Design"] == "5 of 6 subjects have trials under all 2 conditions, 1 under one alone"


def test_nothing_is_claimed_without_subjects(read: Study) -> None:
    bare = replace(read, trials=tuple(replace(trial, factors={}) for trial in read.trials[:3]), factors=(), failures=())
    said = entries(bare)
    assert {title for title, text in said.items() if text == MISSING} == {*UNKNOWN, "Subjects", "Conditions", "Design"}
    assert said["Failures"] == "none"
    assert said["Means and intervals"].startswith("median and quartiles of the trials; no subject is named")
    assert said["Reliability"] == "no ICC: no subject is named"
    assert said["Outliers"].startswith("not looked for: too few trials")


def test_what_differs_between_trials_is_counted(read: Study) -> None:
    first, *others = read.trials
    reported = {**first.reported, "Filter": "none at all", "Soft-tissue motion": "stated"}
    settings = json.dumps({**json.loads(first.settings), "max_gap_s": 0.7})
    said = entries(replace(read, trials=(replace(first, reported=reported, settings=settings), *others)))
    usual = others[0].reported["Filter"]
    assert said["Filter"] == f"differs: {usual} (17 trials); none at all (1 trial)"
    assert said["Soft-tissue motion"] == "differs: not known (17 trials); stated (1 trial)"
    assert said["Settings"] == "differing between trials: max_gap_s"


def test_a_trial_tells_its_study_what_its_own_page_tells(study: Path, read: Study) -> None:
    view = view_of_result(study / "trial 0")
    assert common_of(view) == common_of(SummaryFacts(view.summary, view.settings))
    (trial,) = (one for one in read.trials if one.folder == "trial 0")
    assert trial.reported == common_of(view)


def test_of_thousands_of_failures_some_are_shown_and_all_counted(read: Study) -> None:
    many = [Failure(path=f"t{k}.csv", kind="RecordingError", message="empty") for k in range(3000)]
    page = study_page(replace(read, failures=tuple(many)), ["failures.csv"])
    assert "3000 failed" in page
    assert len(re.findall(r'<th scope="row">t\d+\.csv</th>', page)) == 200
    assert '200 of 3000 failures are shown; all that the batch told stand in <a href="failures.csv">' in page


def test_a_number_and_its_percent_sign_stay_in_one_line(read: Study) -> None:
    page = study_page(crossed(read))
    words = re.sub(r"<style>.*?</style>|<script.*?</script>", "", page, flags=re.S)
    headings = re.findall(r"<th scope=\"col\"[^>]*>([^<]*95[^<]*)</th>", words)
    assert len(headings) == 4
    assert all("95\N{NO-BREAK SPACE}%" in unescape(heading) for heading in headings)
