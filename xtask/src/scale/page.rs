//! The page of the scaling study, and its text for a terminal.

use super::charts::charts;
use super::drape;
use super::findings::{conclusion, draping_conclusion, threads};
use super::steps::STEP;
use super::tables::{draping, orders, steps};
use super::whole::{SCENES, name};
use super::whole_report;
use super::{PICTURE, Results};
use crate::report::{Page, Picture, Requirement, Table, list, machine, requirements};
use crate::timing::{Measured, Work};
use maud::{Markup, html};

/// The page.
pub(super) fn page(results: &Results, required: &[(String, Requirement)]) -> Page {
    let figure = Picture::svg("scale", &charts(results), PICTURE);
    let body = html! {
        p {
            "A square sheet of 1 m and 0.1 kg hangs by a corner from a start that is flat but for a bump of 1 mm; steps of "
            (1e3 * STEP) " ms by the default method, the first " (results.hanging.first().map_or(0, |r| r.course.cost.steps))
            " after one of warm-up at each mesh size, without contact. Later steps of the fine meshes cost more: near the "
            "flat state the length equations are all but dependent. Machine: " (machine()) "."
        }
        figure { (figure.inside) }
        p { (conclusion(&results.hanging)) }
        (steps(&results.hanging))
        p { (threads(&results.hanging)) }
        (orders(&results.hanging))
        (requirements("What the study is required to show on any machine", required))
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
    Page {
        heading: "Scale",
        ..Page::new("isosheet: scale", body)
    }
}

/// What is shown of the whole runs of a scene.
fn table(scene: Work, runs: &[&Measured]) -> Table {
    let names = "mesh vertices method start wall_s_per_simulated_s iterations_per_step factorisations_per_step \
                 cpu_s_per_simulated_s wall_s_per_factorisation times_fastest_exact times_one_factorisation_a_step rejected strain \
                 smallest_gap_m reached_s failure";
    let all = whole_report::table(runs);
    all.select(format!("{} Here: the {}.", all.caption, name(scene)), names)
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
        (table(scene, &runs))
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
        parts.push(table(scene, &runs).text());
        parts.extend(whole_report::findings(&runs));
    }
    parts.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::scale::required::required;
    use crate::scale::{steps, whole};

    #[test]
    fn the_page_is_whole() {
        let results = Results {
            hanging: [0, 1]
                .map(|level| steps::measure(level, 2).expect("small sheets move"))
                .to_vec(),
            draping: [0, 1]
                .map(|level| drape::measure(level, 2, 10.0).expect("small cloths move"))
                .to_vec(),
            whole: SCENES
                .map(|scene| whole::measure(scene, 1, 30.0).expect("coarse scenes run"))
                .concat(),
            limit: 30.0,
        };
        let required = required(&results);
        let page = page(&results, &required).to_html(Effort::Full);
        for part in [
            "<svg",
            "nested_dissection",
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
        let all = super::super::tables::hanging(&results.hanging);
        assert_eq!(
            (all.rows.len(), draping(&results.draping).rows.len()),
            (4, 2)
        );
        assert!(text(&results).contains("M^1"));
    }
}
