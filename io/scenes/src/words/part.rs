//! Parts of a scene, which are found by its structure.

use crate::words::key::Key;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_drawings::DrawingUnit;
use isosheet_formats::FoldFrame;
pub(crate) use isosheet_scenes_derive::Part;
use std::any::Any;
use std::path::PathBuf;

/// A part of a scene of any type.
pub(crate) type AnyPart = dyn Part;

/// Who is shown parts of a part, each with its place.
pub(crate) type See<'s, 'a> = &'s mut dyn FnMut(Place, &'a AnyPart);

/// Who is shown parts of a part that it may change.
pub(crate) type SeeMut<'s, 'a> = &'s mut dyn FnMut(Place, &'a mut AnyPart);

/// A part of a scene. `#[derive(Part)]` makes structs and enums parts, and their fields the parts of these: a
/// field that is no part does not compile. A type that is `#[checked]` has a function `check` of its own
/// numbers.
pub(crate) trait Part: Any {
    /// Shows its parts, which it has at a place, in their order.
    fn parts<'a>(&'a self, _at: &Place, _see: See<'_, 'a>) {}

    /// Shows its parts so that they can be changed.
    fn parts_mut<'a>(&'a mut self, _at: &Place, _see: SeeMut<'_, 'a>) {}

    /// Checks what of it concerns no other part: its own numbers.
    fn check_own(&self, _at: &Place, _checks: &mut Checks) {}

    /// Whether it is a number, or many, which nobody looks for.
    fn is_number() -> bool
    where
        Self: Sized,
    {
        false
    }
}

/// Where a part is, and what it is in, if it is a function of time.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) key: Key,
    pub(crate) unit: Option<Unit>,
}

impl Place {
    /// The place of a key.
    pub(crate) fn of(key: Key) -> Self {
        Self { key, unit: None }
    }

    pub(crate) fn name(&self, name: &str) -> Self {
        Self::of(self.key.name(name))
    }

    pub(crate) fn entry(&self, number: usize) -> Self {
        Self {
            key: self.key.entry(number),
            ..*self
        }
    }

    pub(crate) fn in_unit(self, unit: Unit) -> Self {
        Self {
            unit: Some(unit),
            ..self
        }
    }
}

/// Checks a part and all that it is made of, each for itself.
pub(crate) fn check_all(whole: &AnyPart, at: &Place, checks: &mut Checks) {
    whole.check_own(at, checks);
    whole.parts(at, &mut |at, part| check_all(part, &at, checks));
}

/// All parts of a type in the part of a key, in the order of the scene.
pub(crate) fn all<T: Part>(whole: &AnyPart, key: Key) -> Vec<(Place, &T)> {
    fn find<'a, T: Part>(at: Place, part: &'a AnyPart, found: &mut Vec<(Place, &'a T)>) {
        match (part as &dyn Any).downcast_ref() {
            Some(part) => found.push((at, part)),
            None => part.parts(&at, &mut |at, part| find(at, part, found)),
        }
    }
    let mut found = Vec::new();
    find(Place::of(key), whole, &mut found);
    found
}

/// All parts of a type in a part, so that they can be changed.
pub(crate) fn all_mut<T: Part>(whole: &mut AnyPart, key: Key) -> Vec<(Place, &mut T)> {
    fn find<'a, T: Part>(at: Place, part: &'a mut AnyPart, found: &mut Vec<(Place, &'a mut T)>) {
        if !(part as &dyn Any).is::<T>() {
            return part.parts_mut(&at, &mut |at, part| find(at, part, found));
        }
        let part = (part as &mut dyn Any).downcast_mut();
        found.extend(part.map(|part| (at, part)));
    }
    let mut found = Vec::new();
    find(Place::of(key), whole, &mut found);
    found
}

/// Shows a part, unless nobody looks for it.
pub(crate) fn shared<'a, T: Part>(part: &'a T, at: impl FnOnce() -> Place, see: See<'_, 'a>) {
    if !T::is_number() {
        see(at(), part);
    }
}

/// Shows a part that may be changed, unless nobody looks for it.
pub(crate) fn mutable<'a, T: Part>(
    part: &'a mut T,
    at: impl FnOnce() -> Place,
    see: SeeMut<'_, 'a>,
) {
    if !T::is_number() {
        see(at(), part);
    }
}

