//! Units of the numbers of a scene, and the ranges in which they have a meaning.

/// The unit of a number of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    Metre,
    CubicMetre,
    PerMetre,
    Second,
    Kilogram,
    KilogramPerSquareMetre,
    KilogramPerCubicMetre,
    Newton,
    NewtonPerMetre,
    NewtonMetre,
    Pascal,
    Joule,
    MetrePerSecond,
    MetrePerSquareSecond,
    PerSecond,
    Degree,
    /// Of coefficients of friction.
    One,
    /// Of factors by which something else is multiplied.
    Factor,
}

/// The sizes of the numbers of a unit: far beyond any sheet, and near enough for the squares, cubes and
/// quotients of a step neither to overflow nor to vanish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitRange {
    /// The unit as it is written behind a number; nothing for coefficients and factors.
    pub symbol: &'static str,
    /// The smallest size besides zero, where zero is allowed.
    pub least: f64,
    /// The largest size.
    pub most: f64,
    /// What the bounds are far beyond.
    pub reason: &'static str,
    /// The size from which a number is questioned.
    pub usual: Option<UsualSize>,
}

/// What the numbers of a unit hardly ever exceed with the sheets of this world: larger ones are mostly meant
/// in another unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsualSize {
    /// The largest size that is usual.
    pub most: f64,
    /// Sizes to compare with.
    pub compare: &'static str,
}

impl UnitRange {
    /// The ranges of all units of scenes.
    pub fn all() -> impl Iterator<Item = Self> {
        Unit::ALL.into_iter().map(Unit::range)
    }
}

impl Unit {
    pub(crate) const ALL: [Self; 17] = [
        Self::Metre,
        Self::CubicMetre,
        Self::PerMetre,
        Self::Second,
        Self::Kilogram,
        Self::KilogramPerSquareMetre,
        Self::KilogramPerCubicMetre,
        Self::Newton,
        Self::NewtonPerMetre,
        Self::NewtonMetre,
        Self::Pascal,
        Self::Joule,
        Self::MetrePerSecond,
        Self::MetrePerSquareSecond,
        Self::PerSecond,
        Self::Degree,
        Self::One,
    ];

    /// As it is written behind a number.
    pub(crate) fn symbol(self) -> &'static str {
        self.range().symbol
    }

    pub(crate) fn range(self) -> UnitRange {
        let (symbol, least, most, reason) = match self {
            Self::Metre => (
                "m",
                1e-12,
                1e12,
                "an atom measures 1e-10 m, the orbit of the earth 1e11 m",
            ),
            Self::CubicMetre => (
                "m3",
                1e-24,
                1e24,
                "a cell of 1e-6 m has 1e-18 m3, all oceans 1e18 m3",
            ),
            Self::PerMetre => (
                "1/m",
                1e-12,
                1e12,
                "as for lengths, whose inverses these are",
            ),
            Self::Second => (
                "s",
                1e-15,
                1e15,
                "atoms in a molecule vibrate in 1e-14 s, a million years are 3e13 s",
            ),
            Self::Kilogram => (
                "kg",
                1e-24,
                1e24,
                "a square micrometre of graphene has 8e-19 kg, the sea has 1e21 kg",
            ),
            Self::KilogramPerSquareMetre => (
                "kg/m2",
                1e-9,
                1e9,
                "graphene, the lightest sheet, has 8e-7 kg/m2, a metre of steel has 8e3 kg/m2",
            ),
            Self::KilogramPerCubicMetre => (
                "kg/m3",
                1e-3,
                1e6,
                "an aerogel has 1 kg/m3, osmium has 2e4 kg/m3",
            ),
            Self::Newton => (
                "N",
                1e-24,
                1e18,
                "bonds of atoms break at 1e-9 N, ropes of bridges hold 1e9 N",
            ),
            Self::NewtonPerMetre => (
                "N/m",
                1e-9,
                1e18,
                "a film of soap pulls with 0.05 N/m, a metre of steel has a stiffness of 2e11 N/m",
            ),
            Self::NewtonMetre => (
                "N m",
                1e-24,
                1e18,
                "graphene has a rigidity of 2e-19 N m, a metre of steel 2e10 N m",
            ),
            Self::Pascal => (
                "Pa",
                1.0,
                1e15,
                "a soft gel has a Young's modulus of 1e2 Pa, diamond of 1e12 Pa",
            ),
            Self::Joule => (
                "J",
                1e-30,
                1e18,
                "the heat of one atom is 6e-21 J, a ton of explosive has 4e9 J",
            ),
            Self::MetrePerSecond => (
                "m/s",
                1e-15,
                1e9,
                "continents drift at 1e-9 m/s, light travels at 3e8 m/s",
            ),
            Self::MetrePerSquareSecond => (
                "m/s2",
                1e-15,
                1e15,
                "the attraction of a person at a metre is 5e-9 m/s2, that of a neutron star 1e12 m/s2",
            ),
            Self::PerSecond => ("1/s", 1e-15, 1e15, "as for times, whose inverses these are"),
            Self::Degree => (
                "degrees",
                0.0,
                1e9,
                "a larger angle has fewer than seven digits behind the point",
            ),
            Self::One => (
                "",
                0.0,
                1e3,
                "rubber on rubber has a coefficient of friction of about 1",
            ),
            Self::Factor => ("", 0.0, 1e3, "a factor of 1 leaves everything as it is"),
        };
        UnitRange {
            symbol,
            least,
            most,
            reason,
            usual: self.usual(),
        }
    }

    fn usual(self) -> Option<UsualSize> {
        let (most, compare) = match self {
            Self::KilogramPerSquareMetre => (
                50.0,
                "office paper of 80 g/m2 has 0.08 kg/m2, steel of 6 mm has 47 kg/m2",
            ),
            Self::KilogramPerCubicMetre => (
                2.3e4,
                "paper has 800 kg/m3, steel has 7850 kg/m3, osmium has 22600 kg/m3",
            ),
            Self::NewtonPerMetre => (
                2e9,
                "paper has 3e5 N/m, steel of 1 mm has 2e8 N/m, which is Young's modulus times thickness",
            ),
            Self::NewtonMetre => (
                2e4,
                "paper has a rigidity of 3e-4 N m, steel of 1 mm of 18 N m, steel of 10 mm of 18000 N m",
            ),
            Self::Pascal => (
                1.3e12,
                "paper has 3e9 Pa, steel has 2.1e11 Pa, diamond has 1.2e12 Pa",
            ),
            Self::MetrePerSecond => (
                100.0,
                "sheets leave printing presses at 20 m/s, the wind of a hurricane has 70 m/s",
            ),
            Self::MetrePerSquareSecond => (
                300.0,
                "the gravity of the earth is 9.81 m/s2, shakers reach some 100 m/s2",
            ),
            _ => return None,
        };
        Some(UsualSize { most, compare })
    }
}
