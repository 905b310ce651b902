//! Bending, creases, and how sheets stretch.

use super::builder::{Builder, PlateMadeOf, at};
use crate::measures::crease_gauge::CreaseGauge;
use crate::measures::targets::DrivenCrease;
use crate::measures::yielding::YieldingCrease;
use crate::placing::in_words::elastic_in_words;
use crate::placing::placed::PlacedSheet;
use crate::sheets::creases::{EdgeFolds, FoldSprings};
use crate::sheets::folding::{FLAT_STIFFNESS, FoldTargets};
use crate::sheets::sheet::{Bending, Elasticity, IsometryKey, RestShape};
use crate::words::error::SceneError;
use crate::words::key::Key;
use isosheet_dynamics::{
    CreaseSprings, ElasticSheet, ElasticSheetError, LineClamp, Patched, PlateBending, PlateEdges,
    PlateLaw, Potential, PotentialOfPart, RigidMotion, SheetModel, Stiffening, start_of_folding,
};
use isosheet_mesh::{EdgeId, MassMatrix, Part, VertexId};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Where a flat sheet of rods starts that folds to angles, by its own numbers, from positions `x`.
fn off_flat(
    own: &PlacedSheet<'_>,
    model: &SheetModel,
    targets: &FoldTargets,
    x: &[f64],
) -> Option<Vec<f64>> {
    let masses = &model.mass().vertex[own.part.vertices.clone()];
    let mass = MassMatrix::from_vertex_masses(masses.to_vec()).ok()?;
    let first = own.part.vertices.start as u32;
    let pins = model.pins().into_iter();
    let pins = pins.filter(|v| own.part.vertices.contains(&v.index()));
    let pins: Vec<VertexId> = pins.map(|v| VertexId(v.0 - first)).collect();
    let driven = targets.creases.iter().map(|(e, angle)| (*e, *angle, 1.0));
    let flat = targets.flat.iter().map(|e| (*e, 0.0, FLAT_STIFFNESS));
    let edges: Vec<_> = driven.chain(flat).collect();
    start_of_folding(&own.form.placed, &mass, &pins, x, &edges)
}

