//! Formats of mesh files.

use std::path::Path;

/// A format of meshes, as the extension of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// Object File Format of Geomview, `.off`.
    Off,
    /// Stereolithography, binary or text, `.stl`.
    Stl,
    /// Polygon File Format of Stanford, binary or text, `.ply`.
    Ply,
    /// Flexible Origami List Datastructure 1.0 to 1.2, `.fold`.
    Fold,
    /// Graphics Library Transmission Format 2.0 as text with its buffers, `.gltf`.
    Gltf,
    /// Graphics Library Transmission Format 2.0 in one binary file, `.glb`.
    Glb,
    /// Polygons of VTK, legacy files as text or binary, `.vtk`.
    Vtk,
    /// Polygons of VTK, XML files, `.vtp`.
    Vtp,
    /// Scalable Vector Graphics, `.svg`: a crease pattern by the colours of Origami Simulator.
    Svg,
    /// Crease patterns of ORIPA and Oriedita as text, `.cp`.
    Cp,
    /// Crease patterns of ORIPA as XML, `.opx`.
    Opx,
}

impl MeshFormat {
    /// All formats that are read.
    pub const ALL: [Self; 12] = [
        Self::Obj,
        Self::Off,
        Self::Stl,
        Self::Ply,
        Self::Fold,
        Self::Gltf,
        Self::Glb,
        Self::Vtk,
        Self::Vtp,
        Self::Svg,
        Self::Cp,
        Self::Opx,
    ];

    /// The extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Fold => "fold",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Vtk => "vtk",
            Self::Vtp => "vtp",
            Self::Svg => "svg",
            Self::Cp => "cp",
            Self::Opx => "opx",
        }
    }

    /// Whether files of the format are drawings of crease patterns, which have lines and no faces.
    pub fn is_drawing(self) -> bool {
        matches!(self, Self::Svg | Self::Cp | Self::Opx)
    }

    /// Whether the format says which axis points upwards, so that its meshes are read with z upwards.
    pub fn says_up(self) -> bool {
        matches!(self, Self::Gltf | Self::Glb)
    }

    /// The format of a file by its extension, in capital or small letters; `None` for all others.
    pub fn of(path: &Path) -> Option<Self> {
        let found = path.extension()?;
        Self::ALL
            .into_iter()
            .find(|f| found.eq_ignore_ascii_case(f.extension()))
    }
}
