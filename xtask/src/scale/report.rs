//! The page of the scaling study, its other files, and its text for a terminal.

use super::findings::{conclusion, draping_conclusion, threads};
use super::measure::STEP;
use super::tables::{csv, draping, draping_csv, factor_bytes, megabytes, orders, percent, steps};
use super::whole::Scene;
use super::{Results, drape, plot, whole_report};
use crate::figures::machine;
use crate::report::html::{STYLE, escape, inline_svg, table};
use anyhow::Result;
use std::fmt::Write;

/// What the picture shows, for those who do not see it.
const PICTURE: &str = "Time, memory and fill of a step against the number of vertices";

/// All files but the page: names and contents.
pub(super) fn files(results: &Results) -> Result<Vec<(String, Vec<u8>)>> {
    let plot = plot::plot(results);
    Ok(vec![
        ("scale.svg".into(), plot.to_svg(PICTURE)?.into_bytes()),
        ("scale.png".into(), plot.to_png(PICTURE)?),
        ("scale.csv".into(), csv(&results.hanging).into_bytes()),
        (
            "draping.csv".into(),
            draping_csv(&results.draping).into_bytes(),
        ),
        (
            "runs.csv".into(),
            whole_report::csv(&results.whole).into_bytes(),
        ),
    ])
}

/// The page.
pub(super) fn page(results: &Results) -> Result<String> {
    let svg = plot::plot(results).to_svg(PICTURE)?;
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>isosheet: scale</title><style>{STYLE}</style></head>\
         <body><h1>Scale</h1>"
    );
    paragraph(
        &mut out,
        &format!(
            "A square sheet of 1 m and 0.1 kg hangs by a corner from a start that is flat but for a bump of 1 mm; steps of {} ms by the default \
             method, the first {} after one of warm-up at each mesh size, without contact. Later steps of the fine meshes cost more: near the \
             flat state the length equations are all but dependent. Machine: {}.",
            1e3 * STEP,
            results.hanging.first().map_or(0, |r| r.steps),
            machine()
        ),
    );
    let _ = write!(out, "<figure>{}</figure>", inline_svg(&svg));
    paragraph(&mut out, &conclusion(&results.hanging));
    table(&mut out, &steps(&results.hanging));
    paragraph(&mut out, &threads(&results.hanging));
    table(&mut out, &orders(&results.hanging));
    out.push_str("<h2>With contact</h2>");
    paragraph(
        &mut out,
        &format!(
            "The same sheet with a bump of {} m, all vertices free, above a square table of half its side that its lowest part touches at once; \
             contact with the table and of the sheet with itself. Steps as above. (A nearly flat cloth on a table needs so many iterations from \
             16 641 vertices on that they would hide the price of the size.)",
            drape::BUMP
        ),
    );
    paragraph(&mut out, &draping_conclusion(results));
    table(&mut out, &draping(&results.draping));
    whole_runs(&mut out, results);
    out.push_str("</body></html>\n");
    Ok(out)
}

/// The section of whole runs.
fn whole_runs(out: &mut String, results: &Results) {
    out.push_str("<h2>Whole runs</h2>");
    paragraph(out, &whole_report::about(results.limit));
    paragraph(out, whole_report::CHAOS);
    for scene in Scene::ALL {
        let runs = results.whole_of(scene);
        // The scene's name as a title.
        let mut title = scene.name().to_owned();
        title[..1].make_ascii_uppercase();
        let _ = write!(out, "<h3>{}</h3><ul>", escape(&title));
        for words in whole_report::findings(&runs) {
            let _ = write!(out, "<li>{}</li>", escape(&words));
        }
        out.push_str("</ul>");
        table(out, &whole_report::table(scene, &runs));
    }
}

fn paragraph(out: &mut String, text: &str) {
    // Writing to a string cannot fail.
    let _ = write!(out, "<p>{}</p>", escape(text));
}

/// The results for people.
pub(super) fn text(results: &Results) -> String {
    let mut out = String::from(
        "mesh  vertices   step, s  iterations  factorisations  factor, MB  peak, MB\n",
    );
    for r in &results.hanging {
        let _ = writeln!(
            out,
            "M^{:<3} {:>8} {:>9.2e} {:>11.1} {:>15.1} {:>11.1} {:>9}",
            r.level,
            r.vertices,
            r.per_step,
            r.iterations,
            r.factorisations,
            factor_bytes(r.best()) / 1e6,
            megabytes(r.peak)
        );
    }
    let _ = writeln!(
        out,
        "{}\n{}\nwith contact:   step, s  factorisations  detection    distances  contacts  peak, MB",
        conclusion(&results.hanging),
        threads(&results.hanging)
    );
    for r in &results.draping {
        let _ = writeln!(
            out,
            "M^{:<3} {:>8} {:>9.2e} {:>15.1} {:>10} {:>12} {:>9} {:>9}",
            r.level,
            r.vertices,
            r.per_step,
            r.factorisations,
            percent(r.detection, r.per_step),
            percent(r.evaluation, r.per_step),
            r.contacts,
            megabytes(r.peak)
        );
    }
    let _ = writeln!(out, "{}", draping_conclusion(results));
    out.push_str(&whole_report::text(results));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::whole;

    #[test]
    fn the_page_is_whole() {
        let results = Results {
            hanging: [0, 1]
                .map(|level| super::super::measure(level, 2).expect("small sheets move"))
                .to_vec(),
            draping: [0, 1]
                .map(|level| drape::measure(level, 2, 10.0).expect("small cloths move"))
                .to_vec(),
            whole: Scene::ALL
                .map(|scene| whole::measure(scene, 1, 30.0).expect("coarse scenes run"))
                .concat(),
            limit: 30.0,
        };
        let page = page(&results).expect("drawn");
        for part in [
            "<svg",
            "nested dissection",
            "With contact",
            "give the same bits",
            "Whole runs",
            "chaotic",
            "Fitted powers of V",
            "the fastest method that keeps lengths",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("NaN"));
        let files = files(&results).expect("drawn");
        for (k, rows) in [(2, 4), (3, 2), (4, 10)] {
            let csv = &files[k].1;
            let lines: Vec<&[u8]> = csv.split(|b| *b == b'\n').collect();
            assert_eq!(lines.len(), 1 + rows + 1, "{}", files[k].0);
            let fields = |l: &[u8]| l.split(|b| *b == b',').count();
            assert!(
                lines[1..=rows]
                    .iter()
                    .all(|l| fields(l) == fields(lines[0]))
            );
        }
        assert!(text(&results).contains("M^1"));
    }
}