/// Parts without parts.
macro_rules! leaves {
    ($is_number:literal: $($leaf:ty),*) => {$(
        impl Part for $leaf {
            fn is_number() -> bool {
                $is_number
            }
        }
    )*};
}
leaves!(true: bool, f64, u32, u64, usize);
leaves!(false: String, PathBuf, DrawingUnit, FoldFrame);

/// Parts that are made of others: what has them as `iter` and `iter_mut`, each at a place.
macro_rules! made_of {
    ($([$($generic:tt)*] $whole:ty: |$at:ident, $k:ident| $place:expr;)*) => {$(
        impl<T: Part, $($generic)*> Part for $whole {
            fn parts<'a>(&'a self, $at: &Place, see: See<'_, 'a>) {
                for ($k, part) in self.iter().enumerate() {
                    shared(part, || $place, see);
                }
            }

            fn parts_mut<'a>(&'a mut self, $at: &Place, see: SeeMut<'_, 'a>) {
                for ($k, part) in self.iter_mut().enumerate() {
                    mutable(part, || $place, see);
                }
            }

            fn is_number() -> bool {
                T::is_number()
            }
        }
    )*};
}
made_of! {
    [] Option<T>: |at, _k| at.clone();
    [] Vec<T>: |at, k| at.entry(k);
    [const N: usize] [T; N]: |at, k| at.entry(k);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MeshFileKey, ProfileKey, Selection};

    /// A key of each kind, such as somebody adds to a scene.
    #[derive(Part)]
    #[checked]
    struct Spring {
        at: Selection,
        #[serde(rename = "static")]
        #[unit(Newton)]
        size: Option<ProfileKey>,
        ends: Vec<End>,
        sheet: Option<String>,
        rate: f64,
    }

    #[derive(Part)]
    enum End {
        Free,
        OnFile(MeshFileKey),
        AtRest {
            #[unit(Metre)]
            place: [ProfileKey; 2],
        },
    }

    impl Spring {
        fn check(&self, key: &Key, checks: &mut Checks) {
            checks.positive(key.name("rate"), self.rate, Unit::PerSecond);
        }
    }

    fn spring() -> Spring {
        Spring {
            at: Selection::All,
            size: Some(f64::NAN.into()),
            ends: vec![
                End::Free,
                End::AtRest {
                    place: [1.0, 2.0].map(ProfileKey::from),
                },
                End::OnFile(MeshFileKey::new("end.obj")),
            ],
            sheet: Some("cover".into()),
            rate: -1.0,
        }
    }

    fn keys<T: Part>(spring: &Spring) -> Vec<String> {
        let found = all::<T>(spring, Key::root().name("spring").entry(0));
        found.iter().map(|(at, _)| at.key.to_string()).collect()
    }

    #[test]
    fn a_new_key_of_every_kind_is_found() {
        let mut spring = spring();
        assert_eq!(keys::<Selection>(&spring), ["spring[0].at"]);
        assert_eq!(keys::<String>(&spring), ["spring[0].sheet"]);
        assert_eq!(keys::<PathBuf>(&spring), ["spring[0].ends[2].on_file.path"]);
        let functions = [
            "static",
            "ends[1].at_rest.place[0]",
            "ends[1].at_rest.place[1]",
        ];
        assert_eq!(
            keys::<ProfileKey>(&spring),
            functions.map(|key| format!("spring[0].{key}"))
        );
        let units = all::<ProfileKey>(&spring, Key::root()).into_iter();
        let units: Vec<_> = units.map(|(at, _)| at.unit).collect();
        assert_eq!(units, [Unit::Newton, Unit::Metre, Unit::Metre].map(Some));
        for (_, function) in all_mut::<ProfileKey>(&mut spring, Key::root()) {
            *function = 3.0.into();
        }
        assert_eq!(spring.size, Some(3.0.into()));
    }

    #[test]
    fn a_new_key_is_checked() {
        let mut checks = Checks::default();
        check_all(
            &spring(),
            &Place::of(Key::root().name("spring")),
            &mut checks,
        );
        let keys: Vec<_> = checks.problems.iter().map(|p| p.key.to_string()).collect();
        assert_eq!(keys, ["spring.rate", "spring.static"]);
    }
}
