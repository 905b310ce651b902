//! What to know of a run before its results are used.

use super::{ElasticSummary, Summary};
use isosheet_mesh::wording::{brief, given};
use isosheet_scenes::Warning;

impl Summary {
    /// Part by which the chord of the sharpest bend of an elastic sheet may be shorter than its arc before
    /// the mesh counts as too coarse: one percent, 0.49 radians over a face.
    pub const CHORD_ERROR: f64 = 0.01;

    /// Part of the largest energy exchanged that errors of the balance may give to a run: second-order
    /// methods err by about that at the longest steps that resolve a motion.
    pub const ENERGY_GAIN: f64 = 0.02;
    /// Part of the forces of the supports that their balance may leave: three times what the tolerance of the
    /// steps leaves of the forces on a sheet at most.
    pub const UNBALANCED: f64 = 0.1;

    /// Part by which the mesh may change the forces of bends.
    pub const FORCE_ERROR: f64 = 0.03;

    /// Length of edges, by `(R t)^1/2`, up to which deflections of shells are right to 3 %
    /// (`cargo xtask validation`: cylinders, a roof and a hemisphere under loads at points and on areas).
    pub const SHELL_EDGE: f64 = 0.4;

    /// Part of the elastic energy that the slack of bends may have in a sheet that is stretched more than
    /// bent.
    pub const SLACK: f64 = 0.05;

    /// Part of the area on which the limit of the strain may act at the end.
    ///
    /// Measured with cloths that rest on a ball (`docs/isometry.md`): limits that act on 2 to 33 % of the
    /// area change the mean height by 1 % at most, limits that act on 64, 74 and 94 % by 4, 7 and 9 %.
    pub const AT_LIMIT: f64 = 0.5;

    /// Part by which steps may make a vibration slower.
    pub const SLOWING: f64 = 0.03;

    /// Angle between sheet and relative wind, degrees, from which real flow separates from a sheet.
    pub const SEPARATION: f64 = 15.0;

