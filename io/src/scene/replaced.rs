//! Keys and choices of earlier versions, and what takes their place.

/// What is wrong with a key that an earlier version had, and what to write instead; `None` for all others.
/// The name is that of the key without numbers of entries, and with its value where the value is a name:
/// `sheet.isometry.weak` for `isometry = { weak = {} }` and for `isometry = "weak"`.
pub(crate) fn replaced(name: &str) -> Option<[&'static str; 2]> {
    let words = match name {
        "sheet.isometry.weak" => [
            "there is no isometry in weak form any more",
            "name what the sheet is made of, `material = \"office paper\"`, or write `isometry = { elastic = { \
             stiffness = ... } }` with Young's modulus times thickness in N/m: an elastic sheet bends in every \
             direction, too, and no part of it stretches beyond a limit",
        ],
        "sheet.isometry.membrane" => [
            "there is no membrane without a limit of strain any more",
            "write `isometry = { elastic = { stiffness = ..., poisson = ..., limit = 0.01 } }`, or name what the sheet is \
             made of, `material = \"office paper\"`",
        ],
        "method.fallback.hold" => [
            "a sheet that locks is not held any more, it is refused",
            "leave the key out; name what the sheet is made of, `material = \"office paper\"`, which makes it elastic, or \
             make a mesh with a line of edges along each clamp",
        ],
        "method.hold_after" => [
            "a sheet that locks is not held any more, it is refused",
            "leave the key out; `max_factorisations` bounds what the refusal takes",
        ],
        _ => return None,
    };
    Some(words)
}
