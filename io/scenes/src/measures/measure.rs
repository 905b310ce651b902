//! Numbers that are read off the sheet at each step.

use crate::loads::enclosed::{EnclosedGauge, OfEnclosed};
use crate::loads::forces::Forces;
use crate::measures::crease_gauge::{CreaseGauge, CreaseGauges, OfCrease};
use crate::measures::facing::Facing;
use crate::meshes::selection::Selection;
use crate::placing::placed::PlacedSheets;
use crate::placing::placed_bodies::PlacedBodies;
use crate::sheets::creases::Crease;
use crate::sheets::fold_group::FoldGroup;
use crate::sheets::folding::Folding;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::plain_name::check_name;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_dynamics::Memories;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashSet};

/// A number that is read off the sheet at the start and after each step: how deep a tip hangs, how far a
/// corner is from its place, how wide a fold is, how far a crease is folded and what moment that takes. A run
/// writes it to `measures.csv`, and its last, least and largest value to `summary.json` as `measures.NAME`.
///
/// ```toml
/// [[measure]]
/// name = "tip"
/// at = { nearest = [[0.2, 0, 0]] }
/// quantity = "z"
///
/// [[measure]]
/// name = "width"
/// at = { vertices = [0] }
/// quantity = { distance_to = { vertices = [8] } }
///
/// [[crease]]
/// name = "lid"
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
///
/// [[measure]]
/// name = "lid-moment"
/// crease = "lid"
/// quantity = "moment"
/// ```
///
/// Creases that `[folding]` folds are named as in its `order`: `fold = "valleys"` or
/// `fold = { edges = [3, 7] }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Its name, of letters, digits, `_` and `-`.
    pub name: String,
    /// The name of the sheet, if there are several and not the vertices of all are meant; or of a body, for
    /// the vertices of its surface.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which vertices. The run measures their mean place. Leave it out for a crease.
    #[serde(default)]
    pub at: Option<Selection>,
    /// The name of a `[[crease]]` whose angle or moment is measured.
    #[serde(default)]
    pub crease: Option<String>,
    /// Creases of the pattern that `[folding]` folds, whose angle or moment is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold: Option<FoldGroup>,
    /// The name of a `[[forces.gas]]`, or of a `[[forces.pressure]]`, whose pressure or volume is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub enclosed: Option<String>,
    /// What is measured of it.
    pub quantity: Quantity,
}

/// What is measured: of the mean place of some vertices, metres, of a crease, or of what a surface encloses.
///
/// ```toml
/// [[measure]]
/// name = "corner"
/// at = { vertices = [0] }
/// quantity = { distance_to_point = [0, 0, 0] }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Quantity {
    /// Its x coordinate.
    X,
    /// Its y coordinate.
    Y,
    /// Its z coordinate.
    Z,
    /// Its distance from where it was at the start.
    Displacement,
    /// Its distance from a point (metres).
    DistanceToPoint([f64; 3]),
    /// Its distance from the mean place of other vertices.
    DistanceTo(Selection),
    /// The angle between two parts of a sheet, degrees: between the flanges of a bent blank, or the ends of a
    /// strip. A part has the faces whose corners are all among the vertices. It faces along its vector area,
    /// the sum of `(b - a) x (c - a) / 2` over its faces. The angle is 0 in a flat sheet, and 180 where one
    /// part is folded onto the other; beyond that it falls again.
    AngleTo(Selection),
    /// The fold angle of a crease, degrees: the mean over its length. It is the kink of the crease: it
    /// excludes the bend of a sheet over the faces beside it, which the angle between these faces includes.
    /// It is 0 for flat, positive for a valley and negative for a mountain, and goes on beyond 180 degrees
    /// where a crease is pressed through itself.
    FoldAngle,
    /// The moment that it takes to hold a crease at its angle, newton metres: its stiffness times its length
    /// times the angle from where it rests, in radians. It is positive where the crease is folded further to
    /// a valley than it would be by itself.
    Moment,
    /// The moment by the length of the crease, N.
    MomentPerLength,
    /// The pressure of a gas, pascals above vacuum.
    Pressure,
    /// The pressure of a gas less that outside, or a pressure that is prescribed, pascals.
    GaugePressure,
    /// The volume that a surface encloses around a gas, or on whose faces a pressure is prescribed, cubic
    /// metres.
    Volume,
}

