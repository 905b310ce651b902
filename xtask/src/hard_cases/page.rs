//! The report: DIR/index.html, DIR/findings.csv, DIR/findings.json and the table on the terminal.

use super::Record;
use crate::report::{Finding, Page, Part, Table, Verdict, columns, write_findings};
use crate::store::{Kept, Store};
use anyhow::Result;
use maud::{Markup, html};
use std::fmt::Write;

const MORE_STYLE: &str = "\
.verdict{font-size:.8rem;font-weight:600;border-radius:.3rem;padding:.1rem .5rem;margin-left:.5rem;white-space:nowrap}\
.good{background:#d9efe6;color:#00573f}.open{background:#fdf3d8;color:#6b4a00}.bad{background:#f8dcd0;color:#8c2f00}\
h3{font-size:.85rem;font-weight:600;color:#666;margin:.9rem 0 .1rem}\
section p{margin:.1rem 0 .4rem}ul{margin:.1rem 0 .4rem;padding-left:1.1rem}td.number{white-space:nowrap}";

/// Writes the files.
pub(super) fn write(store: &Store, kept: &Kept<Record>) -> Result<()> {
    let (records, left_out) = (&kept.records, kept.left_out.clone());
    write_findings(store, findings(records))?;
    let page = page(records);
    Page { left_out, ..page }.write(store, "index.html")
}

fn badge(verdict: Verdict) -> Markup {
    let class = match verdict {
        Verdict::Passed => "good",
        Verdict::Limitation => "open",
        Verdict::Cured | Verdict::Improved | Verdict::Failed => "bad",
    };
    html! { span class={ "verdict " (class) } { (verdict.text()) } }
}

fn page(records: &[Record]) -> Page {
    let body = html! {
        p {
            "Situations that break solvers for thin sheets. Each says what should happen and measures isosheet against "
            "bounds. Every number is computed by the run that made this page: the summaries of all runs of a scene are "
            "judged. Largest strains and smallest gaps are of all accepted steps, those of runs that stop early included."
        }
        (summary(records))
        @for record in records { (record.section) }
    };
    Page {
        style: MORE_STYLE,
        ..Page::new("Hard cases", body)
    }
}

/// How many checks of some cases passed, are open limitations and failed.
fn counts(records: &[Record]) -> String {
    let checks = || of_all(records).map(|(_, c)| c);
    let count = |v: Verdict| checks().filter(|c| c.verdict() == v).count();
    let failed = checks().filter(|c| c.verdict().is_failure()).count();
    let (cases, all) = (records.len(), checks().count());
    let [passed, open] = [Verdict::Passed, Verdict::Limitation].map(count);
    format!(
        "{cases} cases, {all} checks: {passed} passed, {open} open limitations, {failed} failed."
    )
}

/// What the book shows: the counts, every case, and the checks that did not pass.
pub(super) fn excerpt(records: &[Record]) -> Vec<Part> {
    let passed = |r: &Record| {
        let checks = r.checks.iter();
        checks.filter(|c| c.verdict() == Verdict::Passed).count()
    };
    let cases = Table::of(
        "The cases.",
        records,
        columns! { r;
            "case" => r.name.as_str(),
            "situation" => r.title.as_str(),
            "checks" => r.checks.len(),
            "passed" => passed(r),
        },
    );
    let open = of_all(records).filter(|(_, c)| c.verdict() != Verdict::Passed);
    let why = |c: &Finding| {
        let declared = c.limitation.as_ref();
        declared
            .map_or("not declared", |l| l.why.as_str())
            .to_owned()
    };
    let limitations = Table::of(
        "The checks that did not pass.",
        open,
        columns! { row;
            "case" => row.0.name.as_str(),
            "check" => row.1.quantity.as_str(),
            "measured" => row.1.measured(),
            "bound" => row.1.bound.text(),
            "why" => why(row.1),
        },
    );
    vec![
        Part::text("counts", counts(records)),
        Part::table("cases", &cases),
        Part::table("limitations", &limitations),
    ]
}

fn summary(records: &[Record]) -> Markup {
    html! {
        p { (counts(records)) }
        div.scroll { table {
            thead { tr { th { "Case" } th { "Checks" } th { "isosheet" } } }
            tbody { @for r in records { tr {
                td { a href={ "#" (r.name) } { (r.title) } }
                td { (r.checks.len()) }
                td { (badge(r.verdict())) }
            } } }
        } }
    }
}

/// The section of a case, with the table of its runs.
pub(super) fn section(expected: &str, r: &Record, runs: &Table) -> Markup {
    html! {
        section id=(r.name) {
            h2 { (r.title) (badge(r.verdict())) }
            h3 { "What should happen" }
            p { (expected) }
            h3 { "What isosheet does" }
            div.scroll { table {
                thead { tr { th { "Check" } th { "Measured" } th { "Bound" } th { "Verdict" } } }
                tbody { @for check in &r.checks { (check_row(check)) } }
            } }
            (runs)
        }
    }
}

fn check_row(check: &Finding) -> Markup {
    let limitation = check.limitation.as_ref();
    let declared = limitation.map(|l| format!("{} Declared: {}.", l.why, l.shortfall.text()));
    html! {
        tr {
            td {
                (check.quantity)
                @for text in [&declared, &check.remark].into_iter().flatten() { br; small { (text) } }
            }
            td.number { (check.measured()) }
            td.number { (check.bound.text()) }
            td { (badge(check.verdict())) }
        }
    }
}

/// Every check of every case.
fn of_all(records: &[Record]) -> impl Iterator<Item = (&Record, &Finding)> + Clone {
    records
        .iter()
        .flat_map(|r| r.checks.iter().map(move |c| (r, c)))
}

/// Every check with the name of its case.
pub(super) fn findings(records: &[Record]) -> impl Iterator<Item = (&str, &Finding)> + Clone {
    of_all(records).map(|(r, c)| (r.name.as_str(), c))
}

/// The table on the terminal: every case, and every check that did not simply pass.
pub(super) fn text(records: &[Record]) -> String {
    let table = Table::of(
        "Hard cases",
        records,
        columns! { r;
            "case" => r.name.as_str(),
            "isosheet" => format!("{} ({} checks)", r.verdict().text(), r.checks.len()),
            "seconds" => format!("{:.1}", r.wall),
        },
    );
    let mut out = table.text();
    for (r, c) in of_all(records).filter(|(_, c)| c.verdict() != Verdict::Passed) {
        let (name, verdict, what) = (&r.name, c.verdict().text(), &c.quantity);
        let (found, bound) = (c.measured(), c.bound.text());
        let declared = c.limitation.as_ref().map(|l| l.shortfall.text());
        let declared = declared.map_or(String::new(), |text| format!("; declared: {text}"));
        let _ = writeln!(
            out,
            "{name}: {verdict}: {what}, {found} ({bound}){declared}"
        );
    }
    out
}
