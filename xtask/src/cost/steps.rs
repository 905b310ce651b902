//! What a step costs as the mesh is refined: time, memory and fill, without and with contact.

mod charts;
mod findings;
mod measure;
mod orders;
mod timed;

pub(super) use orders::factorisation_time;

use super::Record;
use crate::progress::Progress;
use crate::report::{Part as Excerpt, Table, list, plot};
use crate::store::{Store, Unit};
use crate::threads;
use anyhow::Result;
use maud::html;
use measure::Row;
use orders::OrderRow;

/// The name of the part.
pub(super) const NAME: &str = "steps";

const ABOUT: &str = "\
    A square sheet of 1 m and 0.1 kg, the first steps of 0.25 ms by the default method after one of \
    warm-up, on one thread. Without contact it hangs by a corner from a start that is flat but for a \
    bump of 1 mm; later steps of the fine meshes cost more: near the flat state the length equations are \
    all but dependent. With contact it has a bump of 0.1 m, all vertices free, above a square table of \
    half its side that its lowest part touches at once; it touches the table and itself. (A nearly flat \
    cloth on a table needs so many iterations from 16 641 vertices on that they would hide the price of \
    the size.)";

/// The meshes `M^k` up to a finest one, each kept by itself.
fn units(store: &Store, finest: u32) -> Vec<(u32, Unit)> {
    let levels = store.effort.quick_or(1..=3, 2..=finest);
    levels
        .map(|k| {
            (
                k,
                store.unit(format!("steps-{k}"), format!("steps of M^{k}")),
            )
        })
        .collect()
}

/// Measures meshes up to a finest one, coarse to fine, and keeps them.
pub(super) fn measure(store: &Store, finest: u32) -> Result<()> {
    for (level, unit) in units(store, finest) {
        store.keep(&unit, |_| {
            let bar = Progress::start(&unit.title, 1);
            let row = threads::pool(1)?.install(|| measure::measure(level, STEPS))?;
            bar.finish("measured");
            Ok(row)
        })?;
    }
    Ok(())
}

/// Steps that are timed.
const STEPS: usize = 3;

/// The finest mesh that can be asked for.
pub(super) const FINEST: u32 = 8;

/// The part of the meshes that have been measured, with its files; `None` if there is none. The titles of those
/// that another build measured are added to `left_out`.
pub(super) fn record(store: &Store, left_out: &mut Vec<String>) -> Result<Option<Record>> {
    let units = units(store, FINEST).into_iter().map(|(_, unit)| unit);
    let kept = store.all_kept::<Row>(units.collect());
    left_out.extend(kept.left_out);
    let rows = kept.records;
    if rows.is_empty() {
        return Ok(None);
    }
    let tables = [steps(&rows), orders(&rows)];
    for table in &tables {
        table.write_to(&store.path(&format!("tables/{}.csv", table.name)))?;
    }
    let alt = "Time, memory and operations of a step against the number of vertices";
    let mut files = store.files();
    let inside = html! {
        h2 { "Steps by size" }
        p { (ABOUT) }
        (plot(&mut files, NAME, &charts::charts(&rows), alt)?)
        (list(&findings::findings(&rows)))
        (tables[0])
        (tables[1])
    };
    Ok(Some(Record {
        excerpt: vec![
            Excerpt::list("steps-words", &findings::findings(&rows)),
            Excerpt::table(NAME, &tables[0]),
        ],
        requirements: findings::required(&rows),
        ..Record::new(NAME, inside)
    }))
}

/// The steps of all meshes, without and with contact.
fn steps(rows: &[Row]) -> Table {
    let all = rows
        .iter()
        .flat_map(|r| [(r, &r.hanging, None), (r, &r.draping, Some(r.contact))]);
    Table::of(
        "Per step. Factorising, solving: the numbers of factorisations and solves times what one takes alone. Detection: pairs within reach and \
         the safe part of every motion; distances: distances, normals and weights of the pairs. Couplings: pairs of vertices that contact adds to \
         the pattern of the matrix. The memory is that of the Cholesky factor, and the peak of the process.",
        all,
        &[
            ("level", &|(r, ..)| r.level.into()),
            ("vertices", &|(r, ..)| r.vertices.into()),
            ("contact", &|(.., c)| {
                c.map_or("none", |_| "table, itself").into()
            }),
            ("steps", &|(_, s, _)| s.cost.steps.into()),
            ("cpu_s", &|(_, s, _)| s.cost.cpu_per_step().into()),
            ("factorising_s", &|(r, s, _)| r.parts(s)[0].into()),
            ("solving_s", &|(r, s, _)| r.parts(s)[1].into()),
            ("detection_s", &|(.., c)| c.map(|c| c.detection).into()),
            ("distances_s", &|(.., c)| c.map(|c| c.distances).into()),
            ("iterations", &|(_, s, _)| {
                s.cost.iterations_per_step().into()
            }),
            ("factorisations", &|(_, s, _)| {
                s.cost.factorisations_per_step().into()
            }),
            ("contacts", &|(.., c)| c.map(|c| c.contacts).into()),
            ("couplings", &|(.., c)| c.map(|c| c.couplings).into()),
            ("strain", &|(_, s, _)| s.strain.into()),
            ("gap_m", &|(_, s, _)| s.gap.into()),
            ("factor_bytes", &|(r, ..)| r.best().bytes().into()),
            ("peak_bytes", &|(r, ..)| r.peak.into()),
            ("stopped", &|(_, s, _)| s.failure().into()),
        ],
    )
    .named(NAME)
}

/// The orders of elimination on all meshes.
fn orders(rows: &[Row]) -> Table {
    let all = rows
        .iter()
        .flat_map(|r| r.orders.iter().map(move |o| (r, o)));
    Table::of(
        "Elimination orders of the matrix of a step",
        all,
        &[
            ("level", &|(r, _): &(&Row, &OrderRow)| r.level.into()),
            ("vertices", &|(r, _)| r.vertices.into()),
            ("ordering", &|(_, o)| o.ordering.as_str().into()),
            ("order_s", &|(_, o)| o.order.into()),
            ("symbolic_s", &|(_, o)| o.symbolic.into()),
            ("numeric_s", &|(_, o)| o.numeric.into()),
            ("two_threads_s", &|(_, o)| o.two_threads.into()),
            ("same_bits", &|(_, o)| o.same_bits.to_string().into()),
            ("solve_s", &|(_, o)| o.solve.into()),
            ("factor_entries", &|(_, o)| o.entries.into()),
            ("factor_stored", &|(_, o)| o.stored.into()),
            ("factor_operations", &|(_, o)| o.operations.into()),
        ],
    )
    .named("orders")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::store::Remake;

    #[test]
    fn meshes_are_kept_and_make_a_part() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), "cost", Effort::Quick, Remake::Never).unwrap();
        assert!(record(&store, &mut Vec::new()).unwrap().is_none());
        measure(&store, FINEST).unwrap();
        let made = record(&store, &mut Vec::new()).unwrap().expect("rows");
        let csv = std::fs::read_to_string(store.path("tables/steps.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + 2 * 3, "{csv}");
        assert!(csv.contains("table, itself") && !csv.contains("NaN"));
        let strain = made
            .requirements
            .iter()
            .find(|r| r.quantity.contains("strain"));
        assert!(strain.is_some_and(|r| r.is_met()));
        assert!(store.path("plots/steps.svg").is_file());
    }
}
