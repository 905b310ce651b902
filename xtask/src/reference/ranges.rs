//! The page of the ranges of numbers.

use isosheet_mesh::wording::given;
use isosheet_scenes::UnitRange;

const INTRODUCTION: &str = "\
# Ranges of numbers

A number beyond the range of its unit is refused. The bounds are far beyond everything that a sheet is made
of. They are near enough for the squares, cubes and quotients of a step neither to overflow nor to vanish. The
smallest size holds for numbers that have to be above zero. A number beyond the size that its unit usually has
is warned of: it is mostly meant in another unit.

| unit | smallest | warned of above | largest | for comparison |
|---|---|---|---|---|
";

/// The ranges of numbers by their units, in Markdown.
pub(super) fn page() -> String {
    let mut page = String::from(INTRODUCTION);
    for UnitRange {
        symbol,
        least,
        most,
        reason,
        usual,
    } in UnitRange::all()
    {
        let least = if least > 0.0 {
            given(least).to_string()
        } else {
            String::new()
        };
        let symbol = match symbol {
            "" => "coefficients of friction and drag",
            symbol => symbol,
        };
        let (questioned, compare) = match usual {
            Some(usual) => (
                given(usual.most).to_string(),
                format!("{reason}; {}", usual.compare),
            ),
            None => (String::new(), reason.to_owned()),
        };
        page.push_str(&format!(
            "| {symbol} | {least} | {questioned} | {} | {compare} |\n",
            given(most)
        ));
    }
    page
}
