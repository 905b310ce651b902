//! The report: DIR/index.html, DIR/verdicts.csv, DIR/verdicts.json and the table on the terminal.

use super::case::number;
use super::{Bound, Check, Effort, Record, Verdict};
use crate::report::html::{STYLE, escape, image, table as html_table};
use crate::store::Store;
use anyhow::Result;
use serde_json::json;
use std::fmt::Write;

const MORE_STYLE: &str = "\
.verdict{font-size:.8rem;font-weight:600;border-radius:.3rem;padding:.1rem .5rem;margin-left:.5rem;white-space:nowrap}\
.good{background:#d9efe6;color:#00573f}.open{background:#fdf3d8;color:#6b4a00}.bad{background:#f8dcd0;color:#8c2f00}\
figcaption{font-size:.85rem;color:#666;margin-top:.4rem}h3{font-size:.85rem;font-weight:600;color:#666;margin:.9rem 0 .1rem}\
section p{margin:.1rem 0 .4rem}ul{margin:.1rem 0 .4rem;padding-left:1.1rem}td.number{white-space:nowrap}";

/// Writes the three files.
pub(super) fn write(store: &Store, records: &[Record], effort: Effort) -> Result<()> {
    store.write("index.html", page(store, records, effort)?.as_bytes())?;
    store.write("verdicts.csv", csv(records).as_bytes())?;
    let cases: Vec<_> = records
        .iter()
        .map(|r| {
            let checks: Vec<_> = r
                .checks
                .iter()
                .map(|c| json!({ "what": c.what, "value": c.value, "bound": c.bound, "verdict": c.verdict(),
                                 "limitation": c.limitation, "stopped": c.stopped, "remark": c.remark }))
                .collect();
            json!({ "case": r.name, "title": r.title, "verdict": r.verdict(), "naive": r.naive, "checks": checks,
                    "seconds": r.wall })
        })
        .collect();
    store.write_json(
        "verdicts.json",
        &json!({ "version": env!("CARGO_PKG_VERSION"), "effort": effort, "cases": cases }),
    )?;
    Ok(())
}

/// What was measured, for people.
fn measured(check: &Check) -> String {
    match (check.value, &check.remark) {
        (Some(v), _) => number(v),
        (None, Some(_)) => match check.stopped {
            Some(t) => format!("stopped after {} s", number(t)),
            None => "stopped".into(),
        },
        (None, None) => "no number".into(),
    }
}

fn badge(verdict: Verdict) -> String {
    let class = match verdict {
        Verdict::Passed => "good",
        Verdict::Limitation => "open",
        Verdict::Cured | Verdict::Improved | Verdict::Failed => "bad",
    };
    format!("<span class=\"verdict {class}\">{}</span>", verdict.text())
}

fn page(store: &Store, records: &[Record], effort: Effort) -> Result<String> {
    let mut out = String::from(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Hard cases</title><style>",
    );
    out.push_str(STYLE);
    out.push_str(MORE_STYLE);
    out.push_str(
        "</style></head><body><h1>Hard cases</h1><p>Situations that break solvers for sheets of rigid rods. Each says what should \
         happen, shows a naive method at it, and measures isosheet against a bound. Every number is computed by the run that made this page. \
         Unless stated otherwise: a square of side 1 m and 0.1 kg, lumped masses, gravity 9.8 m/s² along −z, steps of 1/60 s.</p>",
    );
    if effort == Effort::Quick {
        out.push_str(
            "<p class=\"note\">Made with <code>--quick</code>: short runs on small meshes.</p>",
        );
    }
    summary(&mut out, records);
    for record in records {
        section(&mut out, store, record)?;
    }
    out.push_str("</body></html>\n");
    Ok(out)
}

// Writing to a string cannot fail, so the results of `write!` are dropped below.

fn summary(out: &mut String, records: &[Record]) {
    let checks = || records.iter().flat_map(|r| &r.checks);
    let count = |v: Verdict| checks().filter(|c| c.verdict() == v).count();
    let _ = write!(
        out,
        "<p>{} cases, {} checks: {} passed, {} open limitations, {} failed.</p>\
         <div class=\"scroll\"><table><thead><tr><th>Case</th><th>Checks</th><th>Naive method</th><th>isosheet</th></tr></thead><tbody>",
        records.len(),
        checks().count(),
        count(Verdict::Passed),
        count(Verdict::Limitation),
        checks().filter(|c| c.verdict().is_failure()).count(),
    );
    for r in records {
        let _ = write!(
            out,
            "<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td></tr>",
            r.name,
            escape(&r.title),
            r.checks.len(),
            naive_word(r),
            badge(r.verdict())
        );
    }
    out.push_str("</tbody></table></div>");
}

