//! Derivatives against differences, the written form, and refusals.

use super::*;
use proptest::collection::vec;
use proptest::prelude::*;

/// Profiles of every kind with times in [-1, 1] and changes of the order of one, none of them sudden.
fn profiles() -> impl Strategy<Value = Profile> {
    let value = || -1.0..1.0_f64;
    let step = || (value(), value(), value(), 0.2..1.0_f64);
    let keys = vec((0.2..1.0_f64, value()), 1..6).prop_map(|parts| {
        let mut t = -1.0;
        let keys = parts.into_iter().map(|(duration, value)| {
            t += duration;
            [t, value]
        });
        keys.collect::<Vec<_>>()
    });
    prop_oneof![
        value().prop_map(Profile::from),
        step().prop_map(|(from, to, begin, duration)| Profile::Ramp {
            from,
            to,
            begin,
            end: begin + duration
        }),
        step().prop_map(|(from, to, begin, duration)| Profile::SmoothStep {
            from,
            to,
            begin,
            end: begin + duration
        }),
        step().prop_map(|(from, rate, begin, duration)| Profile::RunUp {
            from,
            rate,
            begin,
            end: begin + duration
        }),
        (value(), value(), -2.0..2.0_f64, value()).prop_map(
            |(mean, amplitude, frequency, phase)| Profile::Sine {
                mean,
                amplitude,
                frequency,
                phase
            }
        ),
        (any::<bool>(), keys).prop_map(|(cubic, keys)| Profile::Keyframes {
            interpolation: if cubic {
                Interpolation::MonotoneCubic
            } else {
                Interpolation::Linear
            },
            keys
        }),
    ]
}

/// Times at which a derivative may jump.
fn kinks(profile: &Profile) -> Vec<f64> {
    match profile {
        Profile::Constant(_) | Profile::Sine { .. } => Vec::new(),
        Profile::Ramp { begin, end, .. }
        | Profile::SmoothStep { begin, end, .. }
        | Profile::RunUp { begin, end, .. } => vec![*begin, *end],
        Profile::Keyframes { keys, .. } => keys.iter().map(|k| k[0]).collect(),
    }
}

/// Derivative by five-point differences.
fn difference(at: impl Fn(f64) -> f64, t: f64, h: f64) -> f64 {
    (8.0 * (at(t + h) - at(t - h)) - (at(t + 2.0 * h) - at(t - 2.0 * h))) / (12.0 * h)
}

proptest! {
    #![proptest_config(isosheet_random::cases(2000))]

    #[test]
    fn derivatives_match_differences(profile in profiles(), t in -2.0..3.0_f64) {
        let h = 1e-3;
        prop_assert_eq!(profile.validate(), Ok(()));
        prop_assume!(kinks(&profile).iter().all(|k| (t - k).abs() > 3.0 * h));
        let rate = difference(|s| profile.value(s), t, h);
        let acceleration = difference(|s| profile.rate(s), t, h);
        // Fourth order in steps of at most a hundredth of the period or the duration.
        prop_assert!((rate - profile.rate(t)).abs() < 2e-6, "{} {rate}", profile.rate(t));
        prop_assert!(
            (acceleration - profile.acceleration(t)).abs() < 2e-5,
            "{} {acceleration}", profile.acceleration(t)
        );
    }

    /// At a kink values are continuous, and derivatives those to the right.
    #[test]
    fn derivatives_at_kinks_are_those_to_the_right(profile in profiles()) {
        let d = 1e-9;
        for t in kinks(&profile) {
            let (value, before) = (profile.value(t), profile.value(t - d));
            prop_assert!((value - before).abs() < 1e-7, "{value} {before}");
            let [_, rate, acceleration] = profile.derivatives(t);
            let [_, right, bend] = profile.derivatives(t + d);
            prop_assert!((rate - right).abs() < 1e-5, "{rate} {right}");
            prop_assert!((acceleration - bend).abs() < 1e-4, "{acceleration} {bend}");
        }
    }

    #[test]
    fn cubics_do_not_overshoot_and_have_a_continuous_rate(profile in profiles(), s in 0.0..1.0_f64) {
        let Profile::Keyframes { interpolation: Interpolation::MonotoneCubic, keys } = &profile else {
            return Ok(());
        };
        for pair in keys.windows(2) {
            let ([t0, v0], [t1, v1]) = (pair[0], pair[1]);
            let value = profile.value(t0 + s * (t1 - t0));
            prop_assert!(value >= v0.min(v1) - 1e-15 && value <= v0.max(v1) + 1e-15);
            prop_assert_eq!(profile.value(t0), v0);
            prop_assert!((profile.rate(t1) - profile.rate(t1 - 1e-9)).abs() < 1e-6);
        }
    }
}

