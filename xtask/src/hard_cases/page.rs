//! The report: DIR/index.html, DIR/findings.csv, DIR/findings.json and the table on the terminal.

use super::case::{Case, Record};
use crate::report::{Finding, Page, Part, Picture, Table, Verdict, write_findings};
use crate::store::{Kept, Store};
use anyhow::Result;
use maud::{Markup, html};
use std::fmt::Write;

const MORE_STYLE: &str = "\
.verdict{font-size:.8rem;font-weight:600;border-radius:.3rem;padding:.1rem .5rem;margin-left:.5rem;white-space:nowrap}\
.good{background:#d9efe6;color:#00573f}.open{background:#fdf3d8;color:#6b4a00}.bad{background:#f8dcd0;color:#8c2f00}\
figcaption{font-size:.85rem;color:#666;margin-top:.4rem}h3{font-size:.85rem;font-weight:600;color:#666;margin:.9rem 0 .1rem}\
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
            "Situations that break solvers for sheets of rigid rods. Each says what should "
            "happen and measures isosheet against a bound, and most show a naive method at it. Every number is computed by the run that made this page. "
            "Unless stated otherwise: a square of side 1 m and 0.1 kg, lumped masses, gravity 9.8 m/s² along −z, steps of 1/60 s."
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
        "The cases, and what a naive method does in each.",
        records,
        &[
            ("case", &|r| r.name.as_str().into()),
            ("situation", &|r| r.title.as_str().into()),
            ("checks", &|r| r.checks.len().into()),
            ("passed", &|r| passed(r).into()),
            ("naive method", &|r| naive_word(r).into()),
        ],
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
        &[
            ("case", &|(r, _)| r.name.as_str().into()),
            ("check", &|(_, c)| c.quantity.as_str().into()),
            ("measured", &|(_, c)| c.measured().into()),
            ("bound", &|(_, c)| c.bound.text().into()),
            ("why", &|(_, c)| why(c).into()),
        ],
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
            thead { tr { th { "Case" } th { "Checks" } th { "Naive method" } th { "isosheet" } } }
            tbody { @for r in records { tr {
                td { a href={ "#" (r.name) } { (r.title) } }
                td { (r.checks.len()) }
                td { (naive_word(r)) }
                td { (badge(r.verdict())) }
            } } }
        } }
    }
}

fn naive_word(r: &Record) -> &'static str {
    let failed = r.naive.iter().filter(|n| n.failed()).count();
    match (failed, r.naive.len()) {
        (_, 0) => "none shown",
        (0, _) => "copes",
        (f, n) if f == n => "fails",
        _ => "fails in part",
    }
}

/// The section of a case: what isosheet does, in words, pictures and tables.
pub(super) fn section(
    case: &Case,
    r: &Record,
    here: &str,
    (pictures, tables): (&[Picture], &[Table]),
) -> Markup {
    html! {
        section id=(case.name) {
            h2 { (case.title) (badge(r.verdict())) }
            h3 { "What should happen" }
            p { (case.expected) }
            @if !r.naive.is_empty() {
                h3 { "What a naive method does" }
                div.scroll { table {
                    thead { tr { th { "Method" } th { "Measured" } th { "Value" } th { "Fails unless" } th {} } }
                    tbody { @for n in &r.naive { tr {
                        td { (n.method) }
                        td { (n.finding.quantity) @if let Some(text) = &n.finding.remark { br; small { (text) } } }
                        td.number { (n.finding.measured()) }
                        td.number { (n.finding.bound.text()) }
                        td { @if n.failed() { "fails" } @else { "copes" } }
                    } } }
                } }
            }
            h3 { "What isosheet does" }
            p { (here) }
            div.scroll { table {
                thead { tr { th { "Check" } th { "Measured" } th { "Bound" } th { "Verdict" } } }
                tbody { @for check in &r.checks { (check_row(check)) } }
            } }
            @for picture in pictures { figure { (picture.inside) figcaption { (picture.alt) } } }
            @for table in tables { (table) }
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
        &[
            ("case", &|r| r.name.as_str().into()),
            ("isosheet", &|r| {
                format!("{} ({} checks)", r.verdict().text(), r.checks.len()).into()
            }),
            ("naive method", &|r| naive_word(r).into()),
            ("seconds", &|r| format!("{:.1}", r.wall).into()),
        ],
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