fn naive_word(r: &Record) -> &'static str {
    let failed = r.naive.iter().filter(|n| n.failed).count();
    match (failed, r.naive.len()) {
        (_, 0) => "none shown",
        (0, _) => "copes",
        (f, n) if f == n => "fails",
        _ => "fails in part",
    }
}

fn section(out: &mut String, store: &Store, r: &Record) -> Result<()> {
    let _ = write!(
        out,
        "<section id=\"{}\"><h2>{}{}</h2><h3>What should happen</h3><p>{}</p>",
        r.name,
        escape(&r.title),
        badge(r.verdict()),
        escape(&r.expected)
    );
    if !r.naive.is_empty() {
        out.push_str("<h3>What a naive method does</h3><ul>");
        for n in &r.naive {
            let word = if n.failed { "fails" } else { "copes" };
            let _ = write!(
                out,
                "<li>{}: <b>{word}</b>. {}</li>",
                escape(&n.method),
                escape(&n.outcome)
            );
        }
        out.push_str("</ul>");
    }
    let _ = write!(out, "<h3>What isosheet does</h3><p>{}</p>", escape(&r.here));
    out.push_str("<div class=\"scroll\"><table><thead><tr><th>Check</th><th>Measured</th><th>Bound</th><th>Verdict</th></tr></thead><tbody>");
    for c in &r.checks {
        let mut what = escape(&c.what);
        let declared = c
            .limitation
            .as_ref()
            .map(|l| format!("{} Declared: {}.", l.why, l.shortfall.text()));
        for text in [&declared, &c.remark].into_iter().flatten() {
            let _ = write!(what, "<br><small>{}</small>", escape(text));
        }
        let _ = write!(
            out,
            "<tr><td>{what}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>",
            measured(c),
            c.bound.text(),
            badge(c.verdict())
        );
    }
    out.push_str("</tbody></table></div>");
    for picture in &r.pictures {
        out.push_str("<figure>");
        image(out, picture, &store.read(&picture.path)?);
        let _ = write!(
            out,
            "<figcaption>{}</figcaption></figure>",
            escape(&picture.alt)
        );
    }
    for t in &r.tables {
        html_table(out, t);
    }
    out.push_str("</section>\n");
    Ok(())
}

fn csv(records: &[Record]) -> String {
    let quote = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut out = String::from(
        "case,check,value,bound_kind,bound,verdict,limitation,declared,stopped_s,remark\n",
    );
    for r in records {
        for c in &r.checks {
            let (kind, bound) = match c.bound {
                Bound::AtMost(b) => ("at_most", b),
                Bound::AtLeast(b) => ("at_least", b),
            };
            let _ = writeln!(
                out,
                "{},{},{},{kind},{bound:e},{},{},{},{},{}",
                r.name,
                quote(&c.what),
                c.value.map_or(String::new(), |v| format!("{v:e}")),
                c.verdict().text(),
                quote(c.limitation.as_ref().map_or("", |l| &l.why)),
                quote(
                    &c.limitation
                        .as_ref()
                        .map_or(String::new(), |l| l.shortfall.text())
                ),
                c.stopped.map_or(String::new(), |t| format!("{t:e}")),
                quote(c.remark.as_deref().unwrap_or_default()),
            );
        }
    }
    out
}

/// The table on the terminal: every case, and every check that did not simply pass.
pub(super) fn table(records: &[Record]) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{:<16}{:<34}{:<15}{:>8}",
        "case", "isosheet", "naive method", "seconds"
    );
    for r in records {
        let _ = writeln!(
            out,
            "{:<16}{:<34}{:<15}{:>8.1}",
            r.name,
            format!("{} ({} checks)", r.verdict().text(), r.checks.len()),
            naive_word(r),
            r.wall
        );
        for c in r.checks.iter().filter(|c| c.verdict() != Verdict::Passed) {
            let _ = writeln!(
                out,
                "  {}: {}, {} ({}){}",
                c.verdict().text(),
                c.what,
                measured(c),
                c.bound.text(),
                c.limitation.as_ref().map_or(String::new(), |l| format!(
                    "; declared: {}",
                    l.shortfall.text()
                ))
            );
        }
    }
    out
}
