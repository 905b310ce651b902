//! Trajectories at another rate of frames.

use super::Trajectory;
use super::data::FrameQuantity;
use isosheet_files::DataError;

/// The largest number of frames that are made: an hour of film at 24 frames a second.
const MOST_FRAMES: f64 = 86_400.0;

impl Trajectory {
    /// The motion from frame `first` to frame `last`, with `rate` frames a second instead of the recorded
    /// frames. The first frame stays, and the others follow at its time plus `k / rate` as long as there is a
    /// state at that time. Between two recorded frames every number is interpolated linearly in time:
    /// vertices are on the straight lines between their places, so that lengths are kept in the recorded
    /// frames only. Of frames at one time the last one counts.
    ///
    /// # Errors
    /// [`DataError`] for a rate that is not positive or gives more than 86 400 frames, and for
    /// frames that do not exist.
    pub fn at_rate(&self, rate: f64, [first, last]: [usize; 2]) -> Result<Self, DataError> {
        let wrong = || {
            let message = format!(
                "{rate} frames a second from frame {first} to frame {last}: the trajectory has {} frames, counted \
                 from 0",
                self.len()
            );
            let remedy = "give a positive rate with at most 86 400 frames in all, and frames that exist, the first \
                          before the last";
            DataError::new(message, remedy).value(rate)
        };
        let Some(times) = self.t.get(first..=last).filter(|times| !times.is_empty()) else {
            return Err(wrong());
        };
        let start = times[0];
        // A part of a frame that rounding has lost at the end is given back.
        let count = ((times[times.len() - 1] - start) * rate + 1e-6).floor();
        if !(rate > 0.0 && count < MOST_FRAMES) {
            return Err(wrong());
        }
        let mut resampled = self.without_frames();
        for k in 0..=count as usize {
            let t = start + k as f64 / rate;
            let after = times.partition_point(|s| *s <= t);
            let before = after.max(1) - 1;
            let after = after.min(times.len() - 1);
            let span = times[after] - times[before];
            let part = if span > 0.0 {
                ((t - times[before]) / span).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let [a, b] = [before, after].map(|k| first + k);
            let mix = |(a, b): (&f64, &f64)| (1.0 - part) * a + part * b;
            let n = 3 * self.vertex_count;
            let [p, q] = [a, b].map(|k| &self.x[n * k..n * (k + 1)]);
            resampled.t.push(t);
            resampled.x.extend(p.iter().zip(q).map(mix));
            for quantity in FrameQuantity::ALL {
                if let (Some(p), Some(q)) = (self.values(quantity, a), self.values(quantity, b)) {
                    let kept = &mut resampled.data[quantity as usize];
                    kept.extend(p.iter().zip(q).map(mix));
                }
            }
        }
        Ok(resampled)
    }
}

#[cfg(test)]
mod tests {
    use super::super::FrameData;
    use super::*;
    use isosheet_mesh::generate;
    use isosheet_mesh::generate::Diagonals;

    /// Frames at 0, 1, 1 and 3 seconds that move by their time along z, with gaps that say the same.
    fn recorded() -> Trajectory {
        let sheet = generate::grid(1, 1, 1.0, 1.0, Diagonals::Rising).unwrap();
        let mut trajectory = Trajectory::new(&sheet);
        for t in [0.0, 1.0, 1.0, 3.0] {
            let lifted = |(k, c): (usize, &f64)| if k % 3 == 2 { t } else { *c };
            let x: Vec<f64> = sheet.positions().iter().enumerate().map(lifted).collect();
            let gaps = [t; 4];
            let data = FrameData {
                gaps: &gaps,
                ..FrameData::default()
            };
            trajectory.push_with(t, &x, &data).unwrap();
        }
        trajectory
    }

    #[test]
    fn frames_lie_on_the_lines_between_those_that_were_recorded() {
        let trajectory = recorded();
        let film = trajectory.at_rate(2.5, [0, 3]).unwrap();
        assert_eq!(film.len(), 8, "2.8 s is the last time below 3 s");
        for (k, t) in film.times().iter().enumerate() {
            assert!((t - 0.4 * k as f64).abs() < 1e-12);
            let x = film.frame(k).unwrap();
            assert!((x[2] - t).abs() < 1e-12 && (film.gaps(k).unwrap()[0] - t).abs() < 1e-12);
            assert_eq!(x[0], trajectory.frame(0).unwrap()[0]);
        }
        // The end counts where it is on the way, and a range is counted from its first frame.
        assert_eq!(trajectory.at_rate(10.0, [0, 3]).unwrap().len(), 31);
        let part = trajectory.at_rate(1.0, [2, 3]).unwrap();
        assert_eq!(part.times(), [1.0, 2.0, 3.0]);
        assert_eq!(part.frame(1).unwrap()[2], 2.0);
        assert_eq!(trajectory.at_rate(1e-3, [1, 1]).unwrap().len(), 1);
    }

    #[test]
    fn impossible_rates_are_refused() {
        let trajectory = recorded();
        for (rate, range) in [
            (0.0, [0, 3]),
            (-1.0, [0, 3]),
            (f64::NAN, [0, 3]),
            (f64::INFINITY, [0, 3]),
            (1e9, [0, 3]),
            (24.0, [0, 4]),
            (24.0, [3, 2]),
        ] {
            let result = trajectory.at_rate(rate, range);
            assert!(result.is_err(), "{rate} {range:?}");
        }
    }
}