#[test]
fn a_smooth_step_is_twice_continuously_differentiable() {
    let step = Profile::SmoothStep {
        from: 1.0,
        to: 3.0,
        begin: 0.5,
        end: 2.5,
    };
    assert_eq!(step.derivatives(0.5), [1.0, 0.0, 0.0]);
    assert_eq!(step.derivatives(2.5), [3.0, 0.0, 0.0]);
    for (t, d) in [(0.5, 1e-6), (2.5, -1e-6)] {
        let [_, rate, acceleration] = step.derivatives(t + d);
        assert!(rate.abs() < 1e-10 && acceleration.abs() < 1e-4);
    }
    // Half-way: the value by symmetry, and 15/8 of the mean rate.
    assert_eq!(step.derivatives(1.5), [2.0, 15.0 / 8.0, 0.0]);
}

#[test]
fn invalid_profiles_are_refused() {
    let ramp = |from: f64, begin: f64, end: f64| Profile::Ramp {
        from,
        to: 1.0,
        begin,
        end,
    };
    let keys = |keys: &[[f64; 2]]| Profile::Keyframes {
        interpolation: Interpolation::MonotoneCubic,
        keys: keys.to_vec(),
    };
    let (begin, end) = (1.0, 1.0);
    assert_eq!(
        ramp(0.0, begin, end).validate(),
        Err(ProfileError::Duration { begin, end })
    );
    let infinite = ramp(f64::INFINITY, 0.0, 1.0).validate();
    let (name, value) = ("from", f64::INFINITY);
    assert_eq!(infinite, Err(ProfileError::NotFinite { name, value }));
    assert_eq!(keys(&[]).validate(), Err(ProfileError::NoKeyframes));
    assert!(keys(&[]).value(0.0).is_nan());
    assert_eq!(
        keys(&[[0.0, 1.0], [1.0, 2.0], [1.0, 3.0]]).validate(),
        Err(ProfileError::Order {
            index: 2,
            t: 1.0,
            previous: 1.0
        })
    );
    assert_eq!(
        keys(&[[0.0, 1.0], [1.0, f64::INFINITY]]).validate(),
        Err(ProfileError::Keyframe {
            index: 1,
            t: 1.0,
            value: f64::INFINITY
        })
    );
    for (k, name) in ["mean", "amplitude", "frequency", "phase"]
        .iter()
        .enumerate()
    {
        let mut p = [1.0; 4];
        p[k] = f64::NAN;
        let error = Profile::Sine {
            mean: p[0],
            amplitude: p[1],
            frequency: p[2],
            phase: p[3],
        }
        .validate()
        .unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
    assert!(Profile::from(f64::NAN).validate().is_err());
}

#[test]
fn a_run_up_has_constant_acceleration_and_then_a_constant_rate() {
    let feed = Profile::RunUp {
        from: 1.0,
        rate: 0.15,
        begin: 0.1,
        end: 0.3,
    };
    assert_eq!(feed.derivatives(0.0), [1.0, 0.0, 0.0]);
    for (t, [value, rate, acceleration]) in [
        (0.2, [1.0 + 0.75 * 0.1 * 0.1 / 2.0, 0.075, 0.75]),
        (0.3, [1.015, 0.15, 0.0]),
        (2.3, [1.315, 0.15, 0.0]),
    ] {
        let found = feed.derivatives(t);
        assert!((found[0] - value).abs() < 1e-15, "{t}");
        assert!((found[1] - rate).abs() < 1e-15, "{t}");
        assert!((found[2] - acceleration).abs() < 1e-14, "{t}");
    }
}