    /// What to know before the results are used.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let sharpest = self.elastic.and_then(|elastic| elastic.sharpest);
        if let Some(bend) = sharpest.filter(|bend| bend.shortening() > Self::CHORD_ERROR) {
            let message = format!(
                "the mesh is too coarse for the bends: the sheet bends over a single face by {bend}, whose chord is {} % \
                 shorter than its arc",
                brief(100.0 * bend.shortening())
            );
            let remedy = "refine the mesh there, or all of it by `sheet.refine` (of `drape`, `hang` and `crumple` \
                          `--refine`): with half the edge length the error is a quarter; the page colours faces by their \
                          strain and by the share of stretching in their energy";
            warnings.push(Warning::new(message, remedy));
        }
        let at_rest = self.elastic.and_then(|elastic| elastic.at_rest);
        if let Some(bend) = at_rest.filter(|bend| bend.coarseness() > Self::SHELL_EDGE) {
            let [x, y, z] = bend.at.map(brief);
            let message = format!(
                "the mesh is too coarse for how the sheet is curved at rest: edges near ({x}, {y}, {z}) m are {} m long, {} \
                 times (R t)^1/2 with the radius R = {} m and the thickness t = {} m, the length over which it bends at its \
                 edges and where forces act on it; shells are right to 3 % with edges of {} m",
                brief(bend.size),
                brief(bend.coarseness()),
                brief(bend.radius),
                brief(bend.thickness),
                brief(Self::SHELL_EDGE * bend.bending_length()),
            );
            let remedy = "refine the mesh there; for a sheet that only rolls up or unrolls as a whole it may stay as it is";
            warnings.push(Warning::new(message, remedy));
        }
        // Where a sheet mostly bends, its forces come from the bends.
        let is_stretched = |e: &ElasticSummary| e.share > 0.5 && e.slack > Self::SLACK;
        let slack = self.elastic.filter(is_stretched);
        if let Some(elastic) = slack.filter(|_| self.ending.is_squeezed()) {
            let message = format!(
                "the mesh is too coarse for forces of supports that pull against each other: {} % of the elastic energy \
                 at the end is in the slack that faces have where they bend",
                brief(100.0 * elastic.slack)
            );
            let remedy = "refine the mesh: with half the edge length the slack is a quarter";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some(elastic) = self.elastic.filter(|e| e.at_limit > Self::AT_LIMIT) {
            let message = format!(
                "the limit of the strain, {} %, decides where the sheet is at the end: it acts on {} % of the area",
                brief(100.0 * elastic.limit),
                brief(100.0 * elastic.at_limit)
            );
            let remedy = "allow more, `sheet.isometry.elastic.limit`: chords of bends are shorter than arcs, which counts as \
                          strain; or refine the mesh";
            warnings.push(Warning::new(message, remedy));
        }
        let bend = self.elastic.and_then(|elastic| elastic.at_end);
        let bend = bend.filter(|bend| bend.force_error() > Self::FORCE_ERROR);
        if let Some(bend) = bend.filter(|_| self.ending.is_squeezed()) {
            let message = format!(
                "forces of bends err by up to {} %: the sheet bends over a single face by {bend}",
                brief(100.0 * bend.force_error())
            );
            let remedy = "refine the mesh there if forces matter: with half the edge length the error is a quarter";
            warnings.push(Warning::new(message, remedy));
        }
        let (gain, exchanged) = (self.energy.largest_gain, self.energy.largest_exchange);
        if gain > Self::ENERGY_GAIN * exchanged + self.energy.round_off {
            let message = format!(
                "the balance of the energy gains {} J, {} % of what was exchanged",
                brief(gain),
                brief(100.0 * gain / exchanged)
            );
            let remedy = "take a smaller `method.step`: forces that change within a step do work that is known roughly; \
                          the history says when energy is gained";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some(balance) = self.balance.filter(|b| b.part() > Self::UNBALANCED) {
            let message = format!(
                "the forces of the supports do not balance what acts on the sheet: {balance} are left"
            );
            let remedy = "take a smaller `method.step`, or a smaller tolerance, before you trust `loads.csv`";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some((error, asked)) = self.time_error.and_then(|e| Some((e, e.unmet()?))) {
            let message = format!(
                "the accuracy asked for, {} m a step, is not met: the largest estimated error of a step is {error}",
                given(asked)
            );
            let remedy = "allow a smaller `method.min_fraction`";
            warnings.push(Warning::new(message, remedy));
        }
        let vibration = self.vibration.filter(|v| v.slowing() > Self::SLOWING);
        if let Some(vibration) = vibration {
            let message = format!(
                "steps of {} s are too long for a vibration of the sheet, {vibration}: they lower its frequency by about {} % \
                 and damp it; with `method.step = {}` its frequency is right to 1 %",
                brief(vibration.step),
                brief(100.0 * vibration.slowing()),
                brief(vibration.step_for(0.01)),
            );
            let remedy = "take a smaller `method.step`, or ask for a `method.accuracy`, if the vibration matters; the state of \
                          rest does not depend on the step";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some(incidence) = self.incidence.filter(|i| i.angle > Self::SEPARATION) {
            let message = format!(
                "the air comes to the sheet at up to {incidence}, on the mean of its faces: real flow separates from {} \
                 degrees on, and has less lift than attached flow",
                Self::SEPARATION
            );
            let remedy = "keep to smaller angles, or leave out `air.attached`: the drag across faces holds for separated \
                          flow";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some(f) = self.ending.residuals.folding.filter(|f| f.wrong_side > 0) {
            let message = format!(
                "{} of {} creases are folded to their wrong side: the sheet folds along another branch",
                f.wrong_side, f.creases
            );
            let remedy = "where rigid panels do not close at the angles, name what the sheet is made of, \
                          `sheet.material`, and divide its panels by `sheet.refine`; or start nearer to the fold, \
                          `sheet.start.file`";
            warnings.push(Warning::new(message, remedy));
        }
        warnings
    }
}
