//! Checkpoints.

use crate::SheetModel;
use crate::engine::substeps::ByMethod;
use crate::report::checkpoint_error::{CheckpointError, check_finite};
use crc::{CRC_32_ISO_HDLC, CRC_64_XZ, Crc};
use serde::{Deserialize, Serialize};

/// Format version; it grows with every change of the fields.
const VERSION: u32 = 21;

/// First bytes of a checkpoint file.
const MAGIC: &[u8; 8] = b"isosheet";

/// All data of a simulation but model and contact, which [`Simulation::resume`](crate::Simulation::resume)
/// takes again. A resumed simulation continues bit for bit.
///
/// # Format
/// [`Checkpoint::to_bytes`]: the eight bytes `isosheet`, the version (little-endian `u32`), the fields in
/// `postcard` encoding, the CRC-32 of all that (little-endian `u32`). [`Checkpoint::to_json`]: the same
/// fields by name.
///
/// ```
/// use isosheet_dynamics::{Checkpoint, Method, SheetModel, Simulation, State};
/// use isosheet_mesh::{MassKind, VertexId, generate};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.21)?;
/// let model = || -> Result<SheetModel, isosheet_dynamics::ModelError> {
///     SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?.with_gravity().with_pins(&[VertexId(20)])
/// };
/// let start = State::at_rest(sheet.positions().to_vec());
/// let mut simulation = Simulation::new(model()?, start, Method::default())?;
/// simulation.step(1.0 / 60.0)?;
///
/// let bytes = simulation.checkpoint().to_bytes()?;
/// let mut resumed = Simulation::resume(model()?, None, Checkpoint::from_bytes(&bytes)?)?;
/// assert_eq!(resumed.step(1.0 / 60.0)?, simulation.step(1.0 / 60.0)?);
/// assert_eq!(resumed.state(), simulation.state());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    version: u32,
    pub(crate) sheet: SheetFingerprint,
    pub(crate) energy: EnergySums,
    pub(crate) motion: EngineState,
    pub(crate) note: Vec<u8>,
}

/// State of the engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum EngineState {
    /// A method of this crate.
    Method(Box<ByMethod>),
    /// An engine from outside: its name, and what it keeps.
    Other { name: String, bytes: Vec<u8> },
}

/// Sums of the energy balance since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EnergySums {
    /// Total energy at the start, joules.
    pub(crate) start: f64,
    /// Work done on the sheet, joules.
    pub(crate) work: f64,
    /// Energy taken out by velocity damping, joules.
    pub(crate) dissipated: f64,
    /// Energy lost to friction and impacts, joules.
    pub(crate) friction: f64,
    /// Energy dissipated by plastic bending, joules.
    pub(crate) plastic: f64,
}

/// Sizes and checksums of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SheetFingerprint {
    vertices: usize,
    edges: usize,
    connectivity: u64,
    /// Rest lengths, and what keeps them.
    lengths: u64,
    masses: u64,
    supports: u64,
}

impl EnergySums {
    /// Refuses sums that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        let Self {
            start,
            work,
            dissipated,
            friction,
            plastic,
        } = *self;
        check_finite(
            "sums of energies",
            &[start, work, dissipated, friction, plastic],
        )
    }
}

impl SheetFingerprint {
    /// Of a model as its user built it.
    pub(crate) fn of(model: &SheetModel) -> Self {
        let crc = Crc::<u64>::new(&CRC_64_XZ);
        let sum = |bytes: &mut dyn Iterator<Item = u64>| {
            let mut digest = crc.digest();
            bytes.for_each(|b| digest.update(&b.to_le_bytes()));
            digest.finalize()
        };
        let (edges, mass) = (model.edges(), model.mass());
        let faces = model.topology().faces().iter();
        let edge_mass = mass.edge.iter().flatten();
        let pins = model.pins().into_iter().map(|v| u64::from(v.0));
        let constrained = model.constraints().iter().map(|c| u64::from(c.vertex().0));
        let rods = model.rod_edges().iter().map(|e| u64::from(e.0));
        let lengths = edges.lengths().iter().map(|l| l.to_bits());
        Self {
            vertices: model.topology().vertex_count(),
            edges: edges.len(),
            connectivity: sum(&mut faces.flatten().map(|v| u64::from(v.0))),
            lengths: sum(&mut lengths.chain(rods)),
            masses: sum(&mut mass.vertex.iter().chain(edge_mass).map(|m| m.to_bits())),
            supports: sum(&mut pins.chain([u64::MAX]).chain(constrained)),
        }
    }

    /// Refuses another model.
    fn check(&self, found: &Self) -> Result<(), CheckpointError> {
        self.check_sheet(found)?;
        match self.supports == found.supports {
            true => Ok(()),
            false => Err(CheckpointError::OtherSheet {
                what: "pins or vertex constraints",
            }),
        }
    }

    /// Refuses the model of another sheet, whatever holds it.
    pub(super) fn check_sheet(&self, found: &Self) -> Result<(), CheckpointError> {
        let differs = |what| Err(CheckpointError::OtherSheet { what });
        if (self.vertices, self.edges) != (found.vertices, found.edges) {
            Err(CheckpointError::OtherSize {
                expected: [self.vertices, self.edges],
                found: [found.vertices, found.edges],
            })
        } else if self.connectivity != found.connectivity {
            differs("connectivity")
        } else if self.lengths != found.lengths {
            differs("rest lengths or isometry")
        } else if self.masses != found.masses {
            differs("masses")
        } else {
            Ok(())
        }
    }
}

