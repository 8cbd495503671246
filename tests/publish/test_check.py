"""The check sees every kind of difference, and nothing where there is none."""

import dataclasses
import json
import shutil

import pytest

from robins.papers.protocol import Column
from robins.publish import check, tables
from robins.publish.check import CLAIM_TABLE, CLAIMS, compare

KEY = "nobody1999"
TABLE = f"{KEY}/tables/table-1.csv"


@pytest.fixture
def fresh(reference, tmp_path):
    """A copy of the reference, to spoil."""
    return shutil.copytree(reference, tmp_path / "fresh")


@pytest.fixture
def differences(reference, fresh, paper, published):
    """The check of the (spoilt) copy against the reference."""

    def run(**options) -> list[str]:
        return compare(fresh, reference, {KEY: paper}, published, **options).differences

    return run


def spoil(folder, name, change) -> None:
    frame = tables.read_text(folder / name)
    changed = change(frame)
    tables.write_csv(frame if changed is None else changed, folder / name)


def specifications(paper):
    found = {f"{KEY}/tables/{table.name}.csv": table for table in paper.tables}
    return found | {CLAIMS: CLAIM_TABLE}


def test_equal_results_have_no_difference_and_say_what_was_compared(reference, fresh, paper, published):
    outcome = compare(fresh, reference, {KEY: paper}, published, demand_n=True)
    assert outcome.differences == []
    assert outcome.tables == 3
    assert outcome.cells == 6 * 5 + 2 * 2 + 3 * 10
    assert outcome.largest == 0.0


def test_every_cell_changed_by_ten_tolerances_is_seen_and_named(reference, fresh, paper, published):
    changed = 0
    for name, table in specifications(paper).items():
        for column in table.columns:
            for row in range(len(tables.read_text(reference / name))):
                frame = tables.read_text(reference / name)
                cell = frame.loc[row, column.name]
                try:
                    value = float(cell)
                except ValueError:
                    spoilt = cell + "!"
                else:
                    change = 10 * (column.absolute + column.relative * abs(value))
                    spoilt = str(int(value) + 1) if column.kind == "count" else f"{value + change:.17g}"
                frame.loc[row, column.name] = spoilt
                frame.to_csv(fresh / name, index=False)
                found = compare(fresh, reference, {KEY: paper}, published).differences
                assert any(name in line for line in found), (name, column.name, row)
                if column.kind != "key":
                    assert any(column.name in line for line in found), (name, column.name, row)
                changed += 1
        shutil.copyfile(reference / name, fresh / name)
    assert changed == 6 * 7 + 2 * 3 + 3 * 15


def test_a_change_within_the_tolerance_is_measured_but_no_difference(reference, fresh, paper, published):
    spoil(fresh, TABLE, lambda frame: frame.replace({"rmse": {"1.37": "1.3700001"}}))
    outcome = compare(fresh, reference, {KEY: paper}, published)
    assert outcome.differences == []
    assert outcome.largest == pytest.approx(1e-7 / 1.37, rel=1e-6)


@pytest.mark.parametrize("name", [TABLE, f"{KEY}/tables/extra-parameters.csv", CLAIMS])
def test_a_deleted_table_is_missed(name, fresh, differences):
    (fresh / name).unlink()
    assert any(name in line and "no table in the results" in line for line in differences())


@pytest.mark.parametrize("name", [TABLE, f"{KEY}/tables/extra-parameters.csv", CLAIMS])
def test_a_table_deleted_on_both_sides_is_missed(name, reference, fresh, paper, published, tmp_path):
    other = shutil.copytree(reference, tmp_path / "other")
    (fresh / name).unlink()
    (other / name).unlink()
    assert any(name in line for line in compare(fresh, other, {KEY: paper}, published).differences)


def test_a_table_dropped_from_the_registry_is_missed_because_the_paper_prints_it(reference, fresh, paper, published):
    smaller = dataclasses.replace(paper, tables=paper.tables[1:])
    (fresh / TABLE).unlink()
    found = compare(fresh, reference, {KEY: smaller}, published).differences
    assert any("Table 1: found no table of the registry" in line for line in found)
    assert any("only the manifest knows" in line for line in found)


def test_every_deleted_row_is_named(reference, fresh, differences):
    for row, key in enumerate(tables.read_text(reference / TABLE)[["filter", "state"]].itertuples(index=False)):
        shutil.copyfile(reference / TABLE, fresh / TABLE)
        spoil(fresh, TABLE, lambda frame, row=row: frame.drop(index=row))
        assert any(f"({key.filter}, {key.state})" in line and "no such row" in line for line in differences())


def test_every_deleted_column_is_missed(reference, fresh, paper, differences):
    for name, table in specifications(paper).items():
        for column in table.columns:
            spoil(fresh, name, lambda frame, column=column: frame.drop(columns=column.name))
            assert any("columns of the results" in line for line in differences())
            shutil.copyfile(reference / name, fresh / name)


