//! Work on the subtrees of an elimination tree, on the threads of rayon's current pool.

use super::plan::{Plan, Subtree, WORTH_SHARING};

/// A part of an array, with the place in the array where the part begins.
pub(super) type FrontValues<'a> = (usize, &'a mut [f64]);

/// Cuts a part of an array in two at a place in the array.
fn cut((start, part): FrontValues<'_>, place: usize) -> (FrontValues<'_>, FrontValues<'_>) {
    let (left, right) = part.split_at_mut(place - start);
    ((start, left), (place, right))
}

/// What is done to each subtree of a plan, with some arrays of which each subtree has a part.
pub(super) trait Job<const N: usize>: Sync {
    /// The first thing that can go wrong, in the order of the subtrees.
    type Error: Send;

    /// Where the parts of a subtree begin.
    fn begins(&self, subtree: &Subtree) -> [usize; N];

    /// Does it. The parts contain the parts of the subtree.
    fn run(&self, subtree: &Subtree, parts: [FrontValues<'_>; N]) -> Result<(), Self::Error>;

    /// Does it to all subtrees of a plan, with the same result for any number of threads. (A thread that
    /// waits for another one may take up other work of the pool.)
    fn run_all(&self, plan: &Plan, arrays: [&mut [f64]; N]) -> Result<(), Self::Error>
    where
        Self: Sized,
    {
        if plan.operations >= WORTH_SHARING && rayon::current_num_threads() > 1 {
            return share(self, &plan.subtrees, arrays.map(|array| (0, array)));
        }
        let mut arrays = arrays;
        for subtree in &plan.subtrees {
            self.run(subtree, arrays.each_mut().map(|array| (0, &mut **array)))?;
        }
        Ok(())
    }
}

/// Does a job to some subtrees, in as many tasks.
fn share<const N: usize, J: Job<N>>(
    job: &J,
    subtrees: &[Subtree],
    parts: [FrontValues<'_>; N],
) -> Result<(), J::Error> {
    match subtrees {
        [] => Ok(()),
        [subtree] => job.run(subtree, parts),
        _ => {
            let (left, right) = Subtree::halves(subtrees);
            let mut begins = job.begins(&right[0]).into_iter();
            let mut right_parts = [const { None }; N];
            let mut places = right_parts.iter_mut();
            let left_parts = parts.map(|part| {
                let begin = begins.next().expect("one of N");
                let (before, after) = cut(part, begin);
                *places.next().expect("one of N") = Some(after);
                before
            });
            let right_parts = right_parts.map(|part| part.expect("all are set"));
            let (left, right) = rayon::join(
                || share(job, left, left_parts),
                || share(job, right, right_parts),
            );
            left.and(right)
        }
    }
}
