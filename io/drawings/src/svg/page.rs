//! Sizes of pages and of lengths on them.

use super::matrix::{Matrix, compose, scaling, translation};
use crate::unit::DrawingUnit;
use roxmltree::Node;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, ViewBox};

/// The part of the plane that shapes are drawn in: what percentages refer to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewport {
    pub(super) size: [f64; 2],
}

/// The direction that a length has.
#[derive(Clone, Copy, Debug)]
pub(super) enum Along {
    X,
    Y,
    Diagonal,
}

impl Viewport {
    /// A length in units of the drawing.
    pub(super) fn length(self, length: Length, along: Along) -> f64 {
        let n = length.number;
        // 96 units are an inch, unless the page says something else of all of them.
        let absolute = |unit: DrawingUnit| unit.metres(n) / DrawingUnit::Pixel.metres(1.0);
        let [w, h] = self.size;
        match length.unit {
            LengthUnit::None | LengthUnit::Px => n,
            LengthUnit::Percent => match along {
                Along::X => n / 100.0 * w,
                Along::Y => n / 100.0 * h,
                Along::Diagonal => n / 100.0 * ((w * w + h * h) / 2.0).sqrt(),
            },
            LengthUnit::In => absolute(DrawingUnit::Inch),
            LengthUnit::Cm => absolute(DrawingUnit::Centimetre),
            LengthUnit::Mm => absolute(DrawingUnit::Millimetre),
            LengthUnit::Pt => absolute(DrawingUnit::Point),
            LengthUnit::Pc => 12.0 * absolute(DrawingUnit::Point),
            // Of the size of text that is usual.
            LengthUnit::Em => 16.0 * n,
            LengthUnit::Ex => 8.0 * n,
        }
    }

    /// An attribute that is a length; `None` if there is none.
    ///
    /// # Errors
    /// What is wrong with its text.
    pub(super) fn attribute(
        self,
        node: Node<'_, '_>,
        name: &str,
        along: Along,
    ) -> Result<Option<f64>, String> {
        let length = length(node, name)?;
        Ok(length.map(|length| self.length(length, along)))
    }
}

/// An attribute that is a length with its unit; `None` if there is none, or the drawing leaves it open.
fn length(node: Node<'_, '_>, name: &str) -> Result<Option<Length>, String> {
    match node.attribute(name) {
        None | Some("auto") => Ok(None),
        Some(text) => match text.trim().parse::<Length>() {
            Ok(length) => Ok(Some(length)),
            Err(_) => Err(format!("`{name}` is {text:?}, which is no length")),
        },
    }
}

/// The part of the plane that an element shows, if it says it.
fn view_box(node: Node<'_, '_>) -> Result<Option<ViewBox>, String> {
    let Some(text) = node.attribute("viewBox") else {
        return Ok(None);
    };
    match text.trim().parse::<ViewBox>() {
        Ok(view) => Ok(Some(view)),
        Err(_) => Err(format!(
            "`viewBox` is {text:?}: two coordinates and two positive lengths are needed"
        )),
    }
}

/// Where the content of an element `svg` or `symbol` is drawn, in units of what it is in: the map there, and
/// its viewport.
///
/// # Errors
/// What is wrong with its attributes.
pub(super) fn content(node: Node<'_, '_>, size: [f64; 2]) -> Result<(Matrix, Viewport), String> {
    let Some(view) = view_box(node)? else {
        return Ok((translation(0.0, 0.0), Viewport { size }));
    };
    let aspect = node.attribute("preserveAspectRatio");
    let aspect = aspect.and_then(|t| t.parse().ok()).unwrap_or(AspectRatio {
        defer: false,
        align: Align::XMidYMid,
        slice: false,
    });
    let [x, y] = [size[0] / view.w, size[1] / view.h];
    let [x, y] = match (aspect.align, aspect.slice) {
        (Align::None, _) => [x, y],
        (_, true) => [x.max(y); 2],
        (_, false) => [x.min(y); 2],
    };
    let [u, v] = match aspect.align {
        Align::None | Align::XMinYMin => [0.0, 0.0],
        Align::XMidYMin => [0.5, 0.0],
        Align::XMaxYMin => [1.0, 0.0],
        Align::XMinYMid => [0.0, 0.5],
        Align::XMidYMid => [0.5, 0.5],
        Align::XMaxYMid => [1.0, 0.5],
        Align::XMinYMax => [0.0, 1.0],
        Align::XMidYMax => [0.5, 1.0],
        Align::XMaxYMax => [1.0, 1.0],
    };
    let spare = [size[0] - x * view.w, size[1] - y * view.h];
    let place = translation(u * spare[0] - x * view.x, v * spare[1] - y * view.y);
    let viewport = Viewport {
        size: [view.w, view.h],
    };
    Ok((compose(place, scaling(x, y)), viewport))
}

/// The size of the page in units of 1/96 inch, and whether the file says it in units that are absolute.
///
/// # Errors
/// What is wrong with its attributes.
pub(super) fn page_size(root: Node<'_, '_>) -> Result<([f64; 2], bool), String> {
    let of_view = view_box(root)?.map(|v| [v.w, v.h]);
    let given = [length(root, "width")?, length(root, "height")?].map(|length| {
        length.filter(|length| length.unit != LengthUnit::Percent && length.number > 0.0)
    });
    let is_absolute = |l: &Length| !matches!(l.unit, LengthUnit::None | LengthUnit::Px);
    let absolute = given.iter().flatten().any(is_absolute);
    let none = Viewport { size: [0.0; 2] };
    let [width, height] = given.map(|g| g.map(|length| none.length(length, Along::X)));
    let size = match (width, height, of_view) {
        (Some(w), Some(h), _) => [w, h],
        (Some(w), None, Some([x, y])) => [w, w * y / x],
        (None, Some(h), Some([x, y])) => [h * x / y, h],
        (None, None, Some(size)) => size,
        (w, h, None) => [w.unwrap_or(0.0), h.unwrap_or(0.0)],
    };
    Ok((size, absolute))
}