/// What a scene has that measures are of: creases, a folding and forces.
type OfScene<'a> = (&'a [Crease], Option<&'a Folding>, &'a Forces);

impl Measure {
    /// Checks it as one of a scene with these creases, folding and forces.
    pub(crate) fn check(&self, key: &Key, of: OfScene<'_>, checks: &mut Checks) {
        check_name(&self.name, key.name("name"), "a measure", checks);
        self.check_of(key, of, checks);
        if let Quantity::DistanceToPoint(point) = &self.quantity {
            checks.finite(key.name("quantity.distance_to_point"), point, Unit::Metre);
        }
    }

    /// Checks that it is of vertices or of a crease, as its quantity wants it.
    fn check_of(&self, key: &Key, (creases, folding, forces): OfScene<'_>, checks: &mut Checks) {
        let of_crease = self.quantity.of_crease().is_some();
        if self.sheet.is_some() && of_crease {
            let message = "a crease is of one sheet";
            checks.report(key.name("sheet"), message, "leave it out");
        }
        if self.quantity.of_enclosed().is_some() {
            return self.check_enclosed(key, forces, checks);
        }
        if self.enclosed.is_some() {
            let message = "this quantity is none of what a surface encloses";
            let remedy =
                "measure `pressure`, `gauge_pressure` or `volume`, or leave out `enclosed`";
            checks.report(key.name("quantity"), message, remedy);
        }
        match (&self.at, &self.crease, &self.fold) {
            (Some(_), None, None) if !of_crease => {}
            (None, None, Some(group)) if of_crease => {
                group.check(&key.name("fold"), checks);
                if folding.is_none() {
                    let message = "the scene has no `[folding]`, whose creases these are";
                    let remedy = "name a `[[crease]]` by `crease`";
                    checks.report(key.name("fold"), message, remedy);
                }
            }
            (None, Some(name), None) if of_crease => {
                let names = || creases.iter().filter_map(|crease| crease.name.as_ref());
                if !names().any(|known| known == name) {
                    let known: Vec<String> = names().map(|name| format!("`{name}`")).collect();
                    let remedy = match known.is_empty() {
                        true => {
                            format!("give the crease that is meant this name, `name = \"{name}\"`")
                        }
                        false => format!("give one of these: {}", known.join(", ")),
                    };
                    let message = format!("no crease has the name `{name}`");
                    checks.report(key.name("crease"), message, remedy);
                }
            }
            _ => {
                let (quantity, wanted) = match of_crease {
                    true => (
                        "of a crease",
                        "`crease` with its name, or `fold` with creases of `[folding]`, and leave out `at`",
                    ),
                    false => (
                        "of vertices",
                        "`at` with the vertices, and leave out `crease` and `fold`",
                    ),
                };
                let message = format!("this quantity is one {quantity}");
                checks.report(key.name("quantity"), message, format!("write {wanted}"));
            }
        }
    }

    /// Checks that it is of a gas or of a pressure that has its quantity.
    fn check_enclosed(&self, key: &Key, forces: &Forces, checks: &mut Checks) {
        let others = [
            ("sheet", self.sheet.is_some()),
            ("at", self.at.is_some()),
            ("crease", self.crease.is_some()),
            ("fold", self.fold.is_some()),
        ];
        for (name, _) in others.iter().filter(|(_, is_given)| *is_given) {
            let message = "this quantity is one of what a surface encloses";
            checks.report(key.name(name), message, "leave it out");
        }
        let gases = || forces.gas.iter().filter_map(|gas| gas.name.as_ref());
        let pressures = || forces.pressure.iter().filter_map(|p| p.name.as_ref());
        let known: Vec<String> = match self.quantity {
            Quantity::Pressure => gases().map(|name| format!("`{name}`")).collect(),
            _ => gases()
                .chain(pressures())
                .map(|name| format!("`{name}`"))
                .collect(),
        };
        let is_known = |name: &String| known.contains(&format!("`{name}`"));
        if self.enclosed.as_ref().is_some_and(is_known) {
            return;
        }
        let remedy = match known.is_empty() {
            true => "give the `[[forces.gas]]` that is meant a name, and write it as `enclosed`"
                .to_owned(),
            false => format!("give one of these: {}", known.join(", ")),
        };
        match &self.enclosed {
            None => {
                let message = "this quantity is one of what a surface encloses, and none is named";
                checks.report(key.name("quantity"), message, remedy);
            }
            Some(name) => {
                let message = format!("nothing that has this quantity has the name `{name}`");
                checks.report(key.name("enclosed"), message, remedy);
            }
        }
    }

