//! The quantities that pictures of a run can have as colours.

use super::Recording;
use super::frame_field::FrameField;
use isosheet_formats::{Series, SeriesOptions};
use isosheet_page::{Centering, Field, Scale};

/// Fold angles up to this size, degrees, have no say in the range of colours, which is not smaller; as in
/// pages.
const LEAST_FOLD: f64 = 1.0;

impl Recording {
    /// The names of the quantities that pictures of this run can have as colours: the fold angle, the height,
    /// and the fields of the page.
    pub fn quantities(&self) -> Vec<String> {
        let fields = self.coloured();
        fields.into_iter().map(|field| field.head.name).collect()
    }

    /// Of some quantities, frame by frame.
    pub fn coloured(&self) -> Vec<FrameField<'_>> {
        let series = self.series(&SeriesOptions::default()).ok();
        let mut fields: Vec<_> = series.map(fold_angle).into_iter().collect();
        fields.push(height());
        fields.extend(self.fields());
        if !self.scene.scene().output.curvature {
            fields.extend(self.curvature_fields());
        }
        fields
    }
}

/// The fold angle of each edge, degrees, followed from frame to frame.
fn fold_angle(series: Series<'_>) -> FrameField<'_> {
    let head = Field {
        name: "fold angle (valley +)".into(),
        unit: "°".into(),
        place: Centering::Crease,
        scale: Scale::Signed,
        note: String::new(),
        values: Vec::new(),
    };
    FrameField::new(head, move |frame| {
        let angles = series.fold_angles(frame.number).into_iter();
        let degrees = angles.map(f64::to_degrees);
        degrees
            .map(|a| if a.abs() > LEAST_FOLD { a } else { 0.0 })
            .collect()
    })
}

/// The height of each vertex, metres.
fn height<'a>() -> FrameField<'a> {
    let head = Field {
        name: "height".into(),
        unit: "m".into(),
        place: Centering::Vertex,
        scale: Scale::Linear,
        note: String::new(),
        values: Vec::new(),
    };
    FrameField::new(head, |frame| {
        frame.x.as_chunks::<3>().0.iter().map(|p| p[2]).collect()
    })
}
