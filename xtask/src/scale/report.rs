//! The page of the scaling study, its other files, and its text for a terminal.

use super::Results;
use super::drape;
use super::findings::{conclusion, draping_conclusion, threads};
use super::measure::STEP;
use super::plot;
use super::tables::{draping, draping_data, orders, steps, steps_data};
use super::whole::{SCENES, name};
use super::whole_report;
use crate::report::{Page, drawing, list, machine};
use crate::timing::Work;
use anyhow::Result;
use maud::{Markup, html};

/// What the picture shows, for those who do not see it.
const PICTURE: &str = "Time, memory and fill of a step against the number of vertices";

/// All files but the page: names and contents.
pub(super) fn files(results: &Results) -> Result<Vec<(&'static str, Vec<u8>)>> {
    let plot = plot::plot(results);
    Ok(vec![
        ("scale.svg", plot.to_svg(PICTURE).into_bytes()),
        ("scale.png", plot.to_png(PICTURE)?),
        ("scale.csv", steps_data(&results.hanging).csv()?),
        ("draping.csv", draping_data(&results.draping).csv()?),
        ("runs.csv", whole_report::data(&results.whole).csv()?),
    ])
}

/// The page.
pub(super) fn page(results: &Results) -> Result<Page> {
    let svg = plot::plot(results).to_svg(PICTURE);
    let body = html! {
        p {
            "A square sheet of 1 m and 0.1 kg hangs by a corner from a start that is flat but for a bump of 1 mm; steps of "
            (1e3 * STEP) " ms by the default method, the first " (results.hanging.first().map_or(0, |r| r.steps))
            " after one of warm-up at each mesh size, without contact. Later steps of the fine meshes cost more: near the "
            "flat state the length equations are all but dependent. Machine: " (machine()) "."
        }
        figure { (drawing(svg.as_bytes())) }
        p { (conclusion(&results.hanging)) }
        (steps(&results.hanging))
        p { (threads(&results.hanging)) }
        (orders(&results.hanging))
        h2 { "With contact" }
        p {
            "The same sheet with a bump of " (drape::BUMP) " m, all vertices free, above a square table of half its side that its "
            "lowest part touches at once; contact with the table and of the sheet with itself. Steps as above. (A nearly flat cloth on "
            "a table needs so many iterations from 16 641 vertices on that they would hide the price of the size.)"
        }
        p { (draping_conclusion(results)) }
        (draping(&results.draping))
        h2 { "Whole runs" }
        p { (whole_report::about(results.limit)) }
        p { (whole_report::CHAOS) }
        @for scene in SCENES { (whole_runs(results, scene)) }
    };
    Ok(Page {
        heading: "Scale",
        ..Page::new("isosheet: scale", body)
    })
}

/// The whole runs of a scene.
fn whole_runs(results: &Results, scene: Work) -> Markup {
    let runs = results.whole_of(scene);
    // The scene's name as a title.
    let mut title = name(scene).to_owned();
    title[..1].make_ascii_uppercase();
    html! {
        h3 { (title) }
        (list(&whole_report::findings(&runs)))
        (whole_report::table(scene, &runs))
    }
}

/// The results for people.
pub(super) fn text(results: &Results) -> String {
    let mut parts = vec![
        steps(&results.hanging).text(),
        conclusion(&results.hanging),
        threads(&results.hanging),
        draping(&results.draping).text(),
        draping_conclusion(results),
    ];
    for scene in SCENES {
        let runs = results.whole_of(scene);
        parts.push(whole_report::table(scene, &runs).text());
        parts.extend(whole_report::findings(&runs));
    }
    parts.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::measure::measure;
    use crate::scale::whole;

    #[test]
    fn the_page_is_whole() {
        let results = Results {
            hanging: [0, 1]
                .map(|level| measure(level, 2).expect("small sheets move"))
                .to_vec(),
            draping: [0, 1]
                .map(|level| drape::measure(level, 2, 10.0).expect("small cloths move"))
                .to_vec(),
            whole: SCENES
                .map(|scene| whole::measure(scene, 1, 30.0).expect("coarse scenes run"))
                .concat(),
            limit: 30.0,
        };
        let page = page(&results).expect("drawn").to_html();
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
            let lines = files[k].1.iter().filter(|b| **b == b'\n').count();
            assert_eq!(lines, 1 + rows, "{}", files[k].0);
        }
        assert!(text(&results).contains("M^1"));
    }
}