    /// With the vertices or the creases that it is of.
    pub(crate) fn gauge(
        &self,
        key: &Key,
        sheets: &PlacedSheets<'_>,
        bodies: &PlacedBodies<'_>,
        things: Measurable<'_>,
    ) -> Result<Gauge, Problem> {
        let name = self.name.clone();
        let creases = things.creases;
        if let Some((enclosed, of)) = self.enclosed.as_ref().zip(self.quantity.of_enclosed()) {
            let gauge = things.enclosed[enclosed].clone();
            if of == OfEnclosed::Volume && !gauge.is_closed() {
                let message = format!("the faces of the pressure `{enclosed}` enclose no volume");
                let remedy = "measure `gauge_pressure`, or close the surface";
                return Err(Problem::new(key.name("quantity"), message, remedy));
            }
            let of = Reading::Enclosed(gauge, of);
            return Ok(Gauge { name, of });
        }
        if let Some((group, of)) = self.fold.as_ref().zip(self.quantity.of_crease()) {
            let crease = creases.of_group(group, &key.name("fold"))?;
            let of = Reading::Crease(crease, of);
            return Ok(Gauge { name, of });
        }
        if let Some((crease, of)) = self.crease.as_ref().zip(self.quantity.of_crease()) {
            let crease = creases.named[crease].clone();
            let of = Reading::Crease(crease, of);
            return Ok(Gauge { name, of });
        }
        let sheet = self.sheet.as_deref();
        let start = [&sheets.start[..], &bodies.surface_positions()].concat();
        let find =
            |selection: &Selection, key: &Key| match sheet.and_then(|name| bodies.named(name)) {
                Some(body) => body.vertices_at(selection, &key.name("at")),
                None => sheets.vertices(sheet, selection, key),
            };
        let at = self.at.as_ref().unwrap_or(&Selection::All);
        let vertices = find(at, key)?;
        if let Quantity::AngleTo(others) = &self.quantity {
            if sheet.is_some_and(|name| bodies.named(name).is_some()) {
                let message = "the angle is one between parts of sheets, and this is a body";
                let remedy = "name a sheet";
                return Err(Problem::new(key.name("sheet"), message, remedy));
            }
            let other_key = key.name("quantity.angle_to");
            let others = find(others, &other_key)?;
            let faces = sheets.union.topology().faces();
            let parts = [(&vertices, key.name("at")), (&others, other_key)];
            let [one, other] =
                parts.map(|(corners, key)| Facing::new(corners, faces, &sheets.start, &key));
            let of = Reading::Angle(one?, other?);
            return Ok(Gauge { name, of });
        }
        let of = match &self.quantity {
            Quantity::Y => Place::Coordinate(1),
            Quantity::Z => Place::Coordinate(2),
            Quantity::Displacement => Place::From(mean(&vertices, &start)),
            Quantity::DistanceToPoint(point) => Place::From((*point).into()),
            Quantity::DistanceTo(others) => {
                let key = key.name("quantity.distance_to");
                Place::FromVertices(find(others, &key)?)
            }
            _ => Place::Coordinate(0),
        };
        let of = Reading::Place(vertices, of);
        Ok(Gauge { name, of })
    }
}

impl Quantity {
    /// What it is of a crease, if it is of one.
    fn of_crease(&self) -> Option<OfCrease> {
        match self {
            Self::FoldAngle => Some(OfCrease::Angle),
            Self::Moment => Some(OfCrease::Moment),
            Self::MomentPerLength => Some(OfCrease::MomentPerLength),
            _ => None,
        }
    }

