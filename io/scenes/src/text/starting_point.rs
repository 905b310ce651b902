//! Scenes to start from.

/// A commented scene file to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartingPoint {
    /// A sheet of paper that hangs by one corner.
    Hanging,
    /// A strip of paper that is clamped at one end and bends under its weight.
    Clamp,
    /// A tablecloth of plastic film that drapes over a round table.
    Drape,
    /// A sheet of aluminium that a punch presses between two bars.
    Stamp,
    /// A strip of paper that is pushed up a ramp.
    Feed,
    /// Miura's crease pattern, folded by driven angles.
    Fold,
    /// A flag of plastic film in gusty wind.
    Flag,
    /// A folded leaf of paper that falls in still air.
    Leaf,
    /// Three sheets of paper, of which a roller feeds the uppermost.
    Stack,
    /// A strip of paper whose ends are glued after half a turn.
    Moebius,
    /// Pleated paper whose creases bend its panels to a hyperbolic paraboloid.
    Hypar,
    /// A ball and a box that fall into a hammock of film, and a flap that swings beside it.
    Hammock,
    /// A strip of film that is peeled off a plate.
    Peel,
    /// Two squares of film that are glued along their edges and blown up.
    Pillow,
    /// A cloth that is pulled away from under a vase.
    Vase,
    /// A flying wing of card that glides.
    Plane,
}

impl StartingPoint {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Hanging,
        Self::Clamp,
        Self::Drape,
        Self::Stamp,
        Self::Feed,
        Self::Fold,
        Self::Flag,
        Self::Leaf,
        Self::Stack,
        Self::Moebius,
        Self::Hypar,
        Self::Hammock,
        Self::Peel,
        Self::Pillow,
        Self::Vase,
        Self::Plane,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hanging => "hanging",
            Self::Clamp => "clamp",
            Self::Drape => "drape",
            Self::Stamp => "stamp",
            Self::Feed => "feed",
            Self::Fold => "fold",
            Self::Flag => "flag",
            Self::Leaf => "leaf",
            Self::Stack => "stack",
            Self::Moebius => "moebius",
            Self::Hypar => "hypar",
            Self::Hammock => "hammock",
            Self::Peel => "peel",
            Self::Pillow => "pillow",
            Self::Vase => "vase",
            Self::Plane => "plane",
        }
    }

    /// What it shows, in a few words.
    pub fn about(self) -> &'static str {
        match self {
            Self::Hanging => "A sheet of paper that hangs by one corner",
            Self::Clamp => "A strip of paper that is clamped at one end and bends under its weight",
            Self::Drape => "A tablecloth of plastic film that drapes over a round table",
            Self::Stamp => "A sheet of aluminium that a punch presses between two bars",
            Self::Feed => "A strip of paper that is pushed up a ramp",
            Self::Fold => "Miura's crease pattern, folded by driven angles",
            Self::Flag => "A flag of plastic film in gusty wind",
            Self::Leaf => "A folded leaf of paper that falls in still air",
            Self::Stack => "Three sheets of paper, of which a roller feeds the uppermost",
            Self::Moebius => "A strip of paper whose ends are glued after half a turn",
            Self::Hypar => "Pleated paper whose creases bend its panels to a hyperbolic paraboloid",
            Self::Hammock => "Rigid bodies that fall into a hammock of film",
            Self::Peel => "A strip of film that is peeled off a plate",
            Self::Pillow => "Two squares of film that are glued to a pillow and blown up",
            Self::Vase => "A cloth that is pulled away from under a vase",
            Self::Plane => "A flying wing of card that glides",
        }
    }

    /// The scene file.
    pub fn text(self) -> &'static str {
        match self {
            Self::Hanging => include_str!("starting_point/hanging.toml"),
            Self::Clamp => include_str!("starting_point/clamp.toml"),
            Self::Drape => include_str!("starting_point/drape.toml"),
            Self::Stamp => include_str!("starting_point/stamp.toml"),
            Self::Feed => include_str!("starting_point/feed.toml"),
            Self::Fold => include_str!("starting_point/fold.toml"),
            Self::Flag => include_str!("starting_point/flag.toml"),
            Self::Leaf => include_str!("starting_point/leaf.toml"),
            Self::Stack => include_str!("starting_point/stack.toml"),
            Self::Moebius => include_str!("starting_point/moebius.toml"),
            Self::Hypar => include_str!("starting_point/hypar.toml"),
            Self::Hammock => include_str!("starting_point/hammock.toml"),
            Self::Peel => include_str!("starting_point/peel.toml"),
            Self::Pillow => include_str!("starting_point/pillow.toml"),
            Self::Vase => include_str!("starting_point/vase.toml"),
            Self::Plane => include_str!("starting_point/plane.toml"),
        }
    }
}
