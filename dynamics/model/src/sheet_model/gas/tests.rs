use super::*;
use crate::sheet_model::volume::tests::octahedron;
use isosheet_materials::hessian::HessianProduct;
use isosheet_materials::vectors::dot;

fn enclosed(gas: Gas) -> (EnclosedGas, Vec<[usize; 2]>, Vec<f64>) {
    let (topology, x) = octahedron();
    let volume = Volume::new(&LoadedFaces::all(&topology).expect("faces"));
    let first = 0.8 * volume.value(&x);
    let edges = topology.edges().iter().map(|e| e.map(|v| v.index()));
    (EnclosedGas { volume, gas, first }, edges.collect(), x)
}

/// Pressures follow `p V^n`, energies are their integrals, also where the series ends and beyond the smallest
/// volume.
#[test]
fn the_pressure_is_that_of_a_polytropic_gas() {
    for exponent in [1.0, 1.4, 2.5] {
        let gas = Gas {
            pressure: 9e4,
            exponent,
            ..Gas::default()
        };
        let (gas, ..) = enclosed(gas);
        let at = |part: f64| gas.at_volume(0.0, part * gas.first);
        for part in [0.3, 0.89, 0.91, 0.99, 1.0, 1.02, 1.09, 1.12, 3.0] {
            let wanted = 101_325.0 - 9e4 * f64::powf(part, -exponent);
            assert!((at(part).slope - wanted).abs() < 1e-9 * 1e5, "{part}");
        }
        for part in [0.5e-3, 0.3, 0.9, 0.97, 1.0, 1.03, 1.1, 3.0] {
            let d = 1e-6 * part;
            let step = 2.0 * d * gas.first;
            let slope = (at(part + d).energy - at(part - d).energy) / step;
            let size = at(part).slope.abs().max(1e5);
            assert!(
                (slope - at(part).slope).abs() < 1e-6 * size,
                "{part}: {slope}"
            );
            let slope = (at(part + d).slope - at(part - d).slope) / step;
            let curvature = at(part).curvature;
            assert!(
                (slope - curvature).abs() < 1e-6 * curvature,
                "{part}: {slope}"
            );
        }
    }
}

/// Where gas and air outside have the same pressure, the energy is the work of small displacements, to all
/// digits.
#[test]
fn energies_of_small_changes_keep_their_digits() {
    let (gas, ..) = enclosed(Gas::default());
    let part: f64 = 1e-7;
    let energy = gas.at_volume(0.0, (1.0 + part) * gas.first).energy;
    let wanted = 101_325.0 * gas.first * (part * part / 2.0 - part.powi(3) / 3.0);
    assert!((energy / wanted - 1.0).abs() < 1e-7, "{energy} {wanted}");
}

#[test]
fn derivatives_are_those_of_differences() {
    let gas = Gas {
        added: Profile::Constant(0.1),
        ..Gas::default()
    };
    let (gas, edges, x) = enclosed(gas);
    let direction: Vec<f64> = (0..x.len()).map(|i| (1.3 * i as f64).cos()).collect();
    let moved = |d: f64| -> Vec<f64> { x.iter().zip(&direction).map(|(x, v)| x + d * v).collect() };
    let gradient = |x: &[f64]| {
        let mut gradient = vec![0.0; x.len()];
        gas.add_gradient(At::new(0.0, x), &mut gradient);
        gradient
    };
    let [up, down] = [1e-5, -1e-5].map(moved);
    let energy = |x: &[f64]| gas.energy(At::new(0.0, x));
    let slope = (energy(&up) - energy(&down)) / 2e-5;
    assert!((slope / dot(&gradient(&x), &direction) - 1.0).abs() < 1e-8);
    let mut product = vec![0.0; x.len()];
    gas.add_hessian(
        At::new(0.0, &x),
        &mut HessianProduct {
            edges: &edges,
            scale: 1.0,
            vector: &direction,
            product: &mut product,
        },
    );
    let [up, down] = [up, down].map(|x| gradient(&x));
    for (i, p) in product.iter().enumerate() {
        let slope = (up[i] - down[i]) / 2e-5;
        assert!((slope - p).abs() < 1e-7 * 1e5, "{i}: {slope} {p}");
    }
}

#[test]
fn what_cannot_be_used_is_named() {
    let (topology, x) = octahedron();
    let sheet = isosheet_mesh::Sheet::from_topology(topology.clone(), x.clone()).expect("a sheet");
    let fill = |faces: &LoadedFaces, gas: Gas, x: &[f64]| {
        let mass = isosheet_mesh::MassKind::Lumped;
        let model = SheetModel::new(&sheet, 1.0, mass).expect("a model");
        model.with_gas(faces.clone(), gas, x).err()
    };
    let closed = LoadedFaces::all(&topology).expect("faces");
    assert_eq!(fill(&closed, Gas::default(), &x), None);
    assert_eq!(
        fill(&closed.clone().turned_over(), Gas::default(), &x),
        None
    );
    let flat: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(i, x)| if i % 3 == 2 { 0.0 } else { *x })
        .collect();
    let error = fill(&closed, Gas::default(), &flat);
    assert!(matches!(error, Some(GasError::Empty { .. })), "{error:?}");
    let faces: Vec<_> = topology.face_ids().skip(1).collect();
    let open = LoadedFaces::new(&topology, &faces, &[]).expect("faces");
    let error = fill(&open, Gas::default(), &x);
    assert!(matches!(error, Some(GasError::Open { .. })), "{error:?}");
    let gas = Gas {
        exponent: f64::NAN,
        ..Gas::default()
    };
    let error = fill(&closed, gas, &x);
    assert!(
        matches!(
            error,
            Some(GasError::Number {
                name: "exponent",
                ..
            })
        ),
        "{error:?}"
    );
}