    /// What it is of what a surface encloses, if it is of that.
    fn of_enclosed(&self) -> Option<OfEnclosed> {
        match self {
            Self::Pressure => Some(OfEnclosed::Pressure),
            Self::GaugePressure => Some(OfEnclosed::GaugePressure),
            Self::Volume => Some(OfEnclosed::Volume),
            _ => None,
        }
    }

    /// The unit of its values.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::FoldAngle | Self::AngleTo(_) => "degrees",
            Self::Moment => "N m",
            Self::MomentPerLength => "N",
            Self::Pressure | Self::GaugePressure => "Pa",
            Self::Volume => "m3",
            _ => "m",
        }
    }
}

/// Refuses names that stand twice.
pub(crate) fn check_names(measures: &[Measure], root: &Key, checks: &mut Checks) {
    let mut names = HashSet::new();
    for (k, measure) in measures.iter().enumerate() {
        if !names.insert(&measure.name) {
            checks.report(
                root.name("measure").entry(k).name("name"),
                format!("another measure has the name `{}`", measure.name),
                "give each measure a name of its own",
            );
        }
    }
}

/// A [`Measure`] with what it is of.
#[derive(Clone, Debug)]
pub struct Gauge {
    /// Its name.
    pub name: String,
    of: Reading,
}

#[derive(Clone, Debug)]
enum Reading {
    /// Of the mean place of these vertices.
    Place(Vec<VertexId>, Place),
    /// The angle between these parts.
    Angle(Facing, Facing),
    Crease(CreaseGauge, OfCrease),
    Enclosed(EnclosedGauge, OfEnclosed),
}

/// What measures may be of besides vertices.
#[derive(Clone, Copy)]
pub(crate) struct Measurable<'a> {
    pub(crate) creases: &'a CreaseGauges,
    pub(crate) enclosed: &'a BTreeMap<String, EnclosedGauge>,
}

#[derive(Clone, Debug)]
enum Place {
    /// By its number.
    Coordinate(usize),
    /// The distance from a point.
    From(Vector3<f64>),
    /// The distance from the mean place of these vertices.
    FromVertices(Vec<VertexId>),
}

impl Gauge {
    /// The measures that every gas has.
    pub(crate) fn of_gas(called: &str, gas: &EnclosedGauge) -> [Self; 3] {
        OfEnclosed::ALL.map(|of| Self {
            name: format!("{called}.{}", of.name()),
            of: Reading::Enclosed(gas.clone(), of),
        })
    }

    /// The unit of what it shows.
    pub fn unit(&self) -> &'static str {
        match &self.of {
            Reading::Crease(_, OfCrease::Angle) | Reading::Angle(..) => "degrees",
            Reading::Crease(_, OfCrease::Moment) => "N m",
            Reading::Crease(_, OfCrease::MomentPerLength) => "N",
            Reading::Enclosed(_, of) => of.unit(),
            Reading::Place(..) => "m",
        }
    }

    /// What it shows at time `t` (seconds), at positions `x` (`3V`, metres) of the sheets and of the surfaces
    /// of bodies, where the potentials of the model remember this.
    pub fn value(&self, t: f64, x: &[f64], memories: &Memories) -> f64 {
        match &self.of {
            Reading::Crease(crease, of) => crease.value(*of, t, x, memories),
            Reading::Enclosed(enclosed, of) => enclosed.value(*of, t, x),
            Reading::Angle(one, other) => one.angle_to(other, x),
            Reading::Place(vertices, of) => {
                let place = mean(vertices, x);
                match of {
                    Place::Coordinate(k) => place[*k],
                    Place::From(point) => (place - point).norm(),
                    Place::FromVertices(others) => (place - mean(others, x)).norm(),
                }
            }
        }
    }
}

/// The mean place of vertices at positions `x`.
fn mean(vertices: &[VertexId], x: &[f64]) -> Vector3<f64> {
    let points = x.as_chunks::<3>().0;
    let sum: Vector3<f64> = vertices
        .iter()
        .map(|v| Vector3::from(points[v.index()]))
        .sum();
    sum / vertices.len() as f64
}
