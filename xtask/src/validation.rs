//! `validation`: published experiments and closed forms with the elastic sheet, on several meshes and sizes.

mod cantilevers;
mod creases;
mod curls;
mod elasticas;
mod experiment;
mod forming;
mod gases;
mod limitations;
mod linear;
mod loads;
mod outcome;
mod plastic;
mod plates;
mod rest;
mod rolling;
mod rulings;
mod shells;
mod specimen;
mod squeezed;
mod tension;
mod vibrations;

use crate::interrupt;
use crate::progress::Progress;
use crate::report::{Options, Part, Report, findings, machine, one_of};
use crate::runs::meshes::Grid;
use crate::store::{Files, Kept, Store, Unit};
use anyhow::Result;
use clap::Args;
use experiment::{Experiment, Job, MESHES};
use limitations::Limitations;
use maud::html;
use outcome::{Outcome, SIZES};
use rayon::prelude::*;

/// All of them.
static EXPERIMENTS: [&Experiment; 32] = [
    &cantilevers::END_SHEAR,
    &cantilevers::END_MOMENT,
    &shells::ANNULUS,
    &vibrations::PLATES,
    &vibrations::STRIP,
    &vibrations::ON_EDGE,
    &cantilevers::NARROW,
    &elasticas::HEAVY,
    &elasticas::OFFICE,
    &elasticas::PUSHED,
    &elasticas::LIFTED,
    &squeezed::SQUEEZED,
    &plates::SQUARES,
    &plates::GRAINED,
    &curls::CURLED,
    &curls::RING,
    &plastic::YIELDING,
    &creases::CREASED,
    &gases::ENCLOSED,
    &rulings::RULED,
    &shells::FREE_CYLINDER,
    &shells::CYLINDER,
    &shells::HEMISPHERE,
    &shells::ROOF,
    &shells::TWISTED,
    &tension::PULLED,
    &tension::SAGGING,
    &tension::TWISTED,
    &rolling::ROLLING,
    &loads::IN_TIME,
    &loads::BALANCED,
    &forming::FORMED,
];

fn named() -> Vec<(&'static str, &'static Experiment)> {
    EXPERIMENTS.iter().map(|e| (e.name, *e)).collect()
}

/// Arguments of `validation`.
#[derive(Debug, Args)]
pub(crate) struct ValidationArgs {
    #[command(flatten)]
    options: Options,

    /// Experiments to run, separated by commas, such as end-shear; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(named))]
    experiments: Vec<&'static Experiment>,
}

fn unit(store: &Store, experiment: &Experiment) -> Unit {
    store.unit(format!("validation-{}", experiment.name), experiment.title)
}

/// Runs an experiment on all meshes.
fn make(experiment: &Experiment, store: &Store, files: &mut Files<'_>) -> Result<Outcome> {
    let meshes = store
        .effort
        .quick_or(&[Grid::Aligned, Grid::Delaunay1][..], &MESHES);
    let sizes = store.effort.quick_or(&SIZES[..1], &SIZES);
    let of = |&mesh: &Grid| sizes.iter().map(move |&across| Job { mesh, across });
    let jobs: Vec<Job> = meshes.iter().flat_map(of).collect();
    let bar = Progress::start(experiment.name, jobs.len());
    let one = |job: &Job| experiment.rows(*job).inspect(|_| bar.step());
    let rows: Result<Vec<_>> = jobs.par_iter().with_max_len(1).map(one).collect();
    bar.finish("measured");
    Outcome::new(experiment, rows?.concat(), files)
}

/// Runs the command.
pub(crate) fn run(args: &ValidationArgs) -> Result<()> {
    let store = args.options.open("validation")?;
    let limitations = Limitations::read()?;
    let mut wanted = args.experiments.clone();
    if wanted.is_empty() {
        wanted.extend(EXPERIMENTS);
    }
    let made = wanted.into_iter().try_for_each(|experiment| {
        let outcome = store.keep(&unit(&store, experiment), |files| {
            make(experiment, &store, files)
        })?;
        let found = outcome::findings(experiment, &outcome.rows, store.effort, &limitations);
        let named = found.iter().map(|f| (experiment.name, f));
        println!("{}", findings(experiment.title, named).text());
        interrupt::check()?;
        Ok(())
    });
    interrupt::afterwards(made, || write(&store, &limitations))
}

/// Writes the page and the other files of all experiments done so far.
fn write(store: &Store, limitations: &Limitations) -> Result<()> {
    let units = EXPERIMENTS.iter().map(|e| unit(store, e));
    let mut kept: Kept<Outcome> = store.all_kept(units.collect());
    for outcome in &mut kept.records {
        let found = EXPERIMENTS
            .into_iter()
            .find(|e| e.name == outcome.record.name);
        if let Some(experiment) = found {
            outcome.record.findings =
                outcome::findings(experiment, &outcome.rows, store.effort, limitations);
        }
    }
    let summary = outcome::summary(&EXPERIMENTS, &kept.records);
    println!("{}", summary.text());
    let report = Report {
        name: "validation",
        title: "Published experiments and closed forms",
        introduction: html! {
            p { (INTRODUCTION) }
            p { "Times are seconds of the processor, of runs on one core each. Machine: " (machine()) "." }
            (summary)
        },
        caption: "The largest error of each quantity on all meshes, against what the book claims",
        excerpt: vec![Part::table("summary", &summary)],
    };
    let records = kept.records.into_iter().map(|o| o.record).collect();
    let left_out = kept.left_out;
    report.write(store, Kept { records, left_out })
}

const INTRODUCTION: &str = "Experiments with the elastic sheet whose results are known: each is brought to rest by long \
    damped steps of implicit Euler, or its small vibrations are computed, on an aligned, a union jack and a one-way grid \
    (the last two turned by 22.5 degrees) and on three irregular meshes, with 4, 8 and 16 squares across the smaller side \
    unless the experiment says otherwise. No number is fitted.";
