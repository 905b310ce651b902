//! Drawing Exchange Format, as text.
//!
//! Read are LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE and POLYLINE with bulges, and SPLINE without weights, with
//! their layers, colours and line types. Blocks are not taken apart.

mod entity;
mod groups;
mod layers;
mod spline;

use super::lines::Drawing;
use super::unit::DrawingUnit;
use crate::format::DataError;
use entity::Entity;
use groups::{Record, section};
use layers::Layers;

/// Reads the entities of a drawing.
pub(in crate::format) fn parse(
    bytes: &[u8],
    unit: Option<DrawingUnit>,
    scale: f64,
) -> Result<Drawing, DataError> {
    let text = String::from_utf8_lossy(bytes);
    let records = groups::records(&text)?;
    let mut drawing = Drawing::default();
    let unit = match unit {
        Some(unit) => {
            let own = metres(&records).ok().flatten();
            drawing.by_own_unit = own.map(|own| own / unit.metres(1.0));
            unit.metres(1.0)
        }
        None => match metres(&records)? {
            Some(metres) => metres,
            None => {
                drawing.assumed_unit = Some("1 is 1 mm");
                DrawingUnit::Millimetre.metres(1.0)
            }
        },
    };
    let scale = unit * scale;
    let layers = Layers::of(&records)?;
    let mut entities = section(&records, "ENTITIES")?.iter();
    while let Some(record) = entities.next() {
        let mut vertices = Vec::new();
        if record.kind == "POLYLINE" {
            vertices = entities
                .by_ref()
                .take_while(|r| r.kind == "VERTEX")
                .collect();
        }
        let Some(pen) = layers.pen(record)? else {
            drawing.leave_out("hidden entity");
            continue;
        };
        let entity = Entity {
            record,
            vertices: &vertices,
        };
        match entity.curves()? {
            Some(curves) => {
                let grown = |c: &isosheet_mesh::plane::PlaneCurve| {
                    c.transformed([[scale, 0.0], [0.0, scale], [0.0, 0.0]])
                };
                drawing.push(pen, curves.iter().map(grown));
            }
            None => drawing.leave_out(match record.kind {
                "TEXT" | "MTEXT" | "ATTDEF" | "ATTRIB" => "text",
                "IMAGE" => "image",
                "INSERT" => "block",
                "DIMENSION" | "LEADER" | "MLEADER" => "dimension",
                "HATCH" | "SOLID" => "filled area",
                "POINT" => "point",
                _ => "entity of another kind",
            }),
        }
    }
    Ok(drawing)
}

/// The length of a unit, metres; `None` where the file does not say it.
fn metres(records: &[Record<'_>]) -> Result<Option<f64>, DataError> {
    let header = records
        .iter()
        .find(|r| r.kind == "SECTION" && r.text(2) == Some("HEADER"));
    let Some(code) = header.and_then(|h| h.after("$INSUNITS")) else {
        return Ok(None);
    };
    Ok(Some(match code {
        "0" => return Ok(None),
        "1" => 0.0254,
        "2" => 0.3048,
        "4" => 1e-3,
        "5" => 1e-2,
        "6" => 1.0,
        "9" => 0.0254e-3,
        "13" => 1e-6,
        "14" => 0.1,
        _ => {
            let message = format!("its unit has the number {code} ($INSUNITS), which is not known");
            return Err(DataError::new(
                message,
                "say what a unit of the drawing is: mm, in ...",
            ));
        }
    }))
}