def test_an_extra_column_row_and_table_are_seen(reference, fresh, differences):
    spoil(fresh, TABLE, lambda frame: frame.assign(more="1"))
    assert any("columns" in line for line in differences())
    shutil.copyfile(reference / TABLE, fresh / TABLE)
    spoil(fresh, f"{KEY}/tables/extra-parameters.csv", lambda frame: frame.iloc[[0, 1, 1]].assign(symbol=["tau", "dt", "m"]))
    assert any("an extra row" in line for line in differences())
    shutil.copyfile(reference / TABLE, fresh / KEY / "tables" / "more.csv")
    assert any("undeclared" in line for line in differences())


def test_a_duplicated_row_is_seen_even_on_both_sides(reference, fresh, paper, published, differences, tmp_path):
    spoil(fresh, TABLE, lambda frame: frame.iloc[[0, 0, 1, 2, 3, 4, 5]])
    assert any("duplicate key" in line for line in differences())
    assert any("duplicate key" in line for line in compare(fresh, fresh, {KEY: paper}, published).differences)


@pytest.mark.parametrize("cell", ["nan", "NaN", "inf", "-inf", "", "n/a", "undefined", "Failed"])
def test_what_is_no_finite_number_is_refused_even_on_both_sides(cell, fresh, paper, published):
    spoil(fresh, TABLE, lambda frame: frame.replace({"rmse": {"1": cell}}))
    found = compare(fresh, fresh, {KEY: paper}, published).differences
    assert any("(classical, u), rmse" in line and "a finite number" in line for line in found)


def test_the_word_failed_is_compared_exactly(fresh, differences):
    spoil(fresh, TABLE, lambda frame: frame.replace({"rmse": {"failed": "2.85"}}))
    assert any("found 2.85, expected failed" in line for line in differences())


def test_two_swapped_labels_are_seen(fresh, differences):
    swap = {"filter": {"classical": "differencing", "differencing": "classical"}}
    spoil(fresh, TABLE, lambda frame: frame.replace(swap))
    assert any("(classical, u), rmse" in line for line in differences())


def test_rows_in_another_order_are_seen(fresh, differences):
    spoil(fresh, TABLE, lambda frame: frame.iloc[::-1])
    assert any("another order" in line for line in differences())


def test_a_changed_verdict_is_red_at_equal_n_and_left_to_the_n_otherwise(reference, fresh, differences):
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"verdict": {"refuted": "untestable"}}))
    assert any("verdict: found untestable, expected refuted" in line for line in differences())
    shutil.copyfile(reference / CLAIMS, fresh / CLAIMS)
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"verdict": {"refuted": "untestable"}, "n": {"0": "8"}}))
    found = differences()
    assert not any("verdict" in line for line in found)
    assert any("n: found 8, expected 0" in line for line in found)


def test_a_claim_without_its_overall_row_is_missed_even_on_both_sides(fresh, paper, published):
    spoil(fresh, CLAIMS, lambda frame: frame[frame["claim_id"] != "C2"])
    assert any("C2: found 0 overall rows" in line for line in compare(fresh, fresh, {KEY: paper}, published).differences)


def test_numerals_in_a_reason_may_differ_in_the_last_digit_only(reference, fresh, differences):
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"reason": {"Ratio 0.612 in both branches.": "Ratio 0.6124 in both branches."}}))
    assert differences() == []
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"reason": {"Ratio 0.6124 in both branches.": "Ratio 0.614 in both branches."}}))
    assert any("reason" in line for line in differences())


def test_too_few_runs_are_a_difference_only_where_enough_are_demanded(fresh, paper, published):
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"verdict": {"replicated": "n too small"}}))
    assert compare(fresh, fresh, {KEY: paper}, published).differences == []
    found = compare(fresh, fresh, {KEY: paper}, published, demand_n=True).differences
    assert len(found) == 2 and all("the n that the brief demands" in line for line in found)


@pytest.mark.parametrize("change", [lambda cells: cells + 1, lambda cells: None])
def test_a_wrong_or_missing_recorded_number_of_cells_is_a_difference(change, reference, fresh, paper, published):
    content = json.loads((fresh / "manifest.json").read_text())
    content["artefacts"][TABLE]["cells"] = change(30)
    (fresh / "manifest.json").write_text(json.dumps(content))
    assert any("30 compared" in line for line in compare(reference, fresh, {KEY: paper}, published).differences)


def test_a_missing_manifest_is_a_difference(reference, fresh, paper, published):
    (fresh / "manifest.json").unlink()
    assert any(line.startswith("manifest.json") for line in compare(reference, fresh, {KEY: paper}, published).differences)


def test_comparing_nothing_is_a_difference(tmp_path):
    (tmp_path / "manifest.json").write_text('{"artefacts": {}}')
    assert any("no cell compared" in line for line in compare(tmp_path, tmp_path, {}, {}).differences)


def test_a_paper_needs_published_numbers_and_the_other_way_round(reference, fresh, paper, published):
    assert any("a paper without" in line for line in compare(fresh, reference, {KEY: paper}, {}).differences)
    assert any("without a paper" in line for line in compare(fresh, reference, {}, published).differences)