impl Checkpoint {
    pub(crate) fn new(
        sheet: SheetFingerprint,
        energy: EnergySums,
        motion: EngineState,
        note: Vec<u8>,
    ) -> Self {
        Self {
            version: VERSION,
            sheet,
            energy,
            motion,
            note,
        }
    }

    /// The note that the program kept with the simulation
    /// ([`Simulation::set_note`](crate::Simulation::set_note)).
    pub fn note(&self) -> &[u8] {
        &self.note
    }

    /// Refuses a model other than the one that the checkpoint was made with.
    pub(crate) fn check_model(&self, model: &SheetModel) -> Result<(), CheckpointError> {
        self.sheet.check(&SheetFingerprint::of(model))
    }

    /// The binary form.
    ///
    /// # Errors
    /// [`CheckpointError::Encode`] if memory runs out.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&self.version.to_le_bytes());
        let mut bytes =
            postcard::to_extend(self, bytes).map_err(|e| CheckpointError::Encode(e.to_string()))?;
        bytes.extend_from_slice(&checksum(&bytes).to_le_bytes());
        Ok(bytes)
    }

    /// Reads the binary form.
    ///
    /// # Errors
    /// [`CheckpointError`] if the bytes are damaged, of another version, or not a checkpoint.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let length = bytes.len();
        let no_checkpoint = CheckpointError::NoCheckpoint { length };
        let rest = bytes.strip_prefix(MAGIC).ok_or(no_checkpoint.clone())?;
        let (version, rest) = rest.split_first_chunk::<4>().ok_or(no_checkpoint.clone())?;
        check_version(u32::from_le_bytes(*version))?;
        let (fields, sum) = rest.split_last_chunk::<4>().ok_or(no_checkpoint)?;
        let expected = u32::from_le_bytes(*sum);
        let found = checksum(&bytes[..length - sum.len()]);
        if found != expected {
            return Err(CheckpointError::Damaged { expected, found });
        }
        let decoded = postcard::from_bytes(fields);
        let checkpoint: Self = decoded.map_err(|e| CheckpointError::Decode(e.to_string()))?;
        check_version(checkpoint.version)?;
        Ok(checkpoint)
    }

    /// The JSON form.
    ///
    /// # Errors
    /// [`CheckpointError::Encode`] if memory runs out.
    pub fn to_json(&self) -> Result<String, CheckpointError> {
        serde_json::to_string(self).map_err(|e| CheckpointError::Encode(e.to_string()))
    }

    /// Reads the JSON form.
    ///
    /// # Errors
    /// [`CheckpointError`] if the text is of another version or not a checkpoint.
    pub fn from_json(text: &str) -> Result<Self, CheckpointError> {
        /// The one field that all versions have.
        #[derive(Deserialize)]
        struct Header {
            version: u32,
        }
        let decode = |e: serde_json::Error| CheckpointError::Decode(e.to_string());
        let header: Header = serde_json::from_str(text).map_err(decode)?;
        check_version(header.version)?;
        serde_json::from_str(text).map_err(decode)
    }
}

fn check_version(found: u32) -> Result<(), CheckpointError> {
    if found == VERSION {
        Ok(())
    } else {
        Err(CheckpointError::Version {
            found,
            supported: VERSION,
        })
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(bytes)
}

#[cfg(test)]
mod tests {
    use super::{Checkpoint, CheckpointError, EngineState};
    use crate::{Method, SheetModel, Simulation, SimulationError, State};
    use isosheet_mesh::{MassKind, VertexId, generate};

    /// A square that hangs by a corner.
    fn model() -> SheetModel {
        let sheet = generate::isotropic_square(0, 0.2).unwrap();
        let model = SheetModel::new(&sheet, 1e-3, MassKind::Lumped).unwrap();
        model.with_gravity().with_pins(&[VertexId(6)]).unwrap()
    }

    /// After a step.
    fn checkpoint() -> Checkpoint {
        let sheet = generate::isotropic_square(0, 0.2).unwrap();
        let start = State::at_rest(sheet.positions().to_vec());
        let mut simulation = Simulation::new(model(), start, Method::default()).unwrap();
        simulation.step(1.0 / 60.0).unwrap();
        simulation.checkpoint()
    }

    #[test]
    fn what_was_changed_from_outside_is_refused() {
        let good = checkpoint();
        assert!(Simulation::resume(model(), None, good.clone()).is_ok());
        let changes: [fn(&mut crate::engine::substeps::ByMethod); 6] = [
            |m| m.motion.state.t = f64::INFINITY,
            |m| m.motion.state.x[4] = f64::NAN,
            |m| m.motion.state.v[26] = f64::NEG_INFINITY,
            |m| m.motion.balance.pins[18] = f64::NAN,
            |m| m.motion.balance.pins.truncate(26),
            |m| m.motion.history.rod_stiffness = f64::NAN,
        ];
        for (k, change) in changes.into_iter().enumerate() {
            let mut changed = good.clone();
            let EngineState::Method(motion) = &mut changed.motion else {
                unreachable!("it is a method of this crate");
            };
            change(motion);
            let refused = Simulation::resume(model(), None, changed);
            assert!(
                matches!(
                    refused.map(drop),
                    Err(SimulationError::Checkpoint(
                        CheckpointError::NotFinite { .. } | CheckpointError::Length { .. }
                    ))
                ),
                "change {k}"
            );
        }
        let mut changed = good;
        changed.energy.work = f64::NAN;
        let error = Simulation::resume(model(), None, changed)
            .map(drop)
            .unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("sums of energies") && text.contains("index 1"),
            "{text}"
        );
    }
}