impl Builder<'_> {
    pub(super) fn add_folds(&mut self) -> Result<(), SceneError> {
        let mut modelled = BTreeSet::new();
        for number in 0..self.sheets.list.len() {
            let springs = self.fold_springs(number)?;
            let creases = springs.creases();
            let part = self.sheets.list[number].part.clone();
            self.creased.extend(creases.iter().map(|e| part.edge(*e)));
            modelled.extend(self.add_bending(number, &creases)?);
            self.add_springs(number, springs)?;
        }
        self.modelled
            .extend(modelled.into_iter().map(str::to_owned));
        self.count(self.scene.crease.len(), "crease", "creases");
        if self.targets.folding.is_some() {
            self.modelled.push("folding to given angles".into());
        }
        Ok(())
    }

    pub(super) fn add_potential_of(&mut self, number: usize, potential: impl Potential + 'static) {
        let part = match &self.sheets.list[..] {
            [_] => None,
            list => Some(&list[number].part),
        };
        let model = self.model.take();
        self.model = model.map(|model| match part {
            None => model.with_potential(potential),
            Some(part) => model.with_potential(PotentialOfPart::new(potential, part)),
        });
    }

    pub(super) fn add_bending(
        &mut self,
        number: usize,
        creases: &[EdgeId],
    ) -> Result<Vec<&'static str>, SceneError> {
        let sheet = &self.sheets.list[number];
        let PlacedSheet { of, key, form, .. } = sheet;
        let (of, placed) = (of.clone(), &form.placed);
        let yields = of.yields();
        let laws = sheet.patched.map(|own| own.plate());
        let [key, yield_key] = ["bending", "yield"].map(|name| key.name(name));
        let mut modelled = Vec::new();
        if yields.is_some() {
            modelled.push("bends that stay");
        }
        match (of.bending(), of.plate()) {
            (Bending::Hinges { rigidity }, _) => {
                let springs = CreaseSprings::bending_beside(placed, rigidity, creases);
                let mut springs = springs.map_err(at(&key))?;
                if of.rest == RestShape::Mesh {
                    springs = springs.curved(placed);
                }
                if let Some(yields) = yields {
                    let yielding = springs.with_yield(placed, yields);
                    springs = yielding.map_err(at(&yield_key))?;
                }
                modelled.push("bending stiffness at edges");
                if of.elasticity().is_some() {
                    let law = Patched::everywhere(rigidity.into());
                    self.plate(number, law, creases, &[])?;
                }
                self.add_bends(number, springs)?;
            }
            (_, None) => {}
            (_, Some(ground)) => {
                let law = laws.map(|law| law.clone().unwrap_or_else(|| ground.clone()));
                modelled.push("bending stiffness of a plate");
                let curls = of.curl.is_some();
                let (supports, clamps): (Vec<usize>, Vec<LineClamp>) =
                    self.line_clamps(number).into_iter().unzip();
                self.origins.clamps.extend(supports);
                let own = self.plate(number, law, creases, &clamps)?;
                if curls {
                    modelled.push("curl");
                }
                self.add_bends(number, own)?;
            }
        }
        if self.sheets.list[number].of.stiffening.is_some() {
            modelled.push("stiffness that changes");
        }
        Ok(modelled)
    }

    /// Adds what resists bending, with the factor by which it changes.
    fn add_bends(
        &mut self,
        number: usize,
        potential: impl Potential + 'static,
    ) -> Result<(), SceneError> {
        let PlacedSheet { of, key, .. } = &self.sheets.list[number];
        match &of.stiffening {
            None => self.add_potential_of(number, potential),
            Some(factor) => {
                let factor = Stiffening::new(potential, factor.as_given());
                let stiffening = factor.map_err(at(&key.name("stiffening")))?;
                self.add_potential_of(number, stiffening);
            }
        }
        Ok(())
    }

    pub(super) fn clamped(&self, number: usize) -> Vec<VertexId> {
        let part = &self.sheets.list[number].part;
        let pins = self.model().pins().into_iter();
        let own = pins.filter(|v| part.vertices.contains(&v.index()));
        own.map(|v| part.local_vertex(v)).collect()
    }

    pub(super) fn line_clamps(&self, number: usize) -> Vec<(usize, LineClamp)> {
        let part = &self.sheets.list[number].part;
        let of_clamp = |(support, vertices, motion): &(usize, Vec<VertexId>, RigidMotion)| {
            let own = vertices
                .iter()
                .filter(|v| part.vertices.contains(&v.index()));
            let clamp = LineClamp {
                vertices: own.map(|v| part.local_vertex(*v)).collect(),
                positions: self.held_positions(*support)[part.coordinates()].to_vec(),
                motion: motion.clone(),
            };
            (!clamp.vertices.is_empty()).then_some((*support, clamp))
        };
        self.clamps.iter().filter_map(of_clamp).collect()
    }

    pub(super) fn plate(
        &mut self,
        number: usize,
        law: Patched<PlateLaw>,
        creases: &[EdgeId],
        clamps: &[LineClamp],
    ) -> Result<Arc<PlateBending>, SceneError> {
        let clamped = self.clamped(number);
        let PlacedSheet {
            of,
            key,
            form,
            patched,
            ..
        } = &self.sheets.list[number];
        let placed = &form.placed;
        let held = |law: &Patched<PlateLaw>, pinned: &[VertexId], creases: &[EdgeId]| {
            let edges = PlateEdges {
                pinned,
                creases,
                clamps,
            };
            PlateBending::patched(placed, law, &edges).map_err(at(&key.name("bending")))
        };
        let (curl, yields) = (of.natural_curvature(), of.yields());
        let stays_flat = curl.is_none() && of.rest == RestShape::Flat && yields.is_none();
        let plate = if stays_flat && clamps.is_empty() {
            let made_of = (law, clamped, creases.to_vec());
            let make =
                |(law, clamped, creases): &PlateMadeOf| held(law, clamped, creases).map(Arc::new);
            self.kept.plates.get(number, made_of, make)?
        } else {
            let mut plate = held(&law, &clamped, creases)?;
            if of.rest == RestShape::Mesh {
                plate = plate.curved(placed);
            }
            if let Some(curl) = curl {
                let curled = match &form.curled {
                    Some(shape) => plate.curled_as(placed, shape, curl.profile),
                    None => plate.with_curl(placed, curl),
                };
                plate = curled.map_err(at(&key.name("curl")))?;
            }
            if let Some(yields) = yields {
                let yields = patched.map(|own| own.yields().unwrap_or(yields));
                let yielding = plate.with_yields(placed, &yields);
                plate = yielding.map_err(at(&key.name("yield")))?;
            }
            Arc::new(plate)
        };
        self.plates.insert(number, Arc::clone(&plate));
        Ok(plate)
    }

    pub(super) fn fold_springs(&mut self, number: usize) -> Result<FoldSprings, SceneError> {
        let mut springs = FoldSprings::default();
        let own = &self.sheets.list[number];
        let is_own = |name: Option<&str>, key: &Key, what| {
            self.sheets
                .one(name, key, what)
                .map(|named| std::ptr::eq(named, own))
        };
        for (k, crease) in self.scene.crease.iter().enumerate() {
            let key = Key::root().name("crease").entry(k);
            if is_own(crease.sheet.as_deref(), &key, "the edges")? {
                let found = crease.springs(&key, &own.form.unplaced, own.form.roles.as_ref())?;
                let driven = DrivenCrease::of((k, crease), &found, |e| own.part.edge(e));
                self.targets.creases.extend(driven);
                let yielding = YieldingCrease::of((k, crease), &found, |e| own.part.edge(e));
                self.targets.yielding.extend(yielding);
                springs.add(key, crease.folds(), found);
            }
        }
        if let Some(folding) = &self.scene.folding {
            let key = Key::root().name("folding");
            if is_own(folding.sheet.as_deref(), &key, "the creases")? {
                let (mesh, refined) = (&own.of.mesh, &own.form.unplaced);
                let mut targets = folding.targets(&key, mesh, refined, &mut self.kept.files)?;
                let model = self.model.as_ref().expect("it is there between changes");
                let x = &mut self.x[own.part.coordinates()];
                if own.of.isometry() == IsometryKey::Rods
                    && let Some(start) = off_flat(own, model, &targets, x)
                {
                    x.copy_from_slice(&start);
                    self.modelled
                        .push("a start off the flat state, towards the angles".into());
                }
                let [driven, flat] = folding.springs(&targets, &own.of, &own.form.placed, x);
                springs.add(key.clone(), EdgeFolds::Yes, driven);
                springs.add(key, EdgeFolds::No, flat);
                targets.renumber(|e| own.part.edge(e));
                self.targets.folding = Some(targets);
            }
        }
        springs.put_in_sheet(&own.form.placed, own.of.bending().rigidity());
        Ok(springs)
    }

    pub(super) fn add_springs(
        &mut self,
        number: usize,
        springs: FoldSprings,
    ) -> Result<(), SceneError> {
        let named = self.scene.crease.iter().enumerate();
        let named = named.filter_map(|(k, crease)| {
            Some((Key::root().name("crease").entry(k), crease.name.clone()?))
        });
        let named: Vec<(Key, String)> = named.collect();
        let mut all = Vec::new();
        for (key, springs) in springs.into_groups() {
            let PlacedSheet { form, part, .. } = &self.sheets.list[number];
            let lengths = springs
                .iter()
                .map(|s| form.placed.lengths()[s.edge.index()]);
            let measured = (0..).zip(lengths).collect();
            let springs = CreaseSprings::new(form.placed.topology(), springs);
            let springs = Arc::new(springs.map_err(at(&key))?);
            let gauge = CreaseGauge {
                springs: Arc::clone(&springs),
                measured,
                part: part.clone(),
                potential: self.model().potentials().count(),
                others: Vec::new(),
            };
            if let Some((_, name)) = named.iter().find(|(known, _)| *known == key) {
                self.creases.named.insert(name.clone(), gauge);
            } else if key == Key::root().name("folding") && self.creases.folded.is_none() {
                // The springs of the creases come before the springs that keep edges flat.
                let targets = self.targets.folding.clone();
                self.creases.folded = targets.map(|targets| (gauge, targets));
            }
            all.push((Arc::clone(&springs), self.model().potentials().count()));
            self.add_potential_of(number, springs);
        }
        let folded = self.creases.folded.iter_mut().map(|(gauge, _)| gauge);
        for gauge in self.creases.named.values_mut().chain(folded) {
            gauge.find_others(&all);
        }
        Ok(())
    }

    /// The sheets that are elastic, with the slack of their plates where these are there already.
    fn elastic_sheets(&self) -> Result<Vec<(ElasticSheet, Part)>, SceneError> {
        let mut elastic = Vec::new();
        for (number, placed) in self.sheets.list.iter().enumerate() {
            let PlacedSheet { of, key, part, .. } = placed;
            let Some(elasticity) = of.elasticity() else {
                continue;
            };
            let key = key.name(match of.isometry {
                Some(_) => "isometry",
                None => "material",
            });
            let plate = self.plates.get(&number).map(Arc::as_ref);
            let sheet = elastic_sheet(placed, elasticity, plate);
            let mut sheet = sheet.map_err(at(&key))?;
            if let Some(swell) = &of.swell {
                let swollen = sheet.with_swelling(swell.as_given());
                sheet = swollen.map_err(at(&placed.key.name("swell")))?;
            }
            elastic.push((sheet, part.clone()));
        }
        Ok(elastic)
    }

    /// Gives the model the elasticity of the sheets that have it, so that the others alone are of rods.
    pub(super) fn part_rods(&mut self) -> Result<(), SceneError> {
        let elastic = self.elastic_sheets()?;
        self.add_elastic(elastic)
    }

    fn add_elastic(&mut self, elastic: Vec<(ElasticSheet, Part)>) -> Result<(), SceneError> {
        if elastic.is_empty() {
            return Ok(());
        }
        let key = Key::root().name("sheet");
        let faces = self.model().topology().face_count();
        let elastic = ElasticSheet::union(elastic, faces);
        self.change(|m| m.with_elastic_sheet(elastic), at(&key))
    }

    pub(super) fn add_isometry(&mut self) -> Result<(), SceneError> {
        let elastic = self.elastic_sheets()?;
        let swells = |placed: &PlacedSheet<'_>| placed.of.swell.is_some();
        if self.sheets.list.iter().any(swells) {
            self.modelled.push("swelling".into());
        }
        for (sheet, _) in &elastic {
            let words = elastic_in_words(sheet);
            if !self.modelled.contains(&words) {
                self.modelled.push(words);
            }
        }
        if elastic.len() < self.sheets.list.len() {
            self.modelled.push("rigid rods".into());
        }
        self.add_elastic(elastic)
    }
}

fn elastic_sheet(
    sheet: &PlacedSheet<'_>,
    ground: Elasticity,
    plate: Option<&PlateBending>,
) -> Result<ElasticSheet, ElasticSheetError> {
    let placed = &sheet.form.placed;
    let all = sheet.patched.map(|own| own.elasticity());
    let all = all.map(|own| own.clone().unwrap_or_else(|| ground.clone()));
    let laws = all.map(|own| own.law.clone());
    let sheet = ElasticSheet::patched(placed, &laws)?.with_limit(ground.limit)?;
    Ok(match plate {
        Some(plate) => sheet.beside(placed, plate),
        None => sheet,
    })
}