def test_an_unreadable_file_is_a_difference(fresh, differences):
    (fresh / TABLE).write_bytes(b'filter,state\n"\xff')
    assert any("unreadable" in line for line in differences())


def test_a_wide_tolerance_is_a_difference(reference, fresh, paper, published):
    wide = dataclasses.replace(
        paper.tables[0], columns=(*paper.tables[0].columns[:2], Column("rmse", "number", relative=1e-3), *paper.tables[0].columns[3:])
    )
    found = compare(fresh, reference, {KEY: dataclasses.replace(paper, tables=(wide, paper.tables[1]))}, published).differences
    assert any("relative tolerance 0.001" in line for line in found)


def test_field_tables_are_compared_when_there_and_named_when_skipped(reference, tmp_path):
    for folder in ("fresh", "old"):
        tables.write_csv(tables.read_text(reference / TABLE), tmp_path / folder / "field" / "record" / "noise.csv")
    outcome = check.Comparison()
    assert check.compare_field(tmp_path / "fresh", tmp_path / "old", outcome) == []
    assert outcome.cells == 42 and not outcome.differences
    spoil(tmp_path / "fresh", "field/record/noise.csv", lambda frame: frame.replace({"rmse": {"1": "1.1"}}))
    check.compare_field(tmp_path / "fresh", tmp_path / "old", outcome)
    assert len(outcome.differences) == 1
    tables.write_csv(tables.read_text(reference / TABLE), tmp_path / "fresh" / "field" / "more.csv")
    outcome = check.Comparison()
    check.compare_field(tmp_path / "fresh", tmp_path / "old", outcome)
    assert any(line.startswith("field/more.csv") for line in outcome.differences)
    assert check.compare_field(tmp_path / "none", tmp_path / "old", outcome) == ["record/noise.csv"]


def test_a_field_table_missing_on_either_side_is_a_difference_where_all_are_demanded(reference, tmp_path):
    fresh, old, name = tmp_path / "fresh", tmp_path / "old", "field/record/noise.csv"
    tables.write_csv(tables.read_text(reference / TABLE), fresh / name)

    def differences(results, **options) -> list[str]:
        outcome = check.Comparison()
        check.compare_field(results, old, outcome, **options)
        return outcome.differences

    assert differences(fresh) == []
    assert [line.partition(":")[0] for line in differences(fresh, demand_n=True)] == [name]
    assert differences(tmp_path / "none", demand_n=True) == []
    (old / "field").mkdir(parents=True)
    (old / "field" / "manifest.json").write_text(json.dumps({"artefacts": {"record/noise.csv": {}, "record/noise.png": {}}}))
    assert [line.partition(":")[0] for line in differences(tmp_path / "none", demand_n=True)] == [name]
    shutil.copytree(fresh / "field", old / "field", dirs_exist_ok=True)
    assert differences(fresh, demand_n=True) == []
    (fresh / name).unlink()
    assert ["no table in the results" in line for line in differences(fresh, demand_n=True)] == [True]


def test_whole_numbers_of_field_tables_are_exact_and_an_unreadable_one_is_a_difference(tmp_path):
    for folder, text in (("fresh", "epochs,sd\n10000001,0.50000001\n"), ("old", "epochs,sd\n10000000,0.5\n")):
        (tmp_path / folder / "field").mkdir(parents=True)
        (tmp_path / folder / "field" / "noise.csv").write_text(text)
    outcome = check.Comparison()
    check.compare_field(tmp_path / "fresh", tmp_path / "old", outcome)
    assert ["epochs: found 10000001, expected 10000000" in line for line in outcome.differences] == [True]
    (tmp_path / "fresh" / "field" / "noise.csv").write_text("epochs,sd\n1,2,3\n")
    check.compare_field(tmp_path / "fresh", tmp_path / "old", outcome)
    assert "unreadable" in outcome.differences[-1]


def test_a_verdict_outside_the_closed_list_is_refused_even_on_both_sides(reference, fresh, paper, published):
    spoil(fresh, CLAIMS, lambda frame: frame.replace({"verdict": {"refuted": "Refuted"}}))
    for sides in ((fresh, fresh), (fresh, reference), (reference, fresh)):
        found = compare(*sides, {KEY: paper}, published).differences
        assert any("'Refuted' in the re" in line and "expected a verdict" in line for line in found)


@pytest.mark.parametrize("column", ["published", "published_high"])
def test_published_numbers_of_claims_are_exact(column, reference, fresh, differences):
    frame = tables.read_text(reference / CLAIMS)
    for cell in ("0.54", "0.5400000001", "nan"):
        frame.loc[0, column] = cell
        tables.write_csv(frame, fresh / CLAIMS)
        same = cell == reference_cell(reference, column)
        assert any(f"{column}: found" in line for line in differences()) is not same


def reference_cell(reference, column) -> str:
    return tables.read_text(reference / CLAIMS).loc[0, column]
